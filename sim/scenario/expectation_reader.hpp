// Reads what a scenario expects: "40 Hz +- 0.5 Hz", "above 30 Hz", "at_reference", {running: on, alarm: none}.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::scenario {

class ExpectationReader {
 public:
  ExpectationReader(Trial& trial, std::size_t drive, rig::Problems& problems)
      : trial_(trial), drive_(drive), problems_(problems) {}

  const std::string& drive_name() const { return trial_.observer(drive_).drive().spec.name; }
  // A name that can be looked at; adds the known ones otherwise.
  std::optional<Observable> observable(std::string_view name, rig::Position at) const;
  std::optional<Observable> signal(std::string_view name, rig::Position at) const;
  // A number in the signal's unit.
  std::optional<double> value(const YAML::Node& node, const Observable& what) const;
  // A distance in the signal's unit; "2 %" is taken of `of` (a signal in % has no such short form).
  std::optional<double> distance(const YAML::Node& node, const Observable& what, double of) const;
  std::optional<double> distance(std::string_view text, rig::Position at, const Observable& what, double of) const;
  // tolerance: for numbers without one of their own; nullptr: none.
  std::optional<Expectation> expectation(std::string_view name, rig::Position at, const YAML::Node& node,
                                         const YAML::Node* tolerance) const;
  // A mapping of observables, `terminals` and `parameters`, but for the keys that belong to the check itself.
  Condition mapping(const YAML::Node& node, const std::string& where,
                    const std::vector<std::string_view>& own_keys) const;
  // A mapping, or text: a state word, "not running", "output_frequency > 30 Hz".
  Condition condition(const YAML::Node& node, const std::string& where) const;

 private:
  std::vector<std::string_view> names() const;
  bool number(Expectation& e, const YAML::Node& node, std::string text, const YAML::Node* tolerance) const;

  Trial& trial_;
  std::size_t drive_;
  rig::Problems& problems_;
};

}  // namespace vinv::scenario
