#include "sim/campaign/campaign_run.hpp"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "sim/campaign/isolation.hpp"

namespace vinv::campaign {
namespace {

constexpr std::uint64_t kMaxShards = 100'000;

bool whole_number(std::string_view text, std::uint64_t& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc{} && end == text.data() + text.size();
}

void count(CampaignRunResult& all, const CaseResult& r) {
  switch (r.verdict) {
    case CaseVerdict::kPassed: ++all.passed; break;
    case CaseVerdict::kFailed: ++all.failed; break;
    case CaseVerdict::kNotRun: ++all.not_run; break;
    case CaseVerdict::kCrashed: ++all.crashed; break;
  }
}

}  // namespace

Result<Shard, std::string> parse_shard(std::string_view text) {
  Shard s;
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos || !whole_number(text.substr(0, slash), s.index) ||
      !whole_number(text.substr(slash + 1), s.count) || s.count < 1 || s.count > kMaxShards || s.index < 1 ||
      s.index > s.count)
    return Unexpected(
        fmt::format("shard \"{}\": write i/n with n from 1 to {} and i from 1 to n, as 3/8.", text, kMaxShards));
  return s;
}

std::string shard_file(const Campaign& campaign, const std::string& folder, const Shard& shard) {
  return (std::filesystem::path(folder) /
          fmt::format("{}.shard-{}-of-{}.jsonl", campaign.name, shard.index, shard.count))
      .string();
}

scenario::RunResult run_case(const Campaign& campaign, std::uint64_t number, const CampaignRunOptions& options) {
  const std::string path = campaign.case_name(number) + ".yaml";
  scenario::RunResult out;
  try {
    const std::string text = campaign.scenario_text(number);
    return options.run_one ? options.run_one(text, path) : run_text(text, path, options.load, options.run);
  } catch (const std::exception& e) {
    out.path = path;
    out.reason = e.what();
    return out;
  }
}

std::vector<std::uint64_t> missing_cases(const Campaign& campaign, const Results& results, const Shard& shard) {
  std::vector<std::uint64_t> out;
  for (std::uint64_t k = shard.index; k <= campaign.cases(); k += shard.count)
    if (results.cases.count(k) == 0) out.push_back(k);
  return out;
}

std::vector<std::string> remarks(const Results& results) {
  std::vector<std::string> out;
  if (results.torn_lines > 0)
    out.push_back(fmt::format("{} torn lines among the results do not count.", results.torn_lines));
  if (results.other_state > 0)
    out.push_back(fmt::format("{} results do not count: the campaign has changed since.", results.other_state));
  for (const auto& [build, n] : results.other_builds)
    out.push_back(fmt::format("{} results do not count: they are of another build, {}.", n, build));
  for (const std::uint64_t k : results.contradictory)
    out.push_back(fmt::format("case {} has two results that differ.", k));
  return out;
}

CampaignRunResult run_campaign(const Campaign& campaign, const CampaignRunOptions& options) {
  const auto trouble = [&](const std::string& sentence) {
    if (options.on_trouble) options.on_trouble(sentence);
  };
  ResultLog log(shard_file(campaign, options.folder, options.shard));
  const Results found = read_results(options.folder, campaign, options.build);
  for (const std::string& r : remarks(found)) trouble(r);
  const std::vector<std::uint64_t> to_do = missing_cases(campaign, found, options.shard);
  CampaignRunResult out;
  for (std::uint64_t k = options.shard.index; k <= campaign.cases(); k += options.shard.count) {
    ++out.of_shard;
    if (const auto it = found.cases.find(k); it != found.cases.end()) count(out, it->second);
  }
  out.found = out.of_shard - to_do.size();
  out.without_result = to_do.size();

  std::size_t begun = 0;
  std::uint64_t done = 0;
  bool writable = true;
  run_isolated(
      std::min<std::size_t>(std::max<std::size_t>(options.jobs, 1), std::max<std::size_t>(to_do.size(), 1)),
      [&]() -> std::optional<std::string> {
        if (begun == to_do.size()) return {};
        return std::to_string(to_do[begun++]);
      },
      [&](const std::string& task) {
        return to_line(summary(run_case(campaign, std::stoull(task), options), campaign.measures));
      },
      [&](std::size_t task, const Answer& answer) {
        const std::uint64_t number = to_do[task];
        CaseResult result;
        if (answer.kind == Answer::Kind::kStopped) {
          trouble(fmt::format("case {} has no result: {}", number, answer.text));
          return true;
        }
        if (answer.kind == Answer::Kind::kDone) {
          result = from_line(answer.text).value();
        } else {
          result.verdict = CaseVerdict::kCrashed;
          result.reason = answer.text;
          result.measured.resize(campaign.measures.size());
        }
        result.number = number;
        result.digest = campaign.digest(number);
        result.build = options.build;
        if (!writable) return false;
        try {
          log.append(to_line(result));
        } catch (const std::runtime_error& e) {
          // More results would have no place either.
          trouble(e.what());
          writable = false;
          return false;
        }
        --out.without_result;
        count(out, result);
        if (options.on_result) options.on_result(++done, to_do.size(), result);
        return true;
      });
  return out;
}

}  // namespace vinv::campaign
