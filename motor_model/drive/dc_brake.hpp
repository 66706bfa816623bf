// DC injection brake at the end of a stop ramp (E500 Pr.10-12): frequency 0 at a fixed angle for a set time.
#pragma once

#include <algorithm>

#include "motor_model/drive/drive_types.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class DcBrake {
 public:
  static bool fitted(const DriveSettings& s) { return s.dc_brake_s > 0 && s.dc_brake_voltage_percent > 0; }
  // Magnitude at which a stop ramp ends: in the brake, or without it at the start frequency.
  static double begins_at_hz(const DriveSettings& s) {
    return fitted(s) ? std::max(s.dc_brake_frequency_hz, s.start_frequency_hz) : s.start_frequency_hz;
  }
  static double voltage_v_rms(const DriveSettings& s) {
    return s.base_voltage_v_rms * s.dc_brake_voltage_percent / 100;
  }

  void begin() { elapsed_s_ = 0; }
  // True while it still brakes in this tick.
  bool step(double dt_s, const DriveSettings& s) {
    const bool on = fitted(s) && elapsed_s_ + 5e-10 < s.dc_brake_s;
    elapsed_s_ += dt_s;
    return on;
  }

 private:
  double elapsed_s_ = 0;
  VINV_ARCHIVE(DcBrake, elapsed_s_);
};

}  // namespace vinv::drive
