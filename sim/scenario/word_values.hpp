// Values of a master's words, and what is said of a wrong one.
#pragma once

#include <string>
#include <string_view>

#include "sim/base/result.hpp"
#include "sim/rig/commands.hpp"

namespace vinv::scenario {

inline std::string text_of(const rig::Json& value) {
  return value.is_string() ? value.get<std::string>() : std::string();
}
inline std::string shown(const rig::Json& value) { return value.is_null() ? "nothing" : value.dump(); }

inline Unexpected<std::string> wrong(std::string_view what, const rig::Json& value, std::string_view allowed) {
  return Unexpected(std::string(what) + " is " + shown(value) + "; allowed: " + std::string(allowed));
}

}  // namespace vinv::scenario
