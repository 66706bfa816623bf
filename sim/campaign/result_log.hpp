// Results on disk: JSON lines, appended and never changed, a file for each shard. A line that was torn by a crash or a
// full disk is no result; the next one begins on a line of its own.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/campaign/case_result.hpp"

namespace vinv::campaign {

class ResultLog {
 public:
  // Opens or makes the file and its folder; nobody else writes it meanwhile. Throws std::runtime_error with a sentence.
  explicit ResultLog(const std::string& path);
  ~ResultLog();
  ResultLog(const ResultLog&) = delete;
  ResultLog& operator=(const ResultLog&) = delete;

  // On the disk when it returns. Throws std::runtime_error with a sentence.
  void append(const std::string& line);

 private:
  std::string path_;
  int file_ = -1;
  bool torn_ = false;  // the file does not end with a line feed
};

struct Results {
  std::map<std::uint64_t, CaseResult> cases;
  std::size_t torn_lines = 0;
  std::size_t other_state = 0;  // of a campaign file that was different then
  std::map<std::string, std::size_t> other_builds;
  std::vector<std::uint64_t> contradictory;  // cases with two different results
};

// All results in the *.jsonl files of a folder that count: cases of the campaign as it is, made by this build, or by
// any if build is empty. A folder that is not there has none. Throws std::runtime_error with a sentence.
Results read_results(const std::string& folder, const Campaign& campaign, const std::string& build);

}  // namespace vinv::campaign
