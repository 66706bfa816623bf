#include "sim/scenario/report/report_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/sim/scenario/report/sample_run.hpp"
#include "tests/support/read_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ReportFolderTest : public ::testing::Test {
 protected:
  std::string folder(const std::string& name) const { return root_ + "/" + name; }
  static std::map<std::string, std::string> content(const std::string& path) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(path))
      files[entry.path().filename().string()] = test::read_file(entry.path());
    return files;
  }
  static std::vector<std::string> names(const std::string& path) {
    std::vector<std::string> found;
    for (const auto& [name, text] : content(path)) found.push_back(name);
    return found;
  }
  static std::string failure_of(ReportFolder& writer, const RunResult& result) {
    try {
      writer.write(nullptr, result);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const std::string root_ = temporary_.path();
};

TEST_F(ReportFolderTest, ARunWithWiresHasAllFiles) {
  RunResult r = small_run();
  r.recording.wire = sample_wire();
  ReportFolder writer(folder("a/b"), "build 1");
  writer.write(nullptr, r);
  writer.finish();
  EXPECT_THAT(names(folder("a/b")),
              ElementsAre("fr-e500_stop.candump.log", "fr-e500_stop.csv", "fr-e500_stop.events.csv",
                          "fr-e500_stop.html", "fr-e500_stop.pcapng", "fr-e500_stop.states.csv", "index.html"));
}

TEST_F(ReportFolderTest, TheSameRunsGiveTheSameBytesInAnotherFolder) {
  RunResult r = small_run();
  r.recording.wire = sample_wire();
  for (const char* name : {"one", "another"}) {
    ReportFolder writer(folder(name), "build 1");
    writer.write(nullptr, r);
    writer.write(nullptr, long_run(100));
    writer.finish();
  }
  EXPECT_EQ(content(folder("one")), content(folder("another")));
}

TEST_F(ReportFolderTest, RunsOfTheSameNameDoNotOverwriteEachOther) {
  ReportFolder writer(folder("x"), "");
  RunResult r = small_run();
  r.verdict = Verdict::kNotRun;
  r.recording = {};
  writer.write(nullptr, r);
  writer.write(nullptr, r);
  r.path = "index.yaml";
  writer.write(nullptr, r);
  writer.finish();
  EXPECT_THAT(names(folder("x")),
              ElementsAre("fr-e500_stop-2.html", "fr-e500_stop.html", "index-2.html", "index.html"));
}

TEST_F(ReportFolderTest, AFullDiskCostsOnlyTheFileThatDoesNotFit) {
  fs::create_directory(folder("x"));
  ReportFolder writer(folder("x"), "");
  fs::create_symlink("/dev/full", folder("x/fr-e500_stop.csv.new"));
  const std::string failure = failure_of(writer, small_run());
  EXPECT_EQ(failure, folder("x") + "/fr-e500_stop.csv.new cannot be written: No space left on device.");
  writer.finish();
  EXPECT_THAT(names(folder("x")),
              ElementsAre("fr-e500_stop.events.csv", "fr-e500_stop.html", "fr-e500_stop.states.csv", "index.html"));
  const auto files = content(folder("x"));
  EXPECT_THAT(files.at("fr-e500_stop.html"), Not(HasSubstr("fr-e500_stop.csv"))) << "no link to nothing";
  EXPECT_THAT(files.at("index.html"), HasSubstr("No space left on device"));
}

TEST_F(ReportFolderTest, AFullDiskLeavesAnOlderReportAsItWas) {
  ReportFolder writer(folder("x"), "");
  writer.write(nullptr, small_run());
  const auto before = content(folder("x"));
  ReportFolder again(folder("x"), "");
  fs::create_symlink("/dev/full", folder("x/fr-e500_stop.html.new"));
  RunResult other = small_run();
  other.title = "another title";
  EXPECT_NE(failure_of(again, other), "");
  EXPECT_EQ(content(folder("x")).at("fr-e500_stop.html"), before.at("fr-e500_stop.html"));
}

TEST_F(ReportFolderTest, AFolderThatIsGoneIsMadeAgain) {
  ReportFolder writer(folder("x"), "");
  writer.write(nullptr, small_run());
  fs::remove_all(folder("x"));
  EXPECT_EQ(failure_of(writer, small_run()), "");
  EXPECT_EQ(names(folder("x")).size(), 4U);
}

TEST_F(ReportFolderTest, AFolderThatCannotBeMadeIsReportedAtTheFirstRunAndAtTheEnd) {
  std::ofstream(folder("file")) << "here";
  for (const std::string& path : {folder("file"), folder("file/y")}) {
    ReportFolder writer(path, "");
    EXPECT_EQ(failure_of(writer, small_run()), "the report folder " + path + " cannot be made: Not a directory.");
    EXPECT_EQ(failure_of(writer, small_run()), "") << "once is enough";
    try {
      writer.finish();
      ADD_FAILURE() << path;
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(e.what(), "2 runs have no report: the folder " + path + " cannot be made: Not a directory.");
    }
  }
}

}  // namespace
}  // namespace vinv::scenario
