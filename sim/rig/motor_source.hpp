// What the motor of a drive hangs on, in the words of the plant file (`motor_source:`) and of the command `motor`.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "motor_model/plant/power_plant.hpp"

namespace vinv::rig {

// In the order of plant::MotorSource.
inline const std::vector<std::string_view> kMotorSources{"inverter", "mains", "open", "table"};

inline std::optional<plant::MotorSource> motor_source_of(std::string_view word) {
  for (std::size_t i = 0; i < kMotorSources.size(); ++i)
    if (kMotorSources[i] == word) return static_cast<plant::MotorSource>(i);
  return {};
}

}  // namespace vinv::rig
