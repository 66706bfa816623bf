// Writes the files of each run into a folder, and index.html over all of them:
//   STEM.html               the run as a page; needs nothing else
//   STEM.csv (signals), STEM.states.csv, STEM.events.csv
//   STEM.candump.log        if there was CAN
//   STEM.pcapng             if anything went over a wire
// Each file appears whole or not at all. The bytes are a function of scenario, result and build.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "sim/scenario/report/index_page.hpp"
#include "sim/scenario/report_writer.hpp"

namespace vinv::scenario {

class ReportFolder : public ReportWriter {
 public:
  // build: as in html_report().
  ReportFolder(std::string folder, std::string build);

  // Makes the folder if it is not there, writes all files that can be written, then throws std::runtime_error with a
  // line for each that cannot. That the folder cannot be made is said once, and again by finish().
  void write(const Scenario* scenario, const RunResult& result) override;
  void finish() override;

 private:
  std::string free_stem(const RunResult& result);

  std::string folder_;
  std::string build_;
  std::set<std::string> stems_{"index"};  // taken
  std::vector<IndexEntry> entries_;
  std::size_t lost_runs_ = 0;  // because there is no folder
};

}  // namespace vinv::scenario
