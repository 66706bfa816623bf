// Signals and events of each run as CSV in a folder: STEM.csv with a row per sample, STEM.events.csv with a row per
// event.
#pragma once

#include <string>

#include "sim/scenario/report_writer.hpp"

namespace vinv::scenario {

class CsvWriter : public ReportWriter {
 public:
  // Makes the folder when the first run is written.
  explicit CsvWriter(std::string folder) : folder_(std::move(folder)) {}
  void write(const Scenario* scenario, const RunResult& result) override;

 private:
  std::string folder_;
};

std::string signals_csv(const Recording& recording);
std::string events_csv(const RunResult& result);

}  // namespace vinv::scenario
