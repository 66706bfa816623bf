#include "sim/scenario/scenario_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/node_values.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/step_reader.hpp"
#include "sim/scenario/substitution.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;
using Keys = std::vector<std::string_view>;

constexpr Duration kDefaultLimit = std::chrono::seconds(60);

std::string stem(const std::string& path) { return fs::path(path).stem().string(); }

class Loader {
 public:
  Loader(const std::string& path, const LoadOptions& options) : options_(options) {
    scenario_.path = path;
    scenario_.name = stem(path);
    scenario_.limit = kDefaultLimit;
  }

  Scenario load(std::string_view text) {
    scenario_.title = first_comment(text);
    const auto root = rig::read_document(text, "a scenario", "a scenario needs \"plant:\" and \"steps:\".", problems_);
    if (root) {
      if (scenario_.title.empty())
        problems_.add(
            rig::Position{1, 1},
            "the first line is a comment that says what the scenario shows, as \"# Stops from 50 Hz in 5 s\".");
      document(*root);
    }
    if (!problems_.empty()) throw ScenarioFileError(scenario_.path, problems_.take_sorted());
    return std::move(scenario_);
  }

 private:
  void document(const YAML::Node& root) {
    const rig::YamlMap map(root, "the scenario", &scenario_keys().at(""), problems_);
    if (!map) return;
    variables(map.find("variables"));
    settings(map);
    const auto trial = plant(map);
    if (!trial) return;
    StepReader reader(*trial, options_, problems_, fs::path(scenario_.path).parent_path().string());
    const YAML::Node* steps = map.find("steps");
    const YAML::Node* tracks = map.find("tracks");
    if (steps == nullptr && tracks == nullptr && !map_has(map, "steps") && !map_has(map, "tracks"))
      problems_.add(map.at(), "\"steps\" is missing; a scenario needs a list of steps, or \"tracks\" with several.");
    if (steps != nullptr) scenario_.tracks.push_back(reader.track("", *steps, scenario_.variables));
    if (tracks != nullptr) {
      const rig::YamlMap list(*tracks, "tracks", nullptr, problems_);
      for (const auto& entry : list.entries()) {
        if (!rig::is_plant_word(entry.key))
          problems_.add(entry.at, "name of a track is \"" + entry.key +
                                      "\"; allowed: a letter, then letters, digits, _ and -, 64 in all.");
        else if (!entry.empty)
          scenario_.tracks.push_back(reader.track(entry.key, entry.value, scenario_.variables));
      }
    }
    scenario_.watches = reader.watches();
    allowed_trips(map.find("allow_trips"), *trial);
  }

  static bool map_has(const rig::YamlMap& map, std::string_view key) {
    return std::any_of(map.entries().begin(), map.entries().end(), [&](const auto& e) { return e.key == key; });
  }

  void variables(const YAML::Node* node) {
    std::set<std::string> used;
    if (node != nullptr) {
      const rig::YamlMap map(*node, "variables", nullptr, problems_);
      for (const auto& entry : map.entries()) {
        const bool fine = std::all_of(entry.key.begin(), entry.key.end(),
                                      [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
        if (!fine || std::isdigit(static_cast<unsigned char>(entry.key.front())) != 0) {
          problems_.add(entry.at, "name of a variable is \"" + entry.key + "\"; allowed: letters, digits and _.");
          continue;
        }
        if (entry.empty) continue;
        const auto given = options_.variables.find(entry.key);
        if (given != options_.variables.end()) {
          scenario_.variables[entry.key] = given->second;
          continue;
        }
        const auto text = rig::read_text(entry.value, "variable " + entry.key, problems_);
        if (!text) continue;
        // A variable may be made of those before it.
        const auto value = substitute(*text, scenario_.variables);
        if (value)
          scenario_.variables[entry.key] = *value;
        else
          problems_.add(entry.value, value.error());
      }
    }
    for (const auto& [name, value] : options_.variables) {
      if (scenario_.variables.count(name) > 0) continue;
      Keys known;
      for (const auto& [n, v] : scenario_.variables) known.push_back(n);
      problems_.add(rig::Position{}, "there is no variable \"" + name + "\" to set; " +
                                         (known.empty() ? "the file declares none." : rig::allowed_words(name, known)));
    }
  }

  void settings(const rig::YamlMap& map) {
    constexpr long kMaxSeed = 1'000'000'000'000;
    for (const char* key : {"seed", "limit", "tolerance"})
      if (const YAML::Node* node = map.find(key)) {
        Substitution substitution(*node, scenario_.variables, problems_);
        substitution.keep();
      }
    if (const auto seed = map.integer("seed", 0, kMaxSeed)) scenario_.seed = static_cast<std::uint64_t>(*seed);
    if (const YAML::Node* limit = map.find("limit"))
      scenario_.limit = read_duration(*limit, "limit", std::chrono::milliseconds(1), problems_).value_or(kDefaultLimit);
    if (const YAML::Node* node = map.find("tolerance")) {
      const rig::YamlMap t(*node, "tolerance", &scenario_keys().at("tolerance"), problems_);
      if (const YAML::Node* time = t ? t.find("time") : nullptr)
        scenario_.tolerance.time =
            read_duration(*time, "time in tolerance", Duration{}, problems_).value_or(Duration{});
      if (const YAML::Node* value = t ? t.find("value") : nullptr) {
        const auto fraction =
            value->IsScalar()
                ? rig::parse_quantity(value->Scalar(), rig::Dimension::kFraction)
                : Result<double, std::string>(Unexpected(rig::kind_of(*value) + ": write a share, as 2 %."));
        if (!fraction)
          problems_.add(*value, "value in tolerance: " + fraction.error());
        else if (*fraction < 0 || *fraction > 1)
          problems_.add(*value, "value in tolerance is \"" + value->Scalar() + "\"; allowed: 0 to 100 %.");
        else
          scenario_.tolerance.value = *fraction;
      }
    }
  }

  // The trial plant, on which the steps are read; empty if there is no plant.
  std::unique_ptr<Trial> plant(const rig::YamlMap& map) {
    const YAML::Node* node = map.find("plant");
    if (node == nullptr) {
      if (!map_has(map, "plant"))
        problems_.add(map.at(), "\"plant\" is missing; write the drives there, or the name of a plant file.");
      return {};
    }
    Substitution substitution(*node, scenario_.variables, problems_);
    substitution.keep();
    return plant_of(*node);
  }

  std::unique_ptr<Trial> plant_of(const YAML::Node& node) {
    const bool is_file = node.IsScalar();
    std::string file = scenario_.path;
    try {
      if (is_file) {
        file = (fs::path(scenario_.path).parent_path() / node.Scalar()).lexically_normal().string();
        scenario_.plant = rig::load_plant_file(file, options_.catalogue);
      } else {
        scenario_.plant = rig::parse_plant_node(node, scenario_.path, options_.catalogue);
      }
      return std::make_unique<Trial>(scenario_.plant, options_.catalogue);
    } catch (const rig::PlantFileError& e) {
      for (const rig::Problem& p : e.problems()) {
        if (!is_file) {
          problems_.add(p.at.line == 0 ? rig::position_of(node) : p.at, p.message);
          continue;
        }
        std::string place = file;
        if (p.at.line > 0) place += ":" + std::to_string(p.at.line) + ":" + std::to_string(p.at.column);
        problems_.add(node, "plant file " + place + ": " + p.message);
      }
      return {};
    }
  }

  void allowed_trips(const YAML::Node* node, const Trial& trial) {
    if (node == nullptr) return;
    if (!node->IsSequence()) {
      problems_.add(*node, "allow_trips is " + rig::kind_of(*node) + "; allowed: a list of alarms, as [E.OV3].");
      return;
    }
    Keys known;
    for (std::size_t i = 0; i < scenario_.plant.drives.size(); ++i)
      for (const std::string_view name : trial.observer(i).drive().inverter->injectable_faults())
        if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
    for (const auto& item : *node) {
      const std::string name = item.IsScalar() ? item.Scalar() : rig::kind_of(item);
      if (std::find(known.begin(), known.end(), name) == known.end())
        problems_.add(item, "there is no alarm \"" + name + "\"; " + rig::allowed_words(name, known));
      else
        scenario_.allow_trips.push_back(name);
    }
  }

  const LoadOptions& options_;
  Scenario scenario_;
  rig::Problems problems_;
};

}  // namespace

std::string first_comment(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::string_view line = text.substr(0, text.find('\n'));
  if (!line.starts_with('#')) return {};
  line.remove_prefix(1);
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
  return line.starts_with("yaml-language-server") ? std::string{} : std::string(line);
}

const std::vector<std::string_view>& action_words() {
  static const Keys words = [] {
    // Questions are no actions: a scenario has checks for them.
    const Keys questions{"status", "names", "parameters", "led"};
    Keys out;
    for (const rig::CommandInfo& c : rig::commands())
      if (c.for_drive && std::find(questions.begin(), questions.end(), c.name) == questions.end())
        out.push_back(c.name);
    // What only a master can be told; without `via:` it is refused as an unknown command.
    for (const std::string_view word : master_words())
      if (std::find(out.begin(), out.end(), word) == out.end()) out.push_back(word);
    return out;
  }();
  return words;
}

const std::map<std::string, std::vector<std::string_view>>& scenario_keys() {
  static const std::map<std::string, Keys> all = [] {
    std::map<std::string, Keys> keys{
        {"", {"plant", "seed", "limit", "tolerance", "variables", "allow_trips", "steps", "tracks"}},
        {"tolerance", {"time", "value"}},
        {"steps[].repeat", {"times", "each", "steps"}},
        {"steps[].follows", {"file", "begin"}},
        {"steps[].ramp", {"signal", "from", "to", "time", "tolerance", "linearity"}},
        {"steps[].trip", {"code", "within", "cause", "tolerance"}},
        {"steps[].reached", {"within", "not_before", "tolerance"}},
        {"steps[].expect_frame", {"bytes", "mask", "within", "absent_for"}},
    };
    Keys step = action_words();
    for (const std::string_view word :
         {"check",   "reached", "ramp",   "trip", "always",     "never",        "overshoot", "rising",
          "falling", "follows", "repeat", "note", "send_frame", "expect_frame", "at",        "after",
          "when",    "within",  "drive",  "via",  "refused",    "during"})
      step.push_back(word);
    keys["steps[]"] = step;
    return keys;
  }();
  return all;
}

Scenario parse_scenario(std::string_view text, const std::string& path, const LoadOptions& options) {
  return Loader(path, options).load(text);
}

Scenario load_scenario(const std::string& path, const LoadOptions& options) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw ScenarioFileError(path, {{{}, "is a folder; a scenario is a YAML text."}});
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ScenarioFileError(path, {{{}, std::string("cannot be read: ") + std::strerror(errno) + "."}});
  // One byte too many is enough for a refusal; a device may never end.
  std::string text(rig::kMaxPlantFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw ScenarioFileError(path, {{{}, "cannot be read: it is no ordinary file."}});
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_scenario(text, path, options);
}

std::string scenario_title(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::getline(in, line);
  return first_comment(line);
}

}  // namespace vinv::scenario
