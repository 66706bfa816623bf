// Same file, seed and build: the same bytes. Every shipped scenario alone, and again while others run.
#include <gtest/gtest.h>

#include <map>

#include "sim/scenario/batch.hpp"
#include "sim/scenario/junit.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_report.hpp"
#include "sim/scenario/report/wire_report.hpp"

namespace vinv::scenario {
namespace {

struct Keep : ReportWriter {
  std::map<std::string, std::string>* texts;
  void write(const Scenario* scenario, const RunResult& result) override {
    JunitWriter junit("unused");
    junit.write(nullptr, result);
    const Bytes capture = wire_pcapng(result.recording);
    (*texts)[result.path] = html_report(scenario, result, "build", {}) + signals_csv(result.recording) +
                            states_csv(result.recording) + events_csv(result) + candump_log(result.recording) +
                            std::string(capture.begin(), capture.end()) + junit.text();
  }
};

std::map<std::string, std::string> texts_with(std::size_t jobs) {
  std::map<std::string, std::string> texts;
  BatchOptions options;
  options.load.catalogue = rig::shipped_catalogue();
  options.load.masters = protocol_masters();
  options.run.masters = options.load.masters;
  options.jobs = jobs;
  auto keep = std::make_unique<Keep>();
  keep->texts = &texts;
  std::vector<std::unique_ptr<ReportWriter>> writers;
  writers.push_back(std::move(keep));
  const auto files = find_scenarios({VINV_SOURCE_DIR "/scenarios"}, "");
  const BatchResult r = run_batch(files, options, writers);
  EXPECT_EQ(r.passed, files.size());
  EXPECT_GE(files.size(), 12u);
  return texts;
}

TEST(Determinism, EachShippedScenarioGivesTheSameBytesAloneAndAmongOthers) {
  const auto alone = texts_with(1);
  const auto together = texts_with(4);
  ASSERT_EQ(alone.size(), together.size());
  for (const auto& [path, text] : alone) EXPECT_TRUE(text == together.at(path)) << path;
}

}  // namespace
}  // namespace vinv::scenario
