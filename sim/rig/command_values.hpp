// What commands take, checked: each of these ends the command with a sentence that names what is allowed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/quantity.hpp"

namespace vinv::rig {

using Words = std::vector<std::string_view>;

// Leaves a command early; caught in execute() only.
struct Refuse {
  CommandError error;
};
[[noreturn]] void invalid(const std::string& message);
[[noreturn]] void refused(const std::string& message);
void demand(const inverter::Outcome& outcome);

std::string shown(const Json& value);
std::string word_of(const Json& value, const Words& allowed, std::string_view what);
bool switch_of(const Json& value, std::string_view what);
// In the dimension's own unit.
double quantity_of(const Json& value, Dimension dimension, std::string_view what);
double quantity_within(const Json& value, Dimension dimension, std::string_view what, double low, double high,
                       std::string_view allowed);
double number_of(const Json& value, std::string_view what);
// A mapping with at least one entry; keys empty: any key.
const Json& map_of(const Json& value, const Words& keys, std::string_view command, std::string_view form);

}  // namespace vinv::rig
