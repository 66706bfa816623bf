// Strict reading of one YAML mapping: known keys only, each once, values of the right type and range. What is wrong is
// collected with its line and column, so that one run shows all mistakes of a file.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/rig/plant_file.hpp"

namespace vinv::rig {

Position position_of(const YAML::Node& node);

class Problems {
 public:
  void add(Position at, std::string message) { items_.push_back({at, std::move(message)}); }
  void add(const YAML::Node& node, std::string message) { add(position_of(node), std::move(message)); }
  bool empty() const { return items_.empty(); }
  std::vector<Problem> take() { return std::move(items_); }
  // In the order of the file; of a part that was read several times, its mistake once.
  std::vector<Problem> take_sorted();

 private:
  std::vector<Problem> items_;
};

struct Range {
  double minimum = 0;
  double maximum = 0;
  bool above_minimum = false;  // the minimum itself is not allowed
  std::string text() const;
};

// "a mapping", "a list", "text", "nothing".
std::string kind_of(const YAML::Node& node);
// Plain scalar as a number within the range; adds a problem that names what is wrong otherwise.
std::optional<double> read_number(const YAML::Node& node, std::string_view what, const Range& range,
                                  Problems& problems);
std::optional<long> read_integer(const YAML::Node& node, std::string_view what, long minimum, long maximum,
                                 Problems& problems);
std::optional<bool> read_switch(const YAML::Node& node, std::string_view what, Problems& problems);
std::optional<std::string> read_text(const YAML::Node& node, std::string_view what, Problems& problems);

// The one document of a text of at most kMaxPlantFileBytes; adds a problem otherwise, also if it is nested too deep or its
// aliases make it too large. what: "a plant file"; needs: what an empty file is told, "a plant needs ... .".
std::optional<YAML::Node> read_document(std::string_view text, std::string_view what, std::string_view needs,
                                        Problems& problems);

// A plant inside another document (a scenario's `plant:`), with the keys of a plant file. path: of that document.
PlantFile parse_plant_node(const YAML::Node& node, const std::string& path, const Catalogue& catalogue);

class YamlMap {
 public:
  // where: how messages call this mapping ("load of conveyor_1"). keys: the allowed ones; nullptr: any, checked by the
  // caller.
  YamlMap(const YAML::Node& node, std::string where, const std::vector<std::string_view>* keys, Problems& problems);

  // False if the node is no mapping at all.
  explicit operator bool() const { return valid_; }
  // nullptr if the key is not there. A key with an empty value is a problem already, and counts as not there.
  const YAML::Node* find(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  Position key_position(std::string_view key) const;
  struct Entry {
    std::string key;
    Position at;
    YAML::Node value;
    bool empty = false;
  };
  const std::vector<Entry>& entries() const { return entries_; }

  std::optional<double> number(std::string_view key, const Range& range) const;
  std::optional<long> integer(std::string_view key, long minimum, long maximum) const;
  std::optional<bool> on_off(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  // One of the given words; adds the allowed ones and the nearest otherwise.
  std::optional<std::string> word(std::string_view key, const std::vector<std::string_view>& allowed) const;

  const std::string& where() const { return where_; }
  Position at() const { return at_; }

 private:
  std::string what(std::string_view key) const { return std::string(key) + " in " + where_; }

  bool valid_ = false;
  std::string where_;
  Position at_;
  std::vector<Entry> entries_;
  Problems& problems_;
};

}  // namespace vinv::rig
