// Physical values with their unit, as people and scenarios write them: "12 Nm", "40 Hz", "200 ms", "40 %".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"

namespace vinv::rig {

enum class Dimension {
  kFrequency,
  kTorque,
  kInertia,
  kVoltage,
  kCurrent,
  kTime,
  kFraction,
  kTemperature,
  kSpeed,
  kPower,
};

// Value in the dimension's own unit: Hz, Nm, kg m2, V, mA, s, a fraction of 1, degrees Celsius, rpm, W.
// The error is a sentence with the units that are allowed.
Result<double, std::string> parse_quantity(std::string_view text, Dimension dimension);

// "Hz", "Nm" ... as a person writes them.
std::vector<std::string_view> units_of(Dimension dimension);

}  // namespace vinv::rig
