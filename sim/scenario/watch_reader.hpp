// Reads what a span is watched for: always, never, overshoot, rising, falling, follows.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/expectation_reader.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

class WatchReader {
 public:
  // folder: tables that `follows` names are relative to it.
  WatchReader(const ExpectationReader& reader, rig::Problems& problems, const std::string& folder)
      : reader_(reader), problems_(problems), folder_(folder) {}

  // The watch without its number; nothing if there was a problem.
  std::optional<Watch> read(const std::string& word, const YAML::Node& value) const;

 private:
  bool follows(const YAML::Node& value, Watch& w) const;

  const ExpectationReader& reader_;
  rig::Problems& problems_;
  const std::string& folder_;
};

}  // namespace vinv::scenario
