// Each broken file beside its messages, as `vinverter scenario check` prints them. With VINV_UPDATE set the messages
// are written anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/sim/scenario/support.hpp"
#include "tests/support/read_file.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;

TEST(BrokenFiles, EachIsRefusedWithItsMessages) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(VINV_SOURCE_DIR "/tests/sim/scenario/broken"))
    if (entry.path().extension() == ".yaml" && entry.path().stem() != "bad_plant") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  EXPECT_GE(files.size(), 40u);
  // Messages name the file as it was given.
  const fs::path before = fs::current_path();
  fs::current_path(VINV_SOURCE_DIR "/tests/sim/scenario/broken");
  for (const fs::path& file : files) {
    std::string said = "accepted\n";
    try {
      load_scenario(file.filename().string(), testing::load_options());
    } catch (const ScenarioFileError& e) {
      said = std::string(e.what()) + "\n";
    }
    fs::path expected = file;
    expected.replace_extension(".txt");
    if (std::getenv("VINV_UPDATE") != nullptr) std::ofstream(expected) << said;
    EXPECT_EQ(said, test::read_file(expected)) << file;
    EXPECT_NE(said, "accepted\n") << file;
  }
  fs::current_path(before);
}

}  // namespace
}  // namespace vinv::scenario
