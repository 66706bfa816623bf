// Who makes files of results. The runner calls every writer once per scenario, in the order in which the scenarios were
// given, from one thread, and finish() at the end.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/scenario/result.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

class ReportWriter {
 public:
  virtual ~ReportWriter() = default;
  // One run. scenario is nullptr if its file could not be read. A failure to write is a std::runtime_error with a
  // sentence; the other writers and runs go on.
  virtual void write(const Scenario* scenario, const RunResult& result) = 0;
  virtual void finish() {}
};

// File name of a run without ending, unique in a batch: "fr-e500_accel_time".
std::string report_stem(const RunResult& result);

}  // namespace vinv::scenario
