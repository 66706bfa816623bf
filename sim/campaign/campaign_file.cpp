#include "sim/campaign/campaign_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "sim/campaign/files.hpp"
#include "sim/rig/words.hpp"
#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::campaign {
namespace {

namespace fs = std::filesystem;
using Keys = std::vector<std::string_view>;

constexpr std::size_t kMaxListed = 100'000;  // values of one axis
constexpr int kDigits = 6;                   // of a value without step, in relation to the larger end
constexpr int kMaxDecimals = 12;

const char* const kRangeForm = "a list of values, or a range as {from: 0.5 s, to: 5 s, count: 10}";

struct Quantity {
  double number = 0;
  int decimals = 0;
  std::string unit;  // with the space before it
};

std::optional<Quantity> read_quantity(const YAML::Node& node, const std::string& what, rig::Problems& problems) {
  const std::string text = node.IsScalar() ? node.Scalar() : std::string{};
  const std::size_t end = std::min(text.find_first_not_of("+-.0123456789"), text.size());
  Quantity q;
  if (!rig::parse_number(text.substr(0, end), q.number)) {
    problems.add(node, what + " is " + rig::kind_of(node) + "; allowed: a number with or without unit, as 0.5 s.");
    return {};
  }
  const std::size_t point = text.find('.');
  if (point < end) q.decimals = static_cast<int>(end - point - 1);
  q.unit = text.substr(end);
  return q;
}

class Loader {
 public:
  Loader(const std::string& path, const scenario::LoadOptions& options) : options_(options) {
    campaign_.path = path;
    campaign_.name = fs::path(path).stem().string();
  }

  Campaign load(std::string_view text) {
    text_ = text;
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
    if (const auto root = parse()) document(*root);
    if (!problems_.empty()) throw CampaignFileError(campaign_.path, problems_.take_sorted());
    return std::move(campaign_);
  }

 private:
  std::optional<YAML::Node> parse() {
    campaign_.title = scenario::first_comment(text_);
    if (campaign_.title.empty())
      problems_.add(
          rig::Position{1, 1},
          "the first line is a comment that says what the campaign looks for, as \"# E.OV3 over deceleration times\".");
    return rig::read_document(text_, "a campaign", "a campaign needs \"scenario:\" and \"variations:\".", problems_);
  }

  void document(const YAML::Node& root) {
    const rig::YamlMap map(root, "the campaign", &campaign_keys().at(""), problems_);
    if (!map) return;
    constexpr long kMaxSeed = 1'000'000'000'000;
    if (const auto seed = map.integer("seed", 0, kMaxSeed)) campaign_.seed = static_cast<std::uint64_t>(*seed);
    for (const char* key : {"scenario", "variations"})
      if (std::none_of(map.entries().begin(), map.entries().end(), [&](const auto& e) { return e.key == key; }))
        problems_.add(map.at(), fmt::format("\"{}\" is missing; {}", key,
                                            key == std::string_view("scenario")
                                                ? "write the name of a scenario file there, or the scenario itself."
                                                : "a campaign needs a list of what varies (- grid: {...})."));
    const auto scenario = map.has("scenario") ? base(map, *map.find("scenario"), root) : std::nullopt;
    if (const YAML::Node* list = map.find("variations")) variations(*list, scenario ? &*scenario : nullptr);
    if (const YAML::Node* node = map.find("measure"); node != nullptr && scenario) measure(*node, *scenario);
    if (!problems_.empty()) return;
    campaign_.number_cases();
    first_cases(*map.find("variations"));
  }

  // --- the scenario ---

  std::optional<scenario::Scenario> base(const rig::YamlMap& map, const YAML::Node& node, const YAML::Node& root) {
    std::string text;
    const bool is_file = node.IsScalar();
    try {
      if (is_file) {
        campaign_.base_path = (fs::path(campaign_.path).parent_path() / node.Scalar()).lexically_normal().string();
        text = read_file(campaign_.base_path);
      } else if (node.IsMap() && root.Style() == YAML::EmitterStyle::Block) {
        campaign_.base_path = campaign_.path;
        text = inline_text(map, node);
      } else {
        problems_.add(node,
                      "scenario is " + rig::kind_of(node) +
                          "; allowed: the name of a scenario file, or a scenario (plant:, steps:) in block style.");
        return {};
      }
    } catch (const std::runtime_error& e) {
      problems_.add(node, std::string("scenario: ") + e.what());
      return {};
    }
    try {
      auto scenario = scenario::parse_scenario(text, campaign_.base_path, options_);
      auto document = read_document(YAML::Load(text));
      if (!document)
        problems_.add(node, "scenario: " + document.error());
      else
        campaign_.base = std::move(*document);
      return scenario;
    } catch (const scenario::ScenarioFileError& e) {
      for (const rig::Problem& p : e.problems()) {
        if (!is_file) {
          problems_.add(p.at.line == 0 ? rig::position_of(node) : p.at, p.message);
          continue;
        }
        std::string place = campaign_.base_path;
        if (p.at.line > 0) place += fmt::format(":{}:{}", p.at.line, p.at.column);
        problems_.add(node, "scenario " + place + ": " + p.message);
      }
    }
    return {};
  }

  // The lines of the inline scenario where they stand, so that what is told about it has the right line and column.
  std::string inline_text(const rig::YamlMap& map, const YAML::Node& node) const {
    const rig::Position begin = rig::position_of(node);
    int end = 1 << 30;
    for (const auto& entry : map.entries())
      if (entry.at.line > begin.line) end = std::min(end, entry.at.line);
    std::string out;
    std::string_view rest = text_;
    for (int line = 1; !rest.empty() && line < end; ++line) {
      const std::size_t feed = std::min(rest.find('\n'), rest.size() - 1);
      std::string now(rest.substr(0, feed + 1));
      rest.remove_prefix(feed + 1);
      if (line == 1)
        now = "# " + campaign_.title + "\n";
      else if (line < begin.line)
        now = "\n";
      else if (line == begin.line)
        now.replace(0, static_cast<std::size_t>(begin.column - 1), static_cast<std::size_t>(begin.column - 1), ' ');
      out += now;
    }
    return out;
  }

  // --- what varies ---

  void variations(const YAML::Node& list, const scenario::Scenario* scenario) {
    if (!list.IsSequence() || list.size() == 0) {
      problems_.add(list, "variations is " + (list.IsSequence() ? std::string("an empty list") : rig::kind_of(list)) +
                              "; allowed: a list of blocks (- grid: {decel: [1 s, 2 s]}).");
      return;
    }
    std::uint64_t total = 0;
    for (const auto& node : list) {
      const rig::YamlMap map(node, "a block of variations", &campaign_keys().at("variations[]"), problems_);
      if (!map) continue;
      Block b;
      names_.clear();
      if (const YAML::Node* set = map.find("set")) {
        const rig::YamlMap values(*set, "set", nullptr, problems_);
        for (const auto& e : values.entries()) {
          if (e.empty || !name(e, scenario)) continue;
          if (const auto text = rig::read_text(e.value, e.key, problems_)) b.set.emplace_back(e.key, *text);
        }
      }
      plan(map, "grid", scenario, b.grid);
      plan(map, "boundary", scenario, b.boundary);
      plan(map, "latin_hypercube", scenario, b.latin_hypercube);
      plan(map, "random", scenario, b.random);
      const bool sampled = map.has("latin_hypercube") || map.has("random");
      if (const auto n = map.integer("samples", 1, static_cast<long>(kMaxSamples)))
        b.samples = static_cast<std::uint64_t>(*n);
      if (sampled && !map.has("samples"))
        problems_.add(map.at(), "\"samples\" is missing; latin_hypercube and random need how many cases to make.");
      if (!sampled && map.has("samples"))
        problems_.add(map.key_position("samples"),
                      "\"samples\" belongs to latin_hypercube and random, which this block has not.");
      if (b.boundary.size() > kMaxBoundaryAxes) {
        problems_.add(map.key_position("boundary"), fmt::format("boundary has {} values that vary; allowed: 1 to {}.",
                                                                b.boundary.size(), kMaxBoundaryAxes));
        continue;
      }
      const auto n = b.cases(kMaxCases);
      if (!n || total + *n > kMaxCases)
        problems_.add(map.at(), fmt::format("the campaign has more than {} cases.", kMaxCases));
      total += n.value_or(0);
      campaign_.blocks.push_back(std::move(b));
    }
  }

  void plan(const rig::YamlMap& block, const char* key, const scenario::Scenario* scenario, std::vector<Axis>& out) {
    const YAML::Node* node = block.find(key);
    if (node == nullptr) return;
    const rig::YamlMap map(*node, key, nullptr, problems_);
    if (map && map.entries().empty())
      problems_.add(*node, std::string(key) + " is empty; allowed: what varies, as {decel: [1 s, 2 s]}.");
    for (const auto& e : map.entries()) {
      if (!name(e, scenario) || e.empty) continue;
      if (auto a = axis(e, key == std::string_view("grid"))) out.push_back(std::move(*a));
    }
  }

  // A variable of the scenario, or a place in it.
  bool name(const rig::YamlMap::Entry& e, const scenario::Scenario* scenario) {
    if (e.key.starts_with('/')) {
      if (e.key.size() < 2 || e.key.back() == '/' || e.key.find("//") != std::string::npos ||
          e.key.starts_with("/variables")) {
        problems_.add(e.at, "\"" + e.key +
                                "\" is no place; write keys and numbers of entries, as "
                                "/plant/drives/1/load/inertia_kg_m2, and variables by their name.");
        return false;
      }
    } else if (scenario != nullptr && scenario->variables.count(e.key) == 0) {
      Keys known;
      for (const auto& [n, v] : scenario->variables) known.push_back(n);
      problems_.add(e.at, "the scenario has no variable \"" + e.key + "\"; " +
                              (known.empty() ? "it declares none. " : rig::allowed_words(e.key, known) + " ") +
                              "A place in it begins with /, as /steps/3/after.");
      return false;
    }
    if (!names_.insert(e.key).second) {
      problems_.add(e.at, "\"" + e.key + "\" varies twice in this block.");
      return false;
    }
    return true;
  }

  std::optional<Axis> axis(const rig::YamlMap::Entry& e, bool grid) {
    Axis a;
    a.name = e.key;
    if (e.value.IsSequence()) {
      if (e.value.size() == 0 || e.value.size() > kMaxListed) {
        problems_.add(e.value,
                      fmt::format("{} is a list of {}; allowed: 1 to {} values.", e.key, e.value.size(), kMaxListed));
        return {};
      }
      for (const auto& item : e.value) {
        if (const auto text = rig::read_text(item, "a value of " + e.key, problems_)) a.values.push_back(*text);
      }
      return a;
    }
    if (!e.value.IsMap()) {
      problems_.add(e.value, e.key + " is " + rig::kind_of(e.value) + "; allowed: " + kRangeForm +
                                 ". What is the same in all cases stands in \"set\".");
      return {};
    }
    const rig::YamlMap map(e.value, e.key, &campaign_keys().at("range"), problems_);
    return range(map, grid, std::move(a));
  }

  std::optional<Axis> range(const rig::YamlMap& map, bool grid, Axis a) {
    const auto end = [&](const char* key) -> std::optional<Quantity> {
      const YAML::Node* node = map.find(key);
      if (node != nullptr) return read_quantity(*node, std::string(key) + " of " + a.name, problems_);
      problems_.add(map.at(), fmt::format("\"{}\" is missing in {}; allowed: {}.", key, a.name, kRangeForm));
      return {};
    };
    const auto from = end("from");
    const auto to = end("to");
    if (!from || !to) return {};
    a.from = from->number;
    a.to = to->number;
    a.unit = from->unit;
    if (from->unit != to->unit) {
      problems_.add(*map.find("to"), fmt::format("to of {} is \"{}\"; allowed: the same unit as in \"from: {}\".",
                                                 a.name, map.find("to")->Scalar(), map.find("from")->Scalar()));
      return {};
    }
    if (const auto word = map.word("spacing", {"linear", "logarithmic"})) a.logarithmic = *word == "logarithmic";
    if (a.logarithmic && !(a.from > 0 && a.to > 0)) {
      problems_.add(map.key_position("spacing"),
                    "spacing of " + a.name + " is logarithmic, for which both ends must be above 0.");
      return {};
    }
    if (a.from == a.to) {
      problems_.add(map.at(), a.name + " goes from " + map.find("from")->Scalar() +
                                  " to the same value; what is the same in all cases stands in \"set\".");
      return {};
    }
    if (!decimals(map, *from, a)) return {};
    if (const auto n = map.integer("count", 2, static_cast<long>(kMaxSamples)))
      a.count = static_cast<std::uint64_t>(*n);
    if (!grid && map.has("count")) {
      problems_.add(
          map.key_position("count"),
          "\"count\" belongs to a grid; latin_hypercube and random have \"samples\", and boundary needs none.");
      return {};
    }
    if (!grid) return a;
    if (map.has("count") && map.has("step")) {
      problems_.add(map.key_position("step"), a.name + " has either \"count\" or \"step\" in a grid, not both.");
      return {};
    }
    if (!map.has("count") && !map.has("step")) {
      problems_.add(map.at(), a.name + " has neither \"count\" nor \"step\"; a grid needs one of them.");
      return {};
    }
    if (a.step) a.count = static_cast<std::uint64_t>(std::llround(std::abs((a.to - a.from) / *a.step))) + 1;
    return a;
  }

  bool decimals(const rig::YamlMap& map, const Quantity& from, Axis& a) {
    const YAML::Node* node = map.find("step");
    if (node == nullptr) {
      const double scale = a.logarithmic ? std::min(a.from, a.to) : std::max(std::abs(a.from), std::abs(a.to));
      a.decimals = std::clamp(kDigits - 1 - static_cast<int>(std::floor(std::log10(scale))), 0, kMaxDecimals);
      return true;
    }
    const auto step = read_quantity(*node, "step of " + a.name, problems_);
    if (!step) return false;
    const double span = std::abs(a.to - a.from);
    if (step->unit != a.unit || step->number <= 0 || step->number > span || span / step->number >= kMaxListed ||
        a.logarithmic) {
      problems_.add(
          *node, fmt::format("step of {} is \"{}\"; allowed: more than 0{}, up to the whole range, in linear spacing.",
                             a.name, node->Scalar(), a.unit));
      return false;
    }
    // What lies behind the last step does not occur.
    const double steps = std::floor(span / step->number * (1 + 1e-12));
    a.step = a.to > a.from ? step->number : -step->number;
    a.to = a.from + steps * *a.step;
    a.decimals = std::min(std::max(from.decimals, step->decimals), kMaxDecimals);
    return true;
  }

  // --- what is measured ---

  void measure(const YAML::Node& node, const scenario::Scenario& scenario) {
    const scenario::Trial trial(scenario.plant, options_.catalogue);
    const rig::YamlMap map(node, "measure", nullptr, problems_);
    for (const auto& e : map.entries()) {
      if (e.empty) continue;
      const rig::YamlMap m(e.value, "measure " + e.key, &campaign_keys().at("measure.*"), problems_);
      if (!m) continue;
      Measure out;
      out.name = e.key;
      std::size_t drive = 0;
      if (m.has("drive")) {
        const auto word = m.word("drive", trial.drive_names());
        if (!word) continue;
        while (scenario.plant.drives[drive].name != *word) ++drive;
      } else if (scenario.plant.drives.size() > 1) {
        problems_.add(m.at(), "the plant has several drives; say which: \"drive: " + scenario.plant.drives[0].name +
                                  "\" ... Allowed: " + rig::join(trial.drive_names()) + ".");
        continue;
      }
      out.drive = scenario.plant.drives[drive].name;
      std::size_t given = 0;
      for (const auto& [key, kind] :
           {std::pair("minimum", Measure::Kind::kMinimum), std::pair("maximum", Measure::Kind::kMaximum),
            std::pair("last", Measure::Kind::kLast)}) {
        if (!m.has(key)) continue;
        ++given;
        out.kind = kind;
        const auto& names = trial.observer(drive).signal_names();
        const auto word = m.word(key, Keys(names.begin(), names.end()));
        if (!word) continue;
        out.signal = *word;
        out.unit =
            trial.observer(drive)
                .signal_units()[static_cast<std::size_t>(std::find(names.begin(), names.end(), *word) - names.begin())];
      }
      if (given != 1)
        problems_.add(m.at(), "measure " + e.key + " has " + (given == 0 ? "none" : "several") +
                                  " of minimum, maximum and last; allowed: one, as {maximum: dc_link_voltage}.");
      campaign_.measures.push_back(std::move(out));
    }
  }

  // A misspelt place or a value that no drive takes is told before thousands of cases fail of it.
  void first_cases(const YAML::Node& list) {
    std::uint64_t number = 1;
    for (std::size_t i = 0; i < campaign_.blocks.size(); ++i) {
      const std::string which = fmt::format("case {} ({}) ", number, campaign_.shown_values(number));
      try {
        scenario::parse_scenario(campaign_.scenario_text(number), campaign_.base_path, options_);
      } catch (const scenario::ScenarioFileError& e) {
        for (const rig::Problem& p : e.problems()) problems_.add(list[i], which + "is no scenario: " + p.message);
      } catch (const std::runtime_error& e) {
        problems_.add(list[i], which + "cannot be made: " + e.what());
      }
      number += campaign_.blocks[i].cases(kMaxCases).value();
    }
  }

  const scenario::LoadOptions& options_;
  std::string_view text_;
  Campaign campaign_;
  rig::Problems problems_;
  std::set<std::string> names_;  // of the block
};

}  // namespace

const std::map<std::string, std::vector<std::string_view>>& campaign_keys() {
  static const std::map<std::string, Keys> keys{
      {"", {"scenario", "seed", "variations", "measure"}},
      {"variations[]", {"set", "grid", "boundary", "latin_hypercube", "random", "samples"}},
      {"range", {"from", "to", "count", "step", "spacing"}},
      {"measure.*", {"minimum", "maximum", "last", "drive"}},
  };
  return keys;
}

Campaign parse_campaign(std::string_view text, const std::string& path, const scenario::LoadOptions& options) {
  return Loader(path, options).load(text);
}

Campaign load_campaign(const std::string& path, const scenario::LoadOptions& options) {
  std::string text;
  try {
    text = read_file(path);
  } catch (const std::runtime_error& e) {
    std::string message = e.what();
    throw CampaignFileError(path, {{{}, message.starts_with(path + " ") ? message.substr(path.size() + 1) : message}});
  }
  return parse_campaign(text, path, options);
}

}  // namespace vinv::campaign
