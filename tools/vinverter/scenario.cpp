// vinverter scenario: checks, lists and runs scenario files.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sim/scenario/batch.hpp"
#include "sim/scenario/junit.hpp"
#include "sim/scenario/live_run.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/report/report_folder.hpp"
#include "sim/scenario/units.hpp"
#include "tools/vinverter/subcommands.hpp"
#include "vinverter_data.hpp"

namespace vinv::tools {
namespace {

using scenario::RunResult;
using scenario::Verdict;

struct ScenarioOptions {
  std::vector<std::string> paths;
  std::string folder = "scenarios";
  std::string filter;
  std::vector<std::string> set;
  bool live = false;
  bool verbose = false;
  std::string junit;
  std::string report;
  std::uint64_t seed = 0;
  bool has_seed = false;
  std::size_t jobs = 0;
};

scenario::LoadOptions load_options(const ScenarioOptions& options) {
  scenario::LoadOptions load;
  load.catalogue = rig::shipped_catalogue();
  load.masters = scenario::protocol_masters();
  for (const std::string& text : options.set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw std::runtime_error("--set " + text + ": write --set NAME=VALUE.");
    load.variables[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return load;
}

std::vector<std::string> files_of(const ScenarioOptions& options) {
  auto files = scenario::find_scenarios(options.paths, options.filter);
  if (files.empty())
    throw std::runtime_error("there is no scenario" + (options.filter.empty()
                                                           ? std::string(".")
                                                           : " with \"" + options.filter + "\" in its path or title."));
  return files;
}

int check(const ScenarioOptions& options) {
  const auto load = load_options(options);
  std::size_t bad = 0;
  const auto files = files_of(options);
  for (const std::string& file : files) {
    try {
      scenario::load_scenario(file, load);
    } catch (const scenario::ScenarioFileError& e) {
      ++bad;
      fmt::print(stderr, "{}\n", e.what());
    }
  }
  fmt::print("{} of {} scenarios are in order\n", files.size() - bad, files.size());
  return bad == 0 ? kDone : kUnusable;
}

int list(const ScenarioOptions& options) {
  const auto files = scenario::find_scenarios({options.folder}, options.filter);
  std::size_t width = 0;
  for (const std::string& file : files) width = std::max(width, file.size());
  for (const std::string& file : files) fmt::print("{:<{}}  {}\n", file, width, scenario::scenario_title(file));
  return kDone;
}

// On a terminal a bar below the lines of results, redrawn in place.
class Progress {
 public:
  explicit Progress(std::size_t total) : total_(total), terminal_(::isatty(STDERR_FILENO) != 0 && total > 1) { draw(); }
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void line(std::FILE* to, const std::string& text) {
    clear();
    fmt::print(to, "{}", text);
    std::fflush(to);
    draw();
  }
  void done(std::size_t n, bool failed) {
    clear();
    done_ = n;
    failed_ += failed ? 1 : 0;
    draw();
  }

 private:
  void clear() const {
    if (terminal_) fmt::print(stderr, "\r\033[K");
  }
  void draw() const {
    constexpr std::size_t kWidth = 40;
    if (!terminal_) return;
    const std::size_t filled = total_ == 0 ? 0 : done_ * kWidth / total_;
    fmt::print(stderr, "[{:=<{}}{:.<{}}] {}/{}{}", "", filled, "", kWidth - filled, done_, total_,
               failed_ > 0 ? fmt::format(", {} failed", failed_) : "");
    std::fflush(stderr);
  }
  std::size_t total_;
  bool terminal_;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
};

std::string summary(const RunResult& r, bool verbose) {
  const auto passed = r.checks.size() - r.failures();
  const char* word = r.verdict == Verdict::kPassed ? "passed" : r.verdict == Verdict::kFailed ? "FAILED" : "NOT RUN";
  std::string out = fmt::format("{:<7}  {}", word, r.path);
  if (r.verdict != Verdict::kNotRun)
    out += fmt::format("  {} of {} checks, {}", passed, r.checks.size(), scenario::show_time(r.end));
  out += "\n";
  if (verbose)
    for (const auto& e : r.events)
      out += fmt::format("  {:>10}  {}{}\n", scenario::show_time(e.at), e.drive.empty() ? "" : e.drive + ": ", e.text);
  if (r.verdict == Verdict::kNotRun) out += r.reason + "\n";
  for (const auto& c : r.checks)
    if (!c.passed) out += scenario::failure_text(r, c);
  return out;
}

int run(const ScenarioOptions& options) {
  const auto files = files_of(options);
  scenario::BatchOptions batch;
  batch.load = load_options(options);
  batch.run.masters = batch.load.masters;
  if (options.has_seed) batch.run.seed = options.seed;
  batch.jobs = options.jobs != 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::unique_ptr<scenario::ReportWriter>> writers;
  if (!options.junit.empty()) writers.push_back(std::make_unique<scenario::JunitWriter>(options.junit));
  if (!options.report.empty()) {
    writers.push_back(std::make_unique<scenario::ReportFolder>(
        options.report, fmt::format("vinverter {} ({})", VINV_VERSION, VINV_GIT_DESCRIBE)));
  }
  scenario::BatchResult result;
  {
    Progress progress(files.size());
    if (options.live) {
      batch.jobs = 1;  // wires and control sockets have one name each
      batch.run_one = [&](const scenario::Scenario& s) {
        return scenario::run_live(s, batch.load.catalogue, batch.run,
                                  [&](const std::string& text) { progress.line(stderr, text); });
      };
    }
    batch.on_result = [&](std::size_t done, const RunResult& r) {
      progress.done(done, r.verdict != Verdict::kPassed);
      progress.line(stdout, summary(r, options.verbose));
    };
    batch.on_trouble = [&](const std::string& sentence) { progress.line(stderr, "vinverter: " + sentence + "\n"); };
    result = scenario::run_batch(files, batch, writers);
  }
  fmt::print("{} scenarios: {} passed, {} failed, {} could not run\n", files.size(), result.passed, result.failed,
             result.not_run);
  if (result.not_run > 0 || result.not_written > 0) return kUnusable;
  return result.failed > 0 ? kRefused : kDone;
}

// In one piece: the plant's schema, a file of its own in docs, takes the place of the reference to it.
void print_schema() {
  auto schema = rig::Json::parse(data::SCENARIO_SCHEMA);
  for (rig::Json& form : schema["properties"]["plant"]["anyOf"]) {
    if (!form.contains("$ref")) continue;
    form = rig::Json::parse(data::SCENARIO_PLANT_SCHEMA);
    form.erase("$schema");
  }
  fmt::print("{}\n", schema.dump(2));
}

}  // namespace

void add_scenario(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ScenarioOptions>();
  CLI::App* sub = app.add_subcommand("scenario", "Run scripted stories with checks, in virtual time or live");
  sub->require_subcommand(1);
  sub->footer(R"(
Examples:
  vinverter scenario list                       what there is, with what it shows
  vinverter scenario run scenarios/fr-e500      of a folder all scenarios in it and below
  vinverter scenario check my_story.yaml        every mistake of a file, without running it
  vinverter scenario run my_story.yaml --report out --junit out/junit.xml
  vinverter scenario run my_story.yaml --set ramp=2s --seed 7
  vinverter scenario run my_story.yaml --live   in real time, for a real master

Exit codes: 0 all passed; 1 one failed; 2 one could not run, or a report could not be written.
)");
  const auto common = [&](CLI::App* command) {
    command->add_option("PATH", options->paths, "Scenario files, or folders with them")->required();
    command->add_option("--filter", options->filter, "Only those with this text in their path or title");
    command->add_option("--set", options->set, "Value for a variable of the file: NAME=VALUE")->allow_extra_args(false);
  };

  CLI::App* check_command = sub->add_subcommand("check", "Read scenario files and tell every mistake, without running");
  common(check_command);
  check_command->callback([options, &exit_code] { exit_code = check(*options); });

  CLI::App* list_command = sub->add_subcommand("list", "List the scenarios of a folder with what they show");
  list_command->add_option("FOLDER", options->folder, "Default: scenarios");
  list_command->add_option("--filter", options->filter, "Only those with this text in their path or title");
  list_command->callback([options, &exit_code] { exit_code = list(*options); });

  CLI::App* run_command = sub->add_subcommand("run", "Run scenarios and judge their checks");
  common(run_command);
  run_command->add_flag("--live", options->live, "In real time, with the plant's wires open, one after the other");
  run_command->add_option("--junit", options->junit, "Write a JUnit XML file");
  run_command->add_option("--report", options->report,
                          "Write HTML, CSV, candump and pcapng of each run into this folder");
  CLI::Option* seed = run_command->add_option("--seed", options->seed, "In place of the files' seeds");
  run_command->add_option("--jobs", options->jobs, "How many run at a time; default: one per processor");
  run_command->add_flag("--verbose", options->verbose, "Print all events of each run");
  run_command->footer(
      "\nExit codes: 0 all passed; 1 one failed; 2 one could not run, or a report could not be written.");
  run_command->callback([options, seed, &exit_code] {
    options->has_seed = seed->count() > 0;
    exit_code = run(*options);
  });

  sub->add_subcommand("schema", "Print the JSON Schema of scenario files")->callback([] { print_schema(); });
}

}  // namespace vinv::tools
