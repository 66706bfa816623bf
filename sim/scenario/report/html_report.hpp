// A run as one HTML page that needs nothing else: verdict, checks, trips and events are readable without scripts; with
// them there are plots with zoom and cursors, states as lanes, and the wire log.
#pragma once

#include <string>
#include <vector>

#include "sim/scenario/result.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

// A file beside the page that belongs to the same run.
struct ReportFile {
  std::string label;  // "signals"
  std::string name;   // "fr-e500_accel_time.csv"
};

// Events in the table that is there without scripts; the scripts show all.
inline constexpr std::size_t kMaxEventsWithoutScripts = 300;
inline constexpr std::size_t kMaxChecksShown = 2000;  // failed ones first

// scenario may be nullptr. build: what made the run, "vinverter 0.1.0 (abc1234)".
std::string html_report(const Scenario* scenario, const RunResult& result, const std::string& build,
                        const std::vector<ReportFile>& files);

// "passed", "failed", "not run"
std::string_view verdict_word(Verdict verdict);

}  // namespace vinv::scenario
