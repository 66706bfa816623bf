// JUnit XML and CSV.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sim/scenario/csv_writer.hpp"
#include "sim/scenario/junit.hpp"
#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

TEST(Junit, HasASuitePerFolderAndTellsFailuresAndErrors) {
  JunitWriter writer("unused");
  RunResult passed;
  passed.path = "a/one.yaml";
  passed.name = "one";
  passed.title = "Shows <this> & \"that\".";
  passed.verdict = Verdict::kPassed;
  passed.end = Instant{} + std::chrono::milliseconds(1500);
  RunResult failed = passed;
  failed.path = "a/two.yaml";
  failed.name = "two";
  failed.verdict = Verdict::kFailed;
  CheckResult check;
  check.what = "check: speed";
  check.expected = "1 rpm";
  check.seen = "2 rpm\x01";
  failed.checks.push_back(check);
  RunResult not_run;
  not_run.path = "three.yaml";
  not_run.name = "three";
  not_run.reason = "three.yaml:1:1: bad\nthree.yaml:2:1: worse";
  for (const RunResult& r : {passed, failed, not_run}) writer.write(nullptr, r);
  const std::string text = writer.text();
  EXPECT_NE(text.find("<testsuites name=\"vinverter\" tests=\"3\" failures=\"1\" errors=\"1\">"), std::string::npos)
      << text;
  EXPECT_NE(text.find("<testsuite name=\"a\" tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"0\" time=\"3.000\">"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("Shows &lt;this&gt; &amp; &quot;that&quot;."), std::string::npos);
  EXPECT_NE(text.find("message=\"check: speed: expected 1 rpm, seen 2 rpm?\""), std::string::npos) << text;
  EXPECT_NE(text.find("<error message=\"three.yaml:1:1: bad\">"), std::string::npos) << text;
}

TEST(Csv, HasARowPerSampleAndPerEvent) {
  const RunResult r = testing::run_steps("  - note: a, \"b\"\n");
  const std::string signals = signals_csv(r.recording);
  EXPECT_EQ(signals.substr(0, 7), "time_s,");
  EXPECT_NE(signals.find("drive_1.output_frequency Hz"), std::string::npos);
  EXPECT_EQ(static_cast<std::size_t>(std::count(signals.begin(), signals.end(), '\n')), r.recording.times.size() + 1);
  EXPECT_NE(events_csv(r).find(",note,,12,\"a, \"\"b\"\"\"\n"), std::string::npos) << events_csv(r);
}

TEST(Reports, AFullDiskAndABadFolderAreSentences) {
  EXPECT_THROW(write_file("/dev/full", std::string(100'000, 'x')), std::runtime_error);
  const RunResult r = testing::run_steps("  - note: a\n");
  CsvWriter in_a_file("/dev/null/reports");
  EXPECT_THROW(in_a_file.write(nullptr, r), std::runtime_error);
}

TEST(Reports, FileNamesTellFoldersApart) {
  RunResult r;
  r.path = "scenarios/fr-e500/a b.yaml";
  EXPECT_EQ(report_stem(r), "fr-e500_a_b");
  r.path = "x.yaml";
  EXPECT_EQ(report_stem(r), "x");
}

}  // namespace
}  // namespace vinv::scenario
