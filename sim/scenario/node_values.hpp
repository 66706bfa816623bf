// Values of scenario files: times, bytes, what is shown of them, and what the command set takes.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/rig/command_values.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::scenario {

using Keys = std::vector<std::string_view>;
bool contains(const Keys& list, std::string_view word);

// As a person would write it on one line.
std::string flow_text(const YAML::Node& node);
// All scalars as texts: that is how the command set reads quantities, numbers and switches.
rig::Json json_of(const YAML::Node& node);

// A time from minimum up to 1000000 s.
std::optional<Duration> read_duration(const YAML::Node& node, const std::string& what, Duration minimum,
                                      rig::Problems& problems);
// At most 1024 bytes in hexadecimal, with or without spaces between them.
std::optional<Bytes> read_hex(const YAML::Node& node, const std::string& what, rig::Problems& problems);

}  // namespace vinv::scenario
