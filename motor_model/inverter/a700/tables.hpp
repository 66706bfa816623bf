// The FR-A700's own tables (motor_model/families/mitsubishi_a700): what all families have, and its monitors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motor_model/inverter/family_data.hpp"

namespace vinv::inverter::a700 {

// Models of 75K and up have other increments and ranges, and currents and powers in tenths (large_models.csv).
inline constexpr double kLarge_kw = 75;
const FamilyData& family_data(bool large = false);

// A value that the network and the panel may watch. FR-A7NE manual 7.2.1, 7.6, 7.13.
struct MonitorRow {
  unsigned code = 0;
  std::string name;
  std::string unit;
  int decimals = 0;  // increment = 10^-decimals
};
Result<std::vector<MonitorRow>, std::string> load_monitors(std::string_view csv);
const std::vector<MonitorRow>& monitors();

}  // namespace vinv::inverter::a700
