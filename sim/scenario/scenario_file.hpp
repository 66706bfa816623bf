// Reads scenario files. docs/scenarios.md is the reference of the language, docs/scenario.schema.json its schema.
// Strict, like plant files: everything that is wrong with a file is told in one go, each with line and column, what is
// allowed, and the word that was probably meant.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/rig/catalogue.hpp"
#include "sim/rig/plant_file.hpp"
#include "sim/scenario/master.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/variables.hpp"

namespace vinv::scenario {

// Same shape as a mistake in a plant file: problems with their places, what() in lines as compilers write them.
using ScenarioFileError = rig::PlantFileError;

struct LoadOptions {
  rig::Catalogue catalogue;
  std::vector<MasterKind> masters;  // what `via:` may name
  Variables variables;              // values for variables that the file declares
};

inline constexpr std::size_t kMaxSteps = 100'000;
inline constexpr int kMaxNesting = 16;

// text is the content of the file at path; a plant file it names is read relative to it. Throws ScenarioFileError.
Scenario parse_scenario(std::string_view text, const std::string& path, const LoadOptions& options);
Scenario load_scenario(const std::string& path, const LoadOptions& options);

// The comment in the first line, which is the title; empty if there is none, or it is for an editor.
std::string first_comment(std::string_view text);
// Title of a file, without reading more than its first line; empty if there is none.
std::string scenario_title(const std::string& path);

// Keys that the loader knows, by the path of the mapping that holds them ("", "tolerance", "steps[]", "steps[].trip").
// The plant's are in rig::plant_file_keys().
const std::map<std::string, std::vector<std::string_view>>& scenario_keys();
// The words that a step may consist of: those of the control socket, then the scenario's own.
const std::vector<std::string_view>& action_words();

}  // namespace vinv::scenario
