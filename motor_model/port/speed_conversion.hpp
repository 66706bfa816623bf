// Frequency to speed and back as the A700's option boards and panel do it. FR-A7NE manual 4.7: Pr.37, Pr.144, Pr.505.
#pragma once

#include <cstdint>

namespace vinv::port {

struct SpeedConversion {
  std::uint32_t pr37 = 0;    // machine speed at Pr.505; 0: none
  std::uint32_t pr144 = 4;   // poles, 100 more: speeds rather than machine speed
  double reference_hz = 60;  // Pr.505, always in Hz

  enum class Unit : std::uint8_t { kHertz, kRpm, kMachineSpeed };

  std::uint32_t poles() const {
    const std::uint32_t p = pr144 > 100 ? pr144 - 100 : pr144;
    return p == 0 ? 4 : p;
  }
  double rpm(double hz) const { return hz * 120 / poles(); }
  double hz_of_rpm(double rpm_value) const { return rpm_value * poles() / 120; }
  double machine_speed(double hz) const { return pr37 * hz / reference_hz; }
  double hz_of_machine_speed(double speed) const { return pr37 == 0 ? 0 : speed * reference_hz / pr37; }

  // Unit of the running speed monitor.
  Unit running_unit() const { return pr37 != 0 && pr144 <= 10 ? Unit::kMachineSpeed : Unit::kRpm; }
  // Unit of the frequency monitors and settings. With a network option fitted it is always Hz.
  Unit frequency_unit(bool option_fitted) const {
    if (option_fitted) return Unit::kHertz;
    if (pr37 == 0) return pr144 > 100 ? Unit::kRpm : Unit::kHertz;
    return pr144 >= 2 && pr144 <= 10 ? Unit::kMachineSpeed : Unit::kHertz;
  }
  double in_unit(double hz, Unit unit) const {
    if (unit == Unit::kRpm) return rpm(hz);
    return unit == Unit::kMachineSpeed ? machine_speed(hz) : hz;
  }
};

}  // namespace vinv::port
