// The schema and the loader know the same keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim/scenario/scenario_file.hpp"

namespace vinv::scenario {
namespace {

TEST(ScenarioSchema, KnowsTheKeysOfTheLoader) {
  std::ifstream in(VINV_SOURCE_DIR "/docs/scenario.schema.json");
  ASSERT_TRUE(in.good());
  const auto schema = nlohmann::json::parse(in);
  nlohmann::json step;
  for (const auto& form : schema["definitions"]["step"]["anyOf"])
    if (form.contains("properties")) step = form["properties"];
  std::map<std::string, std::vector<std::string>> of_schema;
  const auto keys_of = [](const nlohmann::json& properties) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : properties.items()) keys.push_back(key);
    return keys;
  };
  of_schema[""] = keys_of(schema["properties"]);
  of_schema["tolerance"] = keys_of(schema["properties"]["tolerance"]["properties"]);
  of_schema["steps[]"] = keys_of(step);
  for (const char* word : {"repeat", "ramp", "trip", "reached", "follows", "expect_frame"})
    of_schema[std::string("steps[].") + word] = keys_of(step[word]["properties"]);
  std::map<std::string, std::vector<std::string>> of_loader;
  for (const auto& [path, keys] : scenario_keys()) of_loader[path].assign(keys.begin(), keys.end());
  for (auto* side : {&of_schema, &of_loader})
    for (auto& [path, keys] : *side) std::sort(keys.begin(), keys.end());
  EXPECT_EQ(of_schema, of_loader);
}

TEST(ScenarioSchema, EveryWordSaysWhatItIs) {
  std::ifstream in(VINV_SOURCE_DIR "/docs/scenario.schema.json");
  const auto schema = nlohmann::json::parse(in);
  for (const auto& form : schema["definitions"]["step"]["anyOf"]) {
    if (!form.contains("properties")) continue;
    for (const auto& [key, value] : form["properties"].items()) EXPECT_TRUE(value.contains("description")) << key;
  }
}

}  // namespace
}  // namespace vinv::scenario
