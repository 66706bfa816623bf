// All results of a campaign in one piece. The bytes are a function of campaign and results, whatever the shards were.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/campaign/result_log.hpp"

namespace vinv::campaign {

// One test case for each case of the campaign; one without result is an error.
std::string merged_junit(const Campaign& campaign, const Results& results);
// RFC 4180, a row for each case: case, verdict, alarm, end_s, checks, failed_checks, what varies, measures, first
// failure.
std::string merged_csv(const Campaign& campaign, const Results& results);
// A page that needs nothing else: counts, histograms over what varies and what was measured, a table.
std::string merged_page(const Campaign& campaign, const Results& results, const std::string& build);

inline constexpr std::size_t kMaxRows = 10'000;  // of the page; what did not pass comes first

struct Counts {
  std::uint64_t passed = 0, failed = 0, not_run = 0, crashed = 0, missing = 0;
  bool all_passed() const { return failed + not_run + crashed + missing == 0; }
};
Counts count_results(const Campaign& campaign, const Results& results);
// "240 cases: 200 passed, 38 failed, 1 could not run, 1 crashed, 0 without result"
std::string counts_text(const Counts& counts);
// The first thing that is wrong, on one line; empty if nothing is. nullptr: no result.
std::string first_failure(const CaseResult* result);

// A histogram: bars from left to right, each of what passed, failed, and neither.
struct Bar {
  std::string label;
  std::array<std::uint64_t, 3> counts{};
};
// Points: a text and which of the three it is. Numbers with the same unit are sorted, and put into equal parts if there
// are many; other texts have a bar each, the rarest together.
std::vector<Bar> bars_of(const std::vector<std::pair<std::string, int>>& points);

}  // namespace vinv::campaign
