// vinverter campaign: thousands of variations of a scenario, in shards, with results that are kept and merged.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sim/campaign/campaign_file.hpp"
#include "sim/campaign/campaign_run.hpp"
#include "sim/campaign/merge.hpp"
#include "sim/campaign/shrink.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/junit.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/units.hpp"
#include "tools/vinverter/subcommands.hpp"
#include "vinverter_data.hpp"

namespace vinv::tools {
namespace {

using campaign::Campaign;
using campaign::CaseResult;
using campaign::CaseVerdict;

struct CampaignOptions {
  std::string file;
  std::string out = "campaign-results";
  std::string shard = "1/1";
  std::size_t jobs = 0;
  bool any_build = false;
  bool verbose = false;
  std::uint64_t number = 0;
  std::string output;
  std::size_t max_runs = campaign::ShrinkOptions{}.max_runs;
  std::string junit, html, csv;
};

std::string build_name() { return fmt::format("vinverter {} ({})", VINV_VERSION, VINV_GIT_DESCRIBE); }

campaign::CampaignRunOptions run_options(const CampaignOptions& options) {
  campaign::CampaignRunOptions out;
  out.load.catalogue = rig::shipped_catalogue();
  out.load.masters = scenario::protocol_masters();
  out.run.masters = out.load.masters;
  out.folder = options.out;
  out.build = build_name();
  out.jobs = options.jobs != 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
  const auto shard = campaign::parse_shard(options.shard);
  if (!shard) throw std::runtime_error("--" + shard.error());
  out.shard = *shard;
  return out;
}

campaign::Results results_of(const Campaign& c, const CampaignOptions& options) {
  auto results = campaign::read_results(options.out, c, options.any_build ? "" : build_name());
  for (const std::string& sentence : campaign::remarks(results)) fmt::print(stderr, "vinverter: {}\n", sentence);
  return results;
}

void check_number(const Campaign& c, std::uint64_t number) {
  if (number < 1 || number > c.cases())
    throw std::runtime_error(fmt::format("there is no case {}; allowed: 1 to {}.", number, c.cases()));
}

int check(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  fmt::print("{} cases\n", c.cases());
  return kDone;
}

int list(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  for (std::uint64_t k = run.shard.index; k <= c.cases(); k += run.shard.count)
    fmt::print("{}  {}\n", k, c.shown_values(k));
  return kDone;
}

std::string result_line(const Campaign& c, const CaseResult& r) {
  const char* word = r.verdict == CaseVerdict::kPassed   ? "passed"
                     : r.verdict == CaseVerdict::kFailed ? "FAILED"
                     : r.verdict == CaseVerdict::kNotRun ? "NOT RUN"
                                                         : "CRASHED";
  std::string out = fmt::format("{:<7}  case {}  {}\n", word, r.number, c.shown_values(r.number));
  if (const std::string first = campaign::first_failure(&r); !first.empty()) out += "  " + first + "\n";
  return out;
}

int run(const CampaignOptions& options) {
  auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  std::uint64_t failed = 0;
  run.on_result = [&](std::uint64_t done, std::uint64_t to_do, const CaseResult& r) {
    failed += r.verdict == CaseVerdict::kPassed ? 0 : 1;
    if (terminal) fmt::print(stderr, "\r\033[K");
    if (options.verbose || r.verdict != CaseVerdict::kPassed) {
      fmt::print("{}", result_line(c, r));
      std::fflush(stdout);
    }
    if (terminal && done < to_do)
      fmt::print(stderr, "{}/{}{}", done, to_do, failed > 0 ? fmt::format(", {} failed", failed) : "");
  };
  run.on_trouble = [&](const std::string& sentence) {
    fmt::print(stderr, "{}vinverter: {}\n", terminal ? "\r\033[K" : "", sentence);
  };
  const auto result = campaign::run_campaign(c, run);
  fmt::print(
      "shard {}/{}: {} of {} cases: {} passed, {} failed, {} could not run, {} crashed, {} without result; {} had one "
      "before\n",
      run.shard.index, run.shard.count, result.of_shard, c.cases(), result.passed, result.failed, result.not_run,
      result.crashed, result.without_result, result.found);
  if (result.not_run + result.crashed + result.without_result > 0) return kUnusable;
  return result.failed > 0 ? kRefused : kDone;
}

int missing(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  const auto results = results_of(c, options);
  const auto numbers = campaign::missing_cases(c, results, run.shard);
  for (const std::uint64_t k : numbers) fmt::print("{}\n", k);
  fmt::print(stderr, "{} cases have no result\n", numbers.size());
  return numbers.empty() ? kDone : kRefused;
}

int merge(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  const auto results = results_of(c, options);
  bool written = true;
  const auto write = [&](const std::string& given, const char* ending, const std::string& text) {
    const std::string path = given.empty() ? (std::filesystem::path(options.out) / (c.name + ending)).string() : given;
    try {
      scenario::write_file(path, text);
      fmt::print("{}\n", path);
    } catch (const std::runtime_error& e) {
      fmt::print(stderr, "vinverter: {}\n", e.what());
      written = false;
    }
  };
  write(options.junit, ".junit.xml", campaign::merged_junit(c, results));
  write(options.html, ".html", campaign::merged_page(c, results, options.any_build ? "" : build_name()));
  write(options.csv, ".csv", campaign::merged_csv(c, results));
  const auto counts = campaign::count_results(c, results);
  fmt::print("{}\n", campaign::counts_text(counts));
  if (!written || !results.contradictory.empty() || counts.not_run + counts.crashed + counts.missing > 0)
    return kUnusable;
  return counts.failed > 0 ? kRefused : kDone;
}

void write_scenario(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return;
  }
  scenario::write_file(path, text);
  fmt::print("{}\n", path);
}

int repro(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  check_number(c, options.number);
  write_scenario(options.output.empty() ? c.case_name(options.number) + ".yaml" : options.output,
                 c.scenario_text(options.number));
  return kDone;
}

int shrink(const CampaignOptions& options) {
  const auto run = run_options(options);
  const Campaign c = campaign::load_campaign(options.file, run.load);
  check_number(c, options.number);
  campaign::ShrinkOptions how;
  how.max_runs = options.max_runs;
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  how.on_run = [&](std::size_t runs, std::size_t bytes) {
    if (terminal) fmt::print(stderr, "\r\033[K{} runs, {} bytes", runs, bytes);
  };
  const auto result = campaign::shrink_case(c, options.number, run, how);
  if (terminal) fmt::print(stderr, "\r\033[K");
  fmt::print(stderr, "{} of {} bytes after {} runs{}; still: {}\n", result.text.size(), result.bytes_before,
             result.runs, result.minimal ? "" : " (the limit)", campaign::first_failure(&result.result));
  write_scenario(options.output.empty() ? c.case_name(options.number) + "_small.yaml" : options.output, result.text);
  return kDone;
}

// In one piece: the schemas of scenario and plant, files of their own in docs, take the place of the references.
void print_schema() {
  auto schema = rig::Json::parse(data::CAMPAIGN_SCHEMA);
  auto scenario = rig::Json::parse(data::SCENARIO_SCHEMA);
  auto plant = rig::Json::parse(data::SCENARIO_PLANT_SCHEMA);
  for (auto* part : {&scenario, &plant}) part->erase("$schema");
  for (auto& [name, definition] : scenario["definitions"].items()) schema["definitions"][name] = definition;
  scenario.erase("definitions");
  for (rig::Json& form : scenario["properties"]["plant"]["anyOf"])
    if (form.contains("$ref")) form = plant;
  for (rig::Json& form : schema["properties"]["scenario"]["anyOf"])
    if (form.contains("$ref")) form = scenario;
  fmt::print("{}\n", schema.dump(2));
}

}  // namespace

void add_campaign(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CampaignOptions>();
  CLI::App* sub = app.add_subcommand("campaign", "Run thousands of variations of a scenario, in shards");
  sub->require_subcommand(1);
  sub->footer(R"(
Examples:
  vinverter campaign check scenarios/campaigns/deceleration_ov3.yaml
  vinverter campaign run FILE --out results     all cases that have no result yet
  vinverter campaign run FILE --out results --shard 3/8
  vinverter campaign missing FILE --out results
  vinverter campaign merge FILE --out results   one JUnit, HTML and CSV file
  vinverter campaign shrink FILE 6              why case 6 fails, as small as possible
)");
  const auto command = [&](const char* name, const char* help, int (*act)(const CampaignOptions&)) {
    CLI::App* c = sub->add_subcommand(name, help);
    c->add_option("FILE", options->file, "Campaign file")->required();
    c->callback([options, &exit_code, act] { exit_code = act(*options); });
    return c;
  };
  const auto out = [&](CLI::App* c) {
    c->add_option("--out", options->out, "Folder of the results; default: campaign-results");
  };
  const auto shard = [&](CLI::App* c) {
    c->add_option("--shard", options->shard, "i/n: only every n-th case, from case i on; i from 1 to n");
  };
  const auto any_build = [&](CLI::App* c) {
    c->add_flag("--any-build", options->any_build, "Results of other builds count too");
  };

  command("check", "Read a campaign file and tell every mistake, without running", check);
  CLI::App* list_command = command("list", "List the cases with what varies", list);
  shard(list_command);

  CLI::App* run_command = command("run", "Run the cases that have no result yet", run);
  out(run_command);
  shard(run_command);
  run_command->add_option("--jobs", options->jobs, "How many run at a time; default: one per processor");
  run_command->add_flag("--verbose", options->verbose, "Print cases that pass, too");
  run_command->footer("\nExit codes: 0 all passed; 1 one failed; 2 one could not run, crashed, or has no result.");

  CLI::App* missing_command = command("missing", "List the cases that have no result", missing);
  out(missing_command);
  shard(missing_command);
  any_build(missing_command);
  missing_command->footer("\nExit codes: 0 none is missing; 1 some are; 2 a mistake.");

  CLI::App* merge_command = command("merge", "Make one JUnit, HTML and CSV file of all results", merge);
  out(merge_command);
  any_build(merge_command);
  merge_command->add_option("--junit", options->junit, "Default: NAME.junit.xml in the folder of the results");
  merge_command->add_option("--html", options->html, "Default: NAME.html there");
  merge_command->add_option("--csv", options->csv, "Default: NAME.csv there");
  merge_command->footer(
      "\nExit codes: 0 all passed; 1 one failed; 2 one could not run, crashed, has no result or two.");

  CLI::App* repro_command = command("repro", "Write a case as a plain scenario", repro);
  repro_command->add_option("CASE", options->number, "Its number")->required();
  repro_command->add_option("-o,--output", options->output, "Default: NAME_case_CASE.yaml; - is standard output");

  CLI::App* shrink_command = command("shrink", "Make a failing case as small as it can be", shrink);
  shrink_command->add_option("CASE", options->number, "Its number")->required();
  shrink_command->add_option("-o,--output", options->output,
                             "Default: NAME_case_CASE_small.yaml; - is standard output");
  shrink_command->add_option("--runs", options->max_runs, "End after so many; default: 1000");

  sub->add_subcommand("schema", "Print the JSON Schema of campaign files")->callback([] { print_schema(); });
}

}  // namespace vinv::tools
