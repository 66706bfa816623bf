// Speeds of drive profiles (AC/DC Drive object 0x2A, assemblies 20-71) as the drive's frequencies in 0.01 Hz.
// The ratio and the shift of SpeedScale (attribute 22) are the board's data.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "sim/base/check.hpp"

namespace vinv::cip {

// speed = frequency * numerator / denominator, to the nearest.
struct SpeedScale {
  std::int64_t numerator = 30;
  std::int64_t denominator = 100;

  // r/min of a motor with this many poles: frequency * 120 / poles.
  static constexpr SpeedScale of_poles(std::int64_t poles) { return {120, 100 * poles}; }
  // A machine's own unit: machine_speed at reference (0.01 Hz).
  static constexpr SpeedScale of_machine(std::int64_t machine_speed, std::int64_t reference) {
    return {machine_speed, reference};
  }

  constexpr std::int64_t speed_of(std::int64_t frequency) const { return ratio(frequency, numerator, denominator); }
  constexpr std::int64_t frequency_of(std::int64_t speed) const { return ratio(speed, denominator, numerator); }

  static constexpr std::int64_t ratio(std::int64_t value, std::int64_t numerator, std::int64_t denominator) {
    VINV_CHECK(denominator > 0);
    const std::int64_t product = value * numerator;
    return (product + (product < 0 ? -denominator : denominator) / 2) / denominator;
  }
};

}  // namespace vinv::cip
