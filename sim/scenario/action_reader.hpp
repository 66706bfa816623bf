// Reads a step that does something, and tries its words on the plant, so that a mistake has line and column.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::scenario {

// Adds what the drive's command set would object to, for each entry of the value.
void try_by_hand(Trial& trial, std::size_t drive, const Action& action, rig::Position word, const YAML::Node& value,
                 rig::Problems& problems);

}  // namespace vinv::scenario
