// Runs the cases of one shard that have no result yet, each in a process that it may take down with it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/campaign/case_result.hpp"
#include "sim/campaign/result_log.hpp"

namespace vinv::campaign {

// Cases i, i + n, i + 2 n ... of shard i of n: neighbours, which last about as long, go to different shards.
struct Shard {
  std::uint64_t index = 1;  // 1 to count
  std::uint64_t count = 1;
  bool has(std::uint64_t number) const { return (number - 1) % count + 1 == index; }
};
// "3/8". The error is a sentence.
Result<Shard, std::string> parse_shard(std::string_view text);

struct CampaignRunOptions {
  scenario::LoadOptions load;
  scenario::RunOptions run;
  std::string folder;  // of the results
  std::string build;   // results of other builds do not count, and are left alone
  Shard shard;
  std::size_t jobs = 1;
  // In place of run_text, for tests. Called in a process of its own.
  std::function<scenario::RunResult(const std::string& text, const std::string& path)> run_one;
  // In the order in which cases end.
  std::function<void(std::uint64_t done, std::uint64_t to_do, const CaseResult& result)> on_result;
  // A sentence: what was found in the folder, or what could not be written. The run goes on if it can.
  std::function<void(const std::string& sentence)> on_trouble;
};

struct CampaignRunResult {
  std::uint64_t of_shard = 0;
  std::uint64_t found = 0;                                         // had a result already
  std::uint64_t passed = 0, failed = 0, not_run = 0, crashed = 0;  // with those found
  std::uint64_t without_result = 0;
};

// Throws std::runtime_error with a sentence if there is no place for results.
CampaignRunResult run_campaign(const Campaign& campaign, const CampaignRunOptions& options);

// Numbers of the shard's cases that have no result.
std::vector<std::uint64_t> missing_cases(const Campaign& campaign, const Results& results, const Shard& shard);
// What is in a results folder beside results, as sentences.
std::vector<std::string> remarks(const Results& results);

// Where a shard's results are: DIR/NAME.shard-3-of-8.jsonl
std::string shard_file(const Campaign& campaign, const std::string& folder, const Shard& shard);
// One case, here and now.
scenario::RunResult run_case(const Campaign& campaign, std::uint64_t number, const CampaignRunOptions& options);

}  // namespace vinv::campaign
