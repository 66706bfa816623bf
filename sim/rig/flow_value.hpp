// Values of commands as YAML writes them: {torque: 12 Nm, over: 2 s}.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "sim/rig/command_values.hpp"

namespace vinv::rig {

// As a person would write it on one line.
std::string flow_text(const YAML::Node& node);
// All scalars as texts: that is how the command set reads quantities, numbers and switches.
Json json_of(const YAML::Node& node);
// A mapping or list on one line; at most 4096 characters, without anchors. Ends the command otherwise.
Json parse_flow(const std::string& text);

}  // namespace vinv::rig
