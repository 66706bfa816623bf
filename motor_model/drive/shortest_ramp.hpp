// Shortest acceleration and deceleration (E500 Pr.60-63): instead of set times, a rate that keeps the current near a
// reference, and in deceleration the DC link below its trip level.
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/ramp_generator.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class ShortestRamp {
 public:
  // The ramp times for this tick: the given ones, with a mode's own linear rate in place of its time.
  // stall_level_a_rms is the reference where none is set (0: rated current * 1.5).
  RampTimes step(double dt_s, const DriveSettings& settings, const RampTimes& times, Motion motion,
                 double current_a_rms, double dc_link_v, double stall_level_a_rms);
  void release() { *this = ShortestRamp{}; }

 private:
  // Slow enough for a large inertia at once, quick enough that a small one needs few hundred milliseconds.
  static constexpr double kFirstRate_hz_s = 10;
  double rate_hz_s_ = kFirstRate_hz_s;
  double last_dc_link_v_ = 0;
  Motion motion_ = Motion::kConstant;
  FirstOrderLag link_rise_v_s_;
  VINV_ARCHIVE(ShortestRamp, rate_hz_s_, last_dc_link_v_, link_rise_v_s_, motion_);
};

}  // namespace vinv::drive
