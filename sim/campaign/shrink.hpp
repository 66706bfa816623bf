// Makes a failing case small: takes away whatever can go, and writes numbers shorter, as long as the same check fails
// on the same drive with the same first alarm.
#pragma once

#include <functional>
#include <string>

#include "sim/campaign/campaign_run.hpp"

namespace vinv::campaign {

struct ShrinkOptions {
  std::size_t max_runs = 1000;
  // After each run: how many, and the size of the smallest text so far.
  std::function<void(std::size_t runs, std::size_t bytes)> on_run;
};

struct ShrinkResult {
  std::string text;  // of the smallest scenario
  std::size_t bytes_before = 0;
  std::size_t runs = 0;
  bool minimal = false;  // nothing more can go; false: the limit of runs came first
  CaseResult result;     // of that scenario
};

// Every run is in a process of its own. Throws std::runtime_error with a sentence if the case passes.
ShrinkResult shrink_case(const Campaign& campaign, std::uint64_t number, const CampaignRunOptions& run,
                         const ShrinkOptions& options);

}  // namespace vinv::campaign
