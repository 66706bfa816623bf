// Many scenarios in one go: files and folders, several at a time in threads of their own. A run knows nothing of its
// neighbours, and results are handed out in the order of the files.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/scenario/report_writer.hpp"
#include "sim/scenario/runner.hpp"
#include "sim/scenario/scenario_file.hpp"

namespace vinv::scenario {

// Scenario files of the given paths: a file as it is, a folder with everything in it that ends in .yaml or .yml and is
// a scenario (a plant file is none), in the order of names. filter: part of a path or of a title; empty: all. Throws
// std::runtime_error with a sentence if a path is not there.
std::vector<std::string> find_scenarios(const std::vector<std::string>& paths, const std::string& filter);

struct BatchOptions {
  LoadOptions load;
  RunOptions run;
  std::size_t jobs = 1;
  // In place of run_virtual, for a run in real time.
  std::function<RunResult(const Scenario&)> run_one;
  // After each run, in the order of the files: how many are done, and the result.
  std::function<void(std::size_t done, const RunResult& result)> on_result;
  // Something could not be written; a sentence. The batch goes on.
  std::function<void(const std::string& sentence)> on_trouble;
};

struct BatchResult {
  std::size_t passed = 0;
  std::size_t failed = 0;
  std::size_t not_run = 0;
  std::size_t not_written = 0;  // reports
};

BatchResult run_batch(const std::vector<std::string>& files, const BatchOptions& options,
                      const std::vector<std::unique_ptr<ReportWriter>>& writers);

}  // namespace vinv::scenario
