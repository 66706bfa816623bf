// Values of scenario files: times and bytes.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/rig/flow_value.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::scenario {

using Keys = std::vector<std::string_view>;
bool contains(const Keys& list, std::string_view word);

using rig::flow_text;
using rig::json_of;

// A time from minimum up to 1000000 s.
std::optional<Duration> read_duration(const YAML::Node& node, const std::string& what, Duration minimum,
                                      rig::Problems& problems);
// At most 1024 bytes in hexadecimal, with or without spaces between them.
std::optional<Bytes> read_hex(const YAML::Node& node, const std::string& what, rig::Problems& problems);

}  // namespace vinv::scenario
