// Reading: what a scenario is made of. What is refused is in broken/.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

using testing::kHead;
using testing::load_options;
using testing::read;

TEST(ScenarioFile, HasTitleNameLimitSeedAndTolerance) {
  const Scenario s = parse_scenario(
      "# Shows something.\nplant: { drives: [{}] }\nseed: 7\nlimit: 2 min\ntolerance: { time: 50 ms, value: 2 % }\n"
      "steps: [ stop ]\n",
      "folder/story.yaml", load_options());
  EXPECT_EQ(s.title, "Shows something.");
  EXPECT_EQ(s.name, "story");
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(s.limit, std::chrono::minutes(2));
  EXPECT_EQ(s.tolerance.time, std::chrono::milliseconds(50));
  EXPECT_DOUBLE_EQ(s.tolerance.value, 0.02);
  ASSERT_EQ(s.tracks.size(), 1u);
  EXPECT_EQ(s.tracks[0].steps.at(0).text, "stop");
}

TEST(ScenarioFile, KeepsThePlaceOfEachStep) {
  const Scenario s = read(std::string(kHead) + "steps:\n  - stop\n  - { after: 1 s, run: forward }\n");
  EXPECT_EQ(s.tracks[0].steps[0].at.line, 9);
  EXPECT_EQ(s.tracks[0].steps[1].at.line, 10);
  EXPECT_EQ(s.tracks[0].steps[1].at.column, 5);
}

TEST(ScenarioFile, FindsAPlantFileBesideItself) {
  const Scenario s = parse_scenario("# A.\nplant: ../plants/demo.yaml\nsteps: [ { drive: fan_1, run: forward } ]\n",
                                    VINV_SOURCE_DIR "/scenarios/fr-e500/x.yaml", load_options());
  EXPECT_EQ(s.plant.drives.size(), 4u);
  EXPECT_EQ(s.tracks[0].steps[0].drive, 1u);
}

TEST(ScenarioFile, VariablesStandInPlantAndStepsAndCanBeGivenFromOutside) {
  const std::string text =
      "# A.\nvariables: { model: FR-E540-1.5K, f: 40 Hz, half: \"${f / 2}\", t: RH }\n"
      "plant: { drives: [ { inverter: { model: $model } } ] }\n"
      "steps:\n  - reference: $half\n  - terminal: { $t: on }\n";
  const auto reference = [](const Scenario& s) {
    return std::get<Action>(s.tracks[0].steps[0].what).value.get<std::string>();
  };
  const Scenario as_written = read(text);
  EXPECT_EQ(as_written.plant.drives[0].model.value, "FR-E540-1.5K");
  EXPECT_EQ(reference(as_written), "20 Hz");
  EXPECT_TRUE(std::get<Action>(as_written.tracks[0].steps[1].what).value.contains("RH"));
  LoadOptions options = load_options();
  options.variables = {{"f", "10 Hz"}, {"model", "FR-E520-0.4K"}};
  const Scenario given = read(text, options);
  EXPECT_EQ(given.plant.drives[0].model.value, "FR-E520-0.4K");
  EXPECT_EQ(reference(given), "5 Hz");
  options.variables = {{"g", "10 Hz"}};
  EXPECT_THROW(read(text, options), ScenarioFileError);
}

TEST(ScenarioFile, ASpanMayBeAVariableAndItsStepsHaveTheInnerOnes) {
  const RunResult r =
      testing::run(std::string(testing::kHead) +
                   "variables: { span: 250 ms, f: 10 Hz }\n"
                   "steps:\n"
                   "  - { always: { alarm: none }, during: $span }\n"
                   "  - repeat:\n      each: { f: [12 Hz, 14 Hz] }\n      steps:\n"
                   "        - { always: { alarm: none }, during: [ { note: $f } , { after: $span } ] }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << testing::failures(r);
  std::string notes;
  for (const Event& e : r.events)
    if (e.kind == Event::Kind::kNote) notes += e.text + ";";
  EXPECT_EQ(notes, "12 Hz;14 Hz;");
}

TEST(ScenarioFile, AnEachThatIsReadSeveralTimesTellsItsMistakeOnce) {
  try {
    read(std::string(kHead) + "steps:\n  - repeat: { each: { f: [1, 2, 3] }, steps: [ { rum: forward } ] }\n");
    FAIL();
  } catch (const ScenarioFileError& e) {
    EXPECT_EQ(e.problems().size(), 1u) << e.what();
  }
}

TEST(ScenarioFile, RunsAsOftenAsOneLikesFromOneReading) {
  const Scenario s = read(std::string(kHead) + testing::kRunning + "  - check: running\n");
  const RunResult first = run_virtual(s, rig::shipped_catalogue(), {});
  const RunResult second = run_virtual(s, rig::shipped_catalogue(), {});
  EXPECT_EQ(first.verdict, Verdict::kPassed);
  EXPECT_EQ(second.verdict, Verdict::kPassed);
  EXPECT_EQ(first.end, second.end);
}

TEST(ScenarioFile, HugeAndEndlessTextsAreRefusedQuickly) {
  std::string bomb = "# A.\na: &a [x, x, x, x, x, x, x, x, x, x]\n";
  std::string last = "a";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 10; ++i) bomb += (i > 0 ? ", *" : "*") + last;
    bomb += "]\n";
    last = c;
  }
  EXPECT_THROW(read(bomb), ScenarioFileError);
  std::string deep = "# A.\nsteps: ";
  for (int i = 0; i < 100; ++i) deep += "[";
  for (int i = 0; i < 100; ++i) deep += "]";
  EXPECT_THROW(read(deep), ScenarioFileError);
  EXPECT_THROW(read(std::string(rig::kMaxPlantFileBytes + 1, '#')), ScenarioFileError);
  EXPECT_THROW(load_scenario("/nowhere.yaml", load_options()), ScenarioFileError);
  EXPECT_THROW(load_scenario(VINV_SOURCE_DIR, load_options()), ScenarioFileError);
}

TEST(ScenarioFile, TooManyStepsAreRefused) {
  std::string text = std::string(kHead) + "steps:\n  - repeat:\n      each: { a: [";
  for (int i = 0; i < 400; ++i) text += (i > 0 ? "," : "") + std::to_string(i);
  text += "] }\n      steps:\n        - repeat:\n            each: { b: [";
  for (int i = 0; i < 400; ++i) text += (i > 0 ? "," : "") + std::to_string(i);
  text += "] }\n            steps: [ { note: $a $b } ]\n";
  try {
    read(text);
    FAIL();
  } catch (const ScenarioFileError& e) {
    EXPECT_NE(std::string(e.what()).find("more than 100000 steps"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace vinv::scenario
