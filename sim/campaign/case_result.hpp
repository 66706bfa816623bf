// What one case leaves behind: a line of JSON. Times are virtual; nothing in it is of the host.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/campaign/campaign.hpp"
#include "sim/scenario/runner.hpp"
#include "sim/scenario/scenario_file.hpp"

namespace vinv::campaign {

enum class CaseVerdict : std::uint8_t { kPassed, kFailed, kNotRun, kCrashed };
std::string_view verdict_word(CaseVerdict verdict);  // "passed", "failed", "not run", "crashed"

struct Failure {
  std::string drive;  // empty: the scenario as a whole
  std::string what;
  std::string expected;
  std::string seen;
  std::string cause;
  std::int64_t at_ns = 0;
  int line = 0;  // of the case's own scenario
  bool operator==(const Failure&) const = default;
};
inline constexpr std::size_t kMaxFailures = 10;  // of one case; the others are counted

struct CaseResult {
  std::uint64_t number = 0;
  std::string digest;
  std::string build;
  CaseVerdict verdict = CaseVerdict::kNotRun;
  std::string reason;  // of kNotRun and kCrashed
  std::int64_t end_ns = 0;
  std::size_t checks = 0;
  std::size_t failed_checks = 0;
  std::vector<Failure> failures;
  std::string alarm;                            // the first of the run; empty: none
  std::vector<std::optional<double>> measured;  // in the order of Campaign::measures
  bool operator==(const CaseResult&) const = default;
};

// One line, without its end.
std::string to_line(const CaseResult& result);
// Empty if the line is no whole result.
std::optional<CaseResult> from_line(std::string_view line);

// number, digest and build are the caller's.
CaseResult summary(const scenario::RunResult& run, const std::vector<Measure>& measures);
// Reads and runs the text of a scenario. Never throws: what goes wrong is in the result.
scenario::RunResult run_text(const std::string& text, const std::string& path, const scenario::LoadOptions& load,
                             const scenario::RunOptions& run);

}  // namespace vinv::campaign
