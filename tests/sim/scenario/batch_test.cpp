// Several scenarios in one go.
#include "sim/scenario/batch.hpp"

#include <filesystem>
#include <fstream>

#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("vinv-batch-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path / "deep"); }
  ~Folder() { fs::remove_all(path); }
  std::string add(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
};

const std::string kGood = std::string(testing::kHead) + "steps:\n  - when: ready\n    check: { mode: EXT }\n";
const std::string kBad = std::string(testing::kHead) + "steps:\n  - when: ready\n    check: { mode: PU }\n";

struct Collect : ReportWriter {
  std::vector<std::string>* names;
  bool fails = false;
  bool finished = false;
  void write(const Scenario* scenario, const RunResult& result) override {
    names->push_back(result.name + (scenario == nullptr ? "!" : ""));
    if (fails) throw std::runtime_error("no room");
  }
  void finish() override { finished = true; }
};

TEST(Batch, FindsScenariosInFoldersAndFiltersThem) {
  const Folder folder;
  folder.add("b.yaml", kGood);
  folder.add("a.yaml", kBad);
  folder.add("deep/c.yml", kGood);
  folder.add("plant.yaml", "drives: [{}]\n");
  folder.add("campaign.yaml", "# C.\nscenario: a.yaml\nvariations: []\n");
  folder.add("notes.txt", kGood);
  folder.add("broken.yaml", "steps: 5\n");
  std::vector<std::string> names;
  for (const auto& f : find_scenarios({folder.path.string()}, "")) names.push_back(fs::path(f).filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"a.yaml", "b.yaml", "broken.yaml", "c.yml"}));
  EXPECT_EQ(find_scenarios({folder.path.string()}, "deep").size(), 1u);
  EXPECT_EQ(find_scenarios({folder.path.string()}, "A test.").size(), 3u) << "titles count too";
  EXPECT_THROW(find_scenarios({"/nowhere"}, ""), std::runtime_error);
}

TEST(Batch, RunsAllWhateverBecomesOfOneAndHandsOutResultsInOrder) {
  const Folder folder;
  const std::vector<std::string> files{folder.add("1.yaml", kGood), folder.add("2.yaml", "# A.\nsteps: 5\n"),
                                       folder.add("3.yaml", kBad), folder.add("4.yaml", kGood)};
  std::vector<std::string> written, also_written;
  std::vector<std::unique_ptr<ReportWriter>> writers;
  auto failing = std::make_unique<Collect>();
  failing->names = &written;
  failing->fails = true;
  writers.push_back(std::move(failing));
  auto fine = std::make_unique<Collect>();
  fine->names = &also_written;
  Collect* finished = fine.get();
  writers.push_back(std::move(fine));
  BatchOptions options;
  options.load = testing::load_options();
  options.jobs = 3;
  std::vector<std::size_t> order;
  int troubles = 0;
  options.on_result = [&](std::size_t done, const RunResult&) { order.push_back(done); };
  options.on_trouble = [&](const std::string& sentence) {
    ++troubles;
    EXPECT_EQ(sentence, "no room.");
  };
  const BatchResult r = run_batch(files, options, writers);
  EXPECT_EQ(r.passed, 2u);
  EXPECT_EQ(r.failed, 1u);
  EXPECT_EQ(r.not_run, 1u);
  EXPECT_EQ(r.not_written, 4u);
  EXPECT_EQ(troubles, 4);
  EXPECT_EQ(order, (std::vector<std::size_t>{1, 2, 3, 4}));
  EXPECT_EQ(also_written, (std::vector<std::string>{"1", "2!", "3", "4"}));
  EXPECT_TRUE(finished->finished);
}

}  // namespace
}  // namespace vinv::scenario
