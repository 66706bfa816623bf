// The page over all runs of a batch: verdict, name, duration, failing checks, links to the files of each.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/scenario/report/html_report.hpp"

namespace vinv::scenario {

struct IndexEntry {
  Verdict verdict = Verdict::kNotRun;
  std::string name;
  std::string title;
  std::string path;
  std::uint64_t seed = 0;
  Instant end{};
  std::size_t checks = 0;
  std::size_t failures = 0;
  std::string first_failure;  // a sentence; of kNotRun the reason
  Instant first_failure_at{};
  std::string page;                    // file name of the HTML report; empty: it could not be written
  std::vector<ReportFile> files;       // the others
  std::vector<std::string> unwritten;  // a sentence for each file that could not be written
};

IndexEntry index_entry(const RunResult& result);
std::string index_page(const std::vector<IndexEntry>& entries, const std::string& build);

}  // namespace vinv::scenario
