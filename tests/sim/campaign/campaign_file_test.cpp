// Campaign files: what they say of a case, and what is wrong with them.
#include "sim/campaign/campaign_file.hpp"

#include <nlohmann/json.hpp>

#include "tests/sim/campaign/support.hpp"
#include "tests/support/alias_bomb.hpp"

namespace vinv::campaign {
namespace {

using testing::file;
using testing::mistakes;
using testing::read;

TEST(CampaignFile, CaseIsAPlainScenarioWithTheValuesInIt) {
  const Campaign c = read(
      "  - grid: { speed: [5 Hz, 6 Hz], /plant/drives/pump/load/inertia_kg_m2: [0.01], "
      "/plant/drives/1/parameters/Pr.9: [3.5], /seed: [9] }\n");
  const auto s = scenario::parse_scenario(c.scenario_text(2), "case.yaml", testing::load_options());
  EXPECT_EQ(s.title,
            "A test., case 2: speed = 6 Hz, /plant/drives/pump/load/inertia_kg_m2 = 0.01, "
            "/plant/drives/1/parameters/Pr.9 = 3.5, /seed = 9");
  EXPECT_EQ(s.variables.at("speed"), "6 Hz");
  EXPECT_DOUBLE_EQ(s.plant.drives[0].load.value.inertia_kg_m2, 0.01);
  EXPECT_EQ(s.plant.drives[0].parameters.back().first.value, "Pr.9");
  EXPECT_EQ(s.seed, 9u);
  EXPECT_EQ(s.tracks[0].steps.size(), 4u);
}

TEST(CampaignFile, PlantAndScenarioFilesBecomePartOfTheCase) {
  const testing::Folder folder("files");
  fs::create_directories(folder.path / "deep");
  std::ofstream(folder / "deep/my plant.yaml") << "drives: [{ name: pump, load: { inertia_kg_m2: 0.5 } }]\n";
  std::ofstream(folder / "deep/story.yaml")
      << "# Story.\nplant: my plant.yaml\nvariables: { pause: 1 s }\nsteps: [{ after: $pause, note: x }]\n";
  std::ofstream(folder / "c.yaml")
      << "# C.\nscenario: deep/story.yaml\nvariations:\n  - grid: { /plant/drives/pump/load/inertia_kg_m2: [0.7] }\n";
  const Campaign c = load_campaign(folder / "c.yaml", testing::load_options());
  const auto s = scenario::parse_scenario(c.scenario_text(1), "elsewhere/case.yaml", testing::load_options());
  EXPECT_DOUBLE_EQ(s.plant.drives[0].load.value.inertia_kg_m2, 0.7);
  EXPECT_EQ(s.plant.name, "my_plant");
  const std::string before = c.digest(1);
  std::ofstream(folder / "deep/my plant.yaml") << "drives: [{ name: pump, load: { inertia_kg_m2: 0.6 } }]\n";
  EXPECT_NE(load_campaign(folder / "c.yaml", testing::load_options()).digest(1), before) << "the plant file counts";
}

TEST(CampaignFile, DigestIsOfTheCaseNotOfTheFile) {
  const std::string first = "  - grid: { speed: [5 Hz, 6 Hz] }\n";
  const Campaign a = read(first), b = read(first + "  - grid: { speed: [9 Hz] }\n"),
                 c = read("  - grid: { speed: [5 Hz, 7 Hz] }\n");
  EXPECT_EQ(a.digest(1), b.digest(1));
  EXPECT_EQ(a.digest(2), b.digest(2));
  EXPECT_EQ(a.digest(1), c.digest(1));
  EXPECT_NE(a.digest(2), c.digest(2));
}

struct Mistake {
  const char* variations;
  const char* message;
};

TEST(CampaignFile, SaysWhatIsWrongWhereAndWhatIsAllowed) {
  // The line of the first block is 17.
  const Mistake all[] = {
      {"  - gird: { speed: [5 Hz] }\n",
       "test.yaml:17:5: unknown key \"gird\" in a block of variations; allowed: set, grid, boundary, latin_hypercube, "
       "random, samples. Did you mean \"grid\"?"},
      {"  - grid: { sped: [5 Hz] }\n",
       "test.yaml:17:13: the scenario has no variable \"sped\"; allowed: pause, speed. Did you mean \"speed\"? A place "
       "in it begins with /, as /steps/3/after."},
      {"  - grid: { speed: 5 Hz }\n", "test.yaml:17:20: speed is \"5 Hz\"; allowed: a list of values, or a range"},
      {"  - grid: { speed: { from: 5 Hz, to: 9 Hz } }\n", "test.yaml:17:20: speed has neither \"count\" nor \"step\""},
      {"  - grid: { speed: { from: 5 Hz, to: 9 s, count: 3 } }\n",
       "test.yaml:17:38: to of speed is \"9 s\"; allowed: the same unit as in \"from: 5 Hz\"."},
      {"  - grid: { speed: { from: 5 Hz, to: 9 Hz, step: 5 Hz } }\n",
       "test.yaml:17:50: step of speed is \"5 Hz\"; allowed: more than 0 Hz, up to the whole range"},
      {"  - grid: { speed: { from: 0 Hz, to: 9 Hz, count: 3, spacing: logarithmic } }\n",
       "test.yaml:17:54: spacing of speed is logarithmic, for which both ends must be above 0."},
      {"  - random: { speed: [5 Hz] }\n", "test.yaml:17:5: \"samples\" is missing"},
      {"  - { grid: { speed: [5 Hz] }, samples: 5 }\n",
       "test.yaml:17:32: \"samples\" belongs to latin_hypercube and random"},
      {"  - { grid: { speed: [5 Hz] }, set: { speed: 6 Hz } }\n",
       "test.yaml:17:15: \"speed\" varies twice in this block."},
      {"  - grid: { /steps/9/after: [1 s] }\n",
       "test.yaml:17:5: case 1 (/steps/9/after = 1 s) cannot be made: /steps/9/after is no place in the scenario: "
       "there is no entry 9; allowed: 1 to 4."},
      {"  - grid: { /plant/drives/pmup/power: [on] }\n",
       "there is no entry \"pmup\"; allowed: a number from 1 to 1, or one of these names; allowed: pump. Did you mean "
       "\"pump\"?"},
      {"  - grid: { /plant/drives/1/lod/inertia_kg_m2: [1] }\n", "is no scenario: unknown key \"lod\" in drive 1"},
      {"  - grid: { speed: [5 furlongs] }\n", "test.yaml:17:5: case 1 (speed = 5 furlongs) is no scenario: "},
      {"  - grid: { speed: { from: 5 Hz, to: 9 Hz, count: 1000000 }, pause: { from: 1 s, to: 9 s, count: 1000000 } }\n",
       "test.yaml:17:5: the campaign has more than 10000000 cases."},
      {"  []\n", "variations is an empty list; allowed: a list of blocks"},
      {"  - grid: { speed: [5 Hz] }\nmeasure: { peak: { maximum: dc_lnk } }\n",
       "test.yaml:18:29: maximum in measure peak is \"dc_lnk\"; allowed: "},
      {"  - grid: { speed: [5 Hz] }\nmeasure: { peak: { drive: pump } }\n",
       "measure peak has none of minimum, maximum and last"},
  };
  for (const Mistake& m : all) {
    const std::string told = mistakes(file(m.variations));
    EXPECT_NE(told.find(m.message), std::string::npos) << m.variations << told;
  }
}

TEST(CampaignFile, MistakesOfAnInlineScenarioHaveTheirPlaceInTheFile) {
  std::string text = file("  - grid: { speed: [5 Hz] }\n");
  text.replace(text.find("run: forward"), 12, "run: foward ");
  EXPECT_NE(mistakes(text).find("test.yaml:13:"), std::string::npos) << mistakes(text);
  EXPECT_NE(mistakes("scenario: x.yaml\nvariations: []\n").find("test.yaml:1:1: the first line is a comment"),
            std::string::npos);
  EXPECT_NE(mistakes("# T.\nscenario: nowhere.yaml\nvariations: []\n")
                .find("test.yaml:2:11: scenario: nowhere.yaml cannot be read: No such file"),
            std::string::npos);
  EXPECT_NE(mistakes("# T.\nseed: 1\n").find("\"variations\" is missing"), std::string::npos);
  EXPECT_NE(mistakes("# T.\na: [\n").find("this is not YAML"), std::string::npos);
  EXPECT_EQ(mistakes("# T.\n" + vinv::test::alias_bomb()),
            "test.yaml:1:1: the file is nested too deep, or its aliases make it too large.");
}

TEST(CampaignFile, DocumentsAreWrittenAsTheyWereRead) {
  const std::string text =
      "a: {b: [1, \"two: 2\", ~], \"on\": \"5\"}\nc:\n  - d: $x\n    e: \"${x + 1}\"\n  - stop:\nf: \"\"\n";
  const auto once = read_document(YAML::Load(text));
  ASSERT_TRUE(once);
  const std::string written = write_document(*once);
  const auto twice = read_document(YAML::Load(written));
  ASSERT_TRUE(twice) << written;
  EXPECT_EQ(write_document(*twice), written);
  EXPECT_EQ(twice->find("a")->find("b")->items[1].text, "two: 2");
  EXPECT_TRUE(twice->find("a")->find("on")->quoted);
  EXPECT_EQ(twice->find("c")->items[1].find("stop")->kind, Document::Kind::kNull);
  EXPECT_EQ(twice->find("f")->kind, Document::Kind::kScalar);
}

TEST(CampaignSchema, KnowsTheKeysOfTheLoader) {
  const auto schema = nlohmann::json::parse(testing::content(VINV_SOURCE_DIR "/docs/campaign.schema.json"));
  const auto keys_of = [](const nlohmann::json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object["properties"].items()) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    return keys;
  };
  std::map<std::string, std::vector<std::string>> of_schema{{"", keys_of(schema)}}, of_loader;
  const auto& d = schema["definitions"];
  of_schema["variations[]"] = keys_of(d["block"]);
  of_schema["range"] = keys_of(d["range"]);
  of_schema["measure.*"] = keys_of(d["measure"]);
  for (const auto& [path, keys] : campaign_keys()) {
    of_loader[path].assign(keys.begin(), keys.end());
    std::sort(of_loader[path].begin(), of_loader[path].end());
  }
  EXPECT_EQ(of_schema, of_loader);
}

}  // namespace
}  // namespace vinv::campaign
