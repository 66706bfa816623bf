#include "sim/rig/yaml_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

std::string shortest(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

bool quoted(const YAML::Node& node) { return node.Tag() == "!"; }

// Aliases of YAML can make a small text a huge tree.
constexpr std::size_t kMaxNodes = 1'000'000;
constexpr int kMaxDepth = 64;

// False if there are too many nodes, or they are nested too deep.
bool countable(const YAML::Node& node, std::size_t& left, int depth) {
  if (left == 0 || depth > kMaxDepth) return false;
  --left;
  if (node.IsMap()) {
    for (const auto& pair : node)
      if (!countable(pair.first, left, depth + 1) || !countable(pair.second, left, depth + 1)) return false;
  } else if (node.IsSequence()) {
    for (const auto& item : node)
      if (!countable(item, left, depth + 1)) return false;
  }
  return true;
}

}  // namespace

Position position_of(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? Position{} : Position{mark.line + 1, mark.column + 1};
}

std::vector<Problem> Problems::take_sorted() {
  auto list = take();
  const auto place = [](const Problem& p) { return std::pair(p.at.line, p.at.column); };
  std::stable_sort(list.begin(), list.end(),
                   [&](const Problem& a, const Problem& b) { return place(a) < place(b); });
  const auto same = [&](const Problem& a, const Problem& b) { return place(a) == place(b) && a.message == b.message; };
  list.erase(std::unique(list.begin(), list.end(), same), list.end());
  return list;
}

std::optional<YAML::Node> read_document(std::string_view text, std::string_view what, std::string_view needs,
                                        Problems& problems) {
  if (text.size() > kMaxPlantFileBytes) {
    problems.add(Position{}, "the file is larger than " + std::to_string(kMaxPlantFileBytes) + " bytes.");
    return {};
  }
  try {
    auto documents = YAML::LoadAll(std::string(text));
    if (documents.empty() || documents[0].IsNull()) {
      problems.add(Position{1, 1}, "the file is empty; " + std::string(needs));
      return {};
    }
    if (documents.size() > 1) {
      problems.add(documents[1], "a second document (---) begins here; " + std::string(what) + " is one document.");
      return {};
    }
    std::size_t left = kMaxNodes;
    if (!countable(documents[0], left, 0)) {
      problems.add(Position{1, 1}, "the file is nested too deep, or its aliases make it too large.");
      return {};
    }
    return documents[0];
  } catch (const YAML::Exception& e) {
    const Position at = e.mark.is_null() ? Position{1, 1} : Position{e.mark.line + 1, e.mark.column + 1};
    problems.add(at, "this is not YAML: " + e.msg + ".");
    return {};
  }
}

std::string Range::text() const {
  return (above_minimum ? "more than " : "") + shortest(minimum) + (above_minimum ? ", up to " : " to ") +
         shortest(maximum);
}

std::string kind_of(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Map: return "a mapping (key: value)";
    case YAML::NodeType::Sequence: return "a list";
    case YAML::NodeType::Scalar: return quoted(node) ? "quoted text" : "\"" + node.Scalar() + "\"";
    default: return "nothing";
  }
}

std::optional<double> read_number(const YAML::Node& node, std::string_view what, const Range& range,
                                  Problems& problems) {
  double value = 0;
  if (!node.IsScalar() || quoted(node) || !parse_number(node.Scalar(), value)) {
    problems.add(node, std::string(what) + " is " + kind_of(node) + "; allowed: a plain number, " + range.text() +
                           ", without quotes and without a unit (the unit is part of the key).");
    return {};
  }
  if (value < range.minimum || value > range.maximum || (range.above_minimum && value == range.minimum)) {
    problems.add(node, std::string(what) + " is " + node.Scalar() + "; allowed: " + range.text() + ".");
    return {};
  }
  return value;
}

std::optional<long> read_integer(const YAML::Node& node, std::string_view what, long minimum, long maximum,
                                 Problems& problems) {
  const Range range{static_cast<double>(minimum), static_cast<double>(maximum)};
  double value = 0;
  if (!node.IsScalar() || quoted(node) || !parse_number(node.Scalar(), value) || value != std::floor(value) ||
      value < range.minimum || value > range.maximum) {
    problems.add(node, std::string(what) + " is " + kind_of(node) + "; allowed: a whole number, " + range.text() + ".");
    return {};
  }
  return static_cast<long>(value);
}

std::optional<bool> read_switch(const YAML::Node& node, std::string_view what, Problems& problems) {
  bool on = false;
  if (!node.IsScalar() || quoted(node) || !parse_switch(node.Scalar(), on)) {
    problems.add(node, std::string(what) + " is " + kind_of(node) + "; allowed: on, off.");
    return {};
  }
  return on;
}

std::optional<std::string> read_text(const YAML::Node& node, std::string_view what, Problems& problems) {
  if (!node.IsScalar() || node.Scalar().empty()) {
    problems.add(node, std::string(what) + " is " + (node.IsScalar() ? "empty" : kind_of(node)) + "; allowed: a word.");
    return {};
  }
  return node.Scalar();
}

YamlMap::YamlMap(const YAML::Node& node, std::string where, const std::vector<std::string_view>* keys,
                 Problems& problems)
    : where_(std::move(where)), at_(position_of(node)), problems_(problems) {
  if (!node.IsMap()) {
    problems_.add(node, where_ + " is " + kind_of(node) + "; allowed: a mapping" +
                            (keys == nullptr ? "." : " with the keys " + join(*keys) + "."));
    return;
  }
  valid_ = true;
  for (const auto& pair : node) {
    if (!pair.first.IsScalar()) {
      problems_.add(pair.first, "a key in " + where_ + " is " + kind_of(pair.first) + "; allowed: a word.");
      continue;
    }
    const std::string& key = pair.first.Scalar();
    const auto known = [&](std::string_view k) { return k == key; };
    if (keys != nullptr && std::none_of(keys->begin(), keys->end(), known)) {
      problems_.add(pair.first, "unknown key \"" + key + "\" in " + where_ + "; " + allowed_words(key, *keys));
      continue;
    }
    const auto first = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
    if (first != entries_.end()) {
      problems_.add(pair.first, "\"" + key + "\" stands twice in " + where_ + "; first in line " +
                                    std::to_string(first->at.line) + ".");
      continue;
    }
    entries_.push_back({key, position_of(pair.first), pair.second, pair.second.IsNull()});
    if (pair.second.IsNull())
      problems_.add(pair.first, "\"" + key + "\" in " + where_ + " has no value; write one, or leave the key out.");
  }
}

const YAML::Node* YamlMap::find(std::string_view key) const {
  for (const Entry& e : entries_)
    if (e.key == key && !e.empty) return &e.value;
  return nullptr;
}

Position YamlMap::key_position(std::string_view key) const {
  for (const Entry& e : entries_)
    if (e.key == key) return e.at;
  return at_;
}

std::optional<double> YamlMap::number(std::string_view key, const Range& range) const {
  const YAML::Node* node = find(key);
  if (node == nullptr) return {};
  return read_number(*node, what(key), range, problems_);
}

std::optional<long> YamlMap::integer(std::string_view key, long minimum, long maximum) const {
  const YAML::Node* node = find(key);
  if (node == nullptr) return {};
  return read_integer(*node, what(key), minimum, maximum, problems_);
}

std::optional<bool> YamlMap::on_off(std::string_view key) const {
  const YAML::Node* node = find(key);
  if (node == nullptr) return {};
  return read_switch(*node, what(key), problems_);
}

std::optional<std::string> YamlMap::text(std::string_view key) const {
  const YAML::Node* node = find(key);
  if (node == nullptr) return {};
  return read_text(*node, what(key), problems_);
}

std::optional<std::string> YamlMap::word(std::string_view key, const std::vector<std::string_view>& allowed) const {
  const YAML::Node* node = find(key);
  if (node == nullptr) return {};
  const auto value = read_text(*node, what(key), problems_);
  if (!value) return {};
  if (std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return value;
  problems_.add(*node, what(key) + " is \"" + *value + "\"; " + allowed_words(*value, allowed));
  return {};
}

}  // namespace vinv::rig
