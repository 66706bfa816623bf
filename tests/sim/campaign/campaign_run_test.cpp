// Running shards: the same results however they are cut, nothing run twice, nothing lost.
#include "sim/campaign/campaign_run.hpp"

#include <csignal>
#include <cstdlib>
#include <set>

#include "sim/campaign/merge.hpp"
#include "sim/campaign/shrink.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/virtual_run.hpp"
#include "tests/sim/campaign/support.hpp"

namespace vinv::campaign {
namespace {

using testing::Folder;
using testing::read;
using testing::run_options;

// 5 ... 12 Hz, of which those above 10 Hz fail.
const char* const kCases =
    "  - grid: { speed: { from: 5 Hz, to: 12 Hz, step: 1 Hz } }\nmeasure: { top: { maximum: output_frequency } }\n";

std::string merged(const Campaign& c, const Folder& folder) {
  const Results r = read_results(folder.path.string(), c, "test build");
  return merged_junit(c, r) + merged_csv(c, r) + merged_page(c, r, "test build");
}

// A quick answer in place of a run.
scenario::RunResult passed(const std::string&, const std::string& path) {
  scenario::RunResult r;
  r.path = path;
  r.verdict = scenario::Verdict::kPassed;
  return r;
}

TEST(CampaignRun, MergedBytesAreTheSameForAnyShardsAndJobs) {
  const Campaign c = read(kCases);
  const Folder whole("whole"), cut("cut");
  const auto result = run_campaign(c, run_options(whole));
  EXPECT_EQ(result.passed, 6u);
  EXPECT_EQ(result.failed, 2u);
  for (const std::uint64_t i : {3u, 1u, 2u}) {
    auto options = run_options(cut);
    options.shard = {i, 3};
    options.jobs = i;
    run_campaign(c, options);
  }
  EXPECT_EQ(merged(c, whole), merged(c, cut));
  const std::string csv = merged_csv(c, read_results(cut.path.string(), c, "test build"));
  EXPECT_NE(csv.find("\r\n7,failed,,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",11 Hz,11,\"pump check: output_frequency: expected below 10.2 Hz, seen 11 Hz\"\r\n"),
            std::string::npos)
      << csv;
  const std::string junit = merged_junit(c, read_results(cut.path.string(), c, "test build"));
  EXPECT_NE(junit.find("<testsuites name=\"vinverter\" tests=\"8\" failures=\"2\" errors=\"0\">"), std::string::npos)
      << junit;
}

TEST(CampaignRun, FinishedCasesAreNotRunAgainInWhateverShard) {
  const Campaign c = read(kCases);
  const Folder folder("again");
  auto options = run_options(folder);
  options.run_one = passed;
  options.shard = {1, 2};
  run_campaign(c, options);
  EXPECT_EQ(missing_cases(c, read_results(folder.path.string(), c, "test build"), {}),
            (std::vector<std::uint64_t>{2, 4, 6, 8}));
  options.shard = {1, 1};
  std::set<std::uint64_t> run;
  options.on_result = [&](std::uint64_t, std::uint64_t to_do, const CaseResult& r) {
    EXPECT_EQ(to_do, 4u);
    run.insert(r.number);
  };
  const auto result = run_campaign(c, options);
  EXPECT_EQ(run, (std::set<std::uint64_t>{2, 4, 6, 8}));
  EXPECT_EQ(result.found, 4u);
  EXPECT_EQ(result.passed, 8u);
  EXPECT_EQ(result.without_result, 0u);
}

TEST(CampaignRun, TornLineIsNoResultAndItsCaseRunsAgain) {
  const Campaign c = read(kCases);
  const Folder folder("torn");
  auto options = run_options(folder);
  options.run_one = passed;
  run_campaign(c, options);
  const std::string file = shard_file(c, folder.path.string(), {});
  for (const std::uintmax_t gone : {1u, 2u, 40u}) {
    fs::resize_file(file, fs::file_size(file) - gone);
    // Without its line feed alone, the line is whole.
    const std::size_t lost = gone == 1 ? 0 : 1;
    std::vector<std::string> told;
    options.on_trouble = [&](const std::string& s) { told.push_back(s); };
    const auto result = run_campaign(c, options);
    EXPECT_EQ(result.found, 8 - lost) << gone;
    EXPECT_EQ(result.passed, 8u);
    EXPECT_EQ(missing_cases(c, read_results(folder.path.string(), c, "test build"), {}).size(), 0u) << gone;
  }
}

TEST(CampaignRun, CrashCostsOnlyItsOwnCase) {
  const Campaign c = read(kCases);
  const Folder folder("crash");
  auto options = run_options(folder);
  options.jobs = 2;
  options.run_one = [](const std::string& text, const std::string& path) {
    if (text.find("case 3:") != std::string::npos) {
      std::signal(SIGABRT, SIG_DFL);
      std::abort();
    }
    if (text.find("case 5:") != std::string::npos) ::_exit(7);
    return passed(text, path);
  };
  const auto result = run_campaign(c, options);
  EXPECT_EQ(result.passed, 6u);
  EXPECT_EQ(result.crashed, 2u);
  const Results results = read_results(folder.path.string(), c, "test build");
  EXPECT_EQ(results.cases.at(3).reason, "the process died of signal 6 (SIGABRT).");
  EXPECT_EQ(results.cases.at(5).reason, "the process ended with status 7.");
  EXPECT_EQ(run_campaign(c, options).found, 8u) << "a crash is a result";
}

TEST(CampaignRun, CaseThatWasEndedFromOutsideHasNoResult) {
  const Campaign c = read(kCases);
  const Folder folder("killed");
  auto options = run_options(folder);
  std::vector<std::string> told;
  options.on_trouble = [&](const std::string& s) { told.push_back(s); };
  options.run_one = [](const std::string& text, const std::string& path) {
    if (text.find("case 3:") != std::string::npos) std::raise(SIGKILL);
    return passed(text, path);
  };
  const auto result = run_campaign(c, options);
  EXPECT_EQ(result.passed, 7u);
  EXPECT_EQ(result.without_result, 1u);
  EXPECT_EQ(told, (std::vector<std::string>{"case 3 has no result: the process died of signal 9 (SIGKILL)."}));
}

TEST(CampaignRun, FullDiskIsToldOnceAndOtherResultsStay) {
  const Campaign c = read(kCases);
  const Folder folder("full");
  auto options = run_options(folder);
  options.run_one = passed;
  options.shard = {1, 2};
  run_campaign(c, options);
  fs::create_symlink("/dev/full", shard_file(c, folder.path.string(), {2, 2}));
  options.shard = {2, 2};
  std::vector<std::string> told;
  options.on_trouble = [&](const std::string& s) { told.push_back(s); };
  const auto result = run_campaign(c, options);
  EXPECT_EQ(result.without_result, 4u);
  EXPECT_EQ(told, (std::vector<std::string>{shard_file(c, folder.path.string(), {2, 2}) +
                                            " cannot be written: No space left on device."}));
  EXPECT_EQ(read_results(folder.path.string(), c, "test build").cases.size(), 4u);
}

TEST(CampaignRun, FolderThatCannotBeMadeIsAMistake) {
  const Campaign c = read(kCases);
  const Folder folder("none");
  std::ofstream(folder / "file") << "x";
  auto options = run_options(folder);
  options.folder = folder / "file/results";
  try {
    run_campaign(c, options);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()), options.folder + " cannot be made: Not a directory.");
  }
}

TEST(CampaignRun, ResultsOfOtherFilesAndBuildsDoNotCount) {
  const Campaign c = read(kCases);
  const Folder folder("builds");
  auto options = run_options(folder);
  options.run_one = passed;
  run_campaign(c, options);
  const Campaign changed =
      read("  - grid: { speed: [5 Hz, 6.5 Hz] }\nmeasure: { top: { maximum: output_frequency } }\n");
  const Results of_changed = read_results(folder.path.string(), changed, "test build");
  EXPECT_EQ(of_changed.cases.size(), 1u);
  EXPECT_EQ(of_changed.other_state, 7u);
  const Results newer = read_results(folder.path.string(), c, "newer build");
  EXPECT_EQ(newer.cases.size(), 0u);
  EXPECT_EQ(remarks(newer),
            (std::vector<std::string>{"8 results do not count: they are of another build, test build."}));
  EXPECT_EQ(read_results(folder.path.string(), c, "").cases.size(), 8u);
}

TEST(CampaignRun, TwoDifferentResultsOfACaseAreTold) {
  const Campaign c = read(kCases);
  const Folder folder("two");
  auto options = run_options(folder);
  options.run_one = passed;
  run_campaign(c, options);
  const std::string file = shard_file(c, folder.path.string(), {});
  std::string copy = testing::content(file);
  copy.replace(copy.find("\"end_ns\":0"), 10, "\"end_ns\":5");
  std::ofstream(folder / "copy.jsonl") << copy;
  EXPECT_EQ(read_results(folder.path.string(), c, "test build").contradictory, (std::vector<std::uint64_t>{1}));
}

TEST(CampaignRun, TwoRunsOfOneShardAtTheSameTimeAreRefused) {
  const Campaign c = read(kCases);
  const Folder folder("lock");
  const ResultLog held(shard_file(c, folder.path.string(), {}));
  EXPECT_THROW(run_campaign(c, run_options(folder)), std::runtime_error);
}

TEST(CampaignRun, ShardsAreWrittenAsOneOfMany) {
  EXPECT_TRUE(parse_shard("3/8"));
  for (const char* bad : {"", "3", "0/8", "9/8", "1/0", "-1/8", "1/8/2", "1 /8", "a/b"})
    EXPECT_FALSE(parse_shard(bad)) << bad;
}

TEST(CampaignRepro, PlainScenarioGivesTheSameVerdictAndTheSameBytes) {
  const Campaign c = read(kCases);
  const Folder folder("repro");
  const auto options = run_options(folder);
  const auto of_campaign = run_case(c, 8, options);
  const std::string file = folder / "plain.yaml";
  std::ofstream(file) << c.scenario_text(8);
  const auto plain = scenario::run_virtual(scenario::load_scenario(file, options.load), options.load.catalogue, {});
  EXPECT_EQ(plain.verdict, scenario::Verdict::kFailed);
  EXPECT_EQ(to_line(summary(plain, c.measures)), to_line(summary(of_campaign, c.measures)));
  EXPECT_EQ(scenario::signals_csv(plain.recording), scenario::signals_csv(of_campaign.recording));
  EXPECT_EQ(scenario::events_csv(plain), scenario::events_csv(of_campaign));
  EXPECT_EQ(scenario::states_csv(plain.recording), scenario::states_csv(of_campaign.recording));
}

// Things around the failing check that have nothing to do with it.
const char* const kLong =
    "# A long story.\n"
    "scenario:\n"
    "  plant:\n"
    "    drives:\n"
    "      - name: pump\n"
    "        inverter: { model: FR-E540-0.75K }\n"
    "        load: { inertia_kg_m2: 0.002, torque: { constant_Nm: 0.5 } }\n"
    "        parameters: { Pr.7: 0.1, Pr.8: 0.1 }\n"
    "      - { name: fan, inverter: { model: FR-E540-0.4K } }\n"
    "  limit: 9 s\n"
    "  seed: 5\n"
    "  variables: { speed: 5 Hz, pause: 100 ms }\n"
    "  steps:\n"
    "    - { drive: fan, when: ready, reference: 10 Hz }\n"
    "    - { drive: fan, run: forward }\n"
    "    - { drive: pump, when: ready, reference: $speed }\n"
    "    - { drive: pump, after: $pause, run: forward }\n"
    "    - note: here it comes\n"
    "    - { drive: pump, when: at_reference, within: 2 s }\n"
    "    - repeat: { times: 2, steps: [ { drive: fan, check: { alarm: none } }, { note: again } ] }\n"
    "    - { drive: pump, check: { output_frequency: below 10.2 Hz, alarm: none } }\n"
    "variations:\n"
    "  - grid: { speed: [5 Hz, 17.345 Hz], pause: [123.4 ms] }\n";

TEST(CampaignShrink, KeepsTheFailingCheckAndLittleElse) {
  const Campaign c = parse_campaign(kLong, "long.yaml", testing::load_options());
  const Folder folder("shrink");
  const auto result = shrink_case(c, 2, run_options(folder), {});
  EXPECT_TRUE(result.minimal) << result.runs;
  const auto s = scenario::parse_scenario(result.text, "small.yaml", testing::load_options());
  ASSERT_EQ(s.plant.drives.size(), 1u) << result.text;
  EXPECT_LE(s.tracks[0].steps.size(), 4u) << result.text;
  EXPECT_EQ(result.text.find("fan"), std::string::npos) << result.text;
  EXPECT_EQ(result.text.find("note"), std::string::npos) << result.text;
  EXPECT_EQ(result.text.find("17.345"), std::string::npos) << "numbers get shorter:\n" << result.text;
  ASSERT_FALSE(result.result.failures.empty());
  EXPECT_EQ(result.result.failures[0].what, "check: output_frequency");
  const auto again = run_text(result.text, "small.yaml", testing::load_options(), {});
  EXPECT_EQ(to_line(summary(again, {})), to_line(result.result));
}

TEST(CampaignShrink, CrashStaysTheSameCrash) {
  const Campaign c = parse_campaign(kLong, "long.yaml", testing::load_options());
  const Folder folder("shrinkcrash");
  auto options = run_options(folder);
  options.run_one = [](const std::string& text, const std::string& path) {
    std::signal(SIGABRT, SIG_DFL);
    if (text.find("here it comes") != std::string::npos) std::abort();
    return passed(text, path);
  };
  const auto result = shrink_case(c, 2, options, {});
  EXPECT_NE(result.text.find("here it comes"), std::string::npos);
  EXPECT_LT(result.text.size(), 140u) << result.text;
}

TEST(CampaignShrink, EndsAtItsLimitAndRefusesWhatPasses) {
  const Campaign c = parse_campaign(kLong, "long.yaml", testing::load_options());
  const Folder folder("shrinklimit");
  ShrinkOptions how;
  how.max_runs = 3;
  const auto result = shrink_case(c, 2, run_options(folder), how);
  EXPECT_EQ(result.runs, 3u);
  EXPECT_FALSE(result.minimal);
  EXPECT_THROW(shrink_case(c, 1, run_options(folder), how), std::runtime_error);
}

TEST(CampaignPage, HistogramsCountEachCaseOnce) {
  std::vector<std::pair<std::string, int>> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(std::to_string(i) + " Hz", i % 3);
  const auto parts = bars_of(points);
  ASSERT_EQ(parts.size(), 20u);
  EXPECT_EQ(parts[0].label, "0 to 49.95 Hz");
  std::uint64_t sum = 0;
  for (const Bar& b : parts) sum += b.counts[0] + b.counts[1] + b.counts[2];
  EXPECT_EQ(sum, 1000u);
  const auto few = bars_of({{"10 Hz", 0}, {"9 Hz", 1}, {"10 Hz", 1}});
  ASSERT_EQ(few.size(), 2u);
  EXPECT_EQ(few[0].label, "9 Hz");
  EXPECT_EQ(few[1].counts, (std::array<std::uint64_t, 3>{1, 1, 0}));
}

TEST(CampaignPage, GridOverTwoThingsIsAMap) {
  const Campaign c = read("  - set: { speed: 9 Hz }\n  - grid: { speed: [5 Hz, 6 Hz], pause: [2 s, 1 s] }\n");
  Results results;
  for (std::uint64_t k = 1; k <= 5; ++k) {
    CaseResult r;
    r.verdict = k == 4 ? CaseVerdict::kFailed : CaseVerdict::kPassed;
    results.cases[k] = r;
  }
  const std::string page = merged_page(c, results, "");
  EXPECT_NE(page.find("<tr><th>1 s</th><td class=\"passed\">0</td><td class=\"passed\">0</td></tr>\n"
                      "<tr><th>2 s</th><td class=\"passed\">0</td><td class=\"failed\">1</td></tr>"),
            std::string::npos)
      << page;
}

}  // namespace
}  // namespace vinv::campaign
