// Acceleration and deceleration: moves the signed frequency towards its target, through zero when the sign changes.
// Times may change at any tick; they count from 0 to the reference frequency (S-curve A: to its base frequency).
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

enum class Motion : std::uint8_t { kConstant, kAccelerating, kDecelerating };
VINV_ENUM_RANGE(Motion, kConstant, kDecelerating);

struct RampTimes {
  double acceleration_s = 5;  // 0: immediate
  double deceleration_s = 5;
  double reference_hz = 50;
  double s_curve_base_hz = 50;
  RampPattern pattern = RampPattern::kLinear;
  double s_time_acceleration_s = 0;  // S-curve C
  double s_time_deceleration_s = 0;
  double hold_up_hz = 0;  // backlash
  double hold_up_s = 0;
  double hold_down_hz = 0;
  double hold_down_s = 0;
  double s_end_acceleration_s = 0;  // S-curve D; its beginning as of C
  double s_end_deceleration_s = 0;
};

// The constant rates of the straight ramps, Hz/s; infinite for 0 s.
double acceleration_rate_hz_s(const RampTimes& times);
double deceleration_rate_hz_s(const RampTimes& times);

class RampGenerator {
 public:
  // One tick towards the target. A tick never crosses zero: a reversal takes the tick that arrives at zero extra.
  void step(double dt_s, double target_hz, const RampTimes& times);
  // The same, but at most this far per second: the way along a curve then takes longer, its shape stays.
  void step_at_most(double dt_s, double target_hz, const RampTimes& times, double most_hz_s);
  // Lowers the magnitude, not below floor_hz and never upwards.
  void lower(double by_hz, double floor_hz);
  void set(double frequency_hz);

  double frequency_hz() const { return frequency_hz_; }
  // What a step towards this target would do.
  Motion motion_towards(double target_hz) const;

 private:
  void step_linear(double dt_s, double target_hz, double rate_hz_s);
  void step_backlash(double dt_s, double target_hz, Motion motion, double rate_hz_s, const RampTimes& times);
  void step_s_curve_a(double dt_s, double target_hz, Motion motion, const RampTimes& times);
  void step_planned(double dt_s, double target_hz, double rate_hz_s, double s_time_s, double s_end_s,
                    RampPattern pattern);

  double frequency_hz_ = 0;
  // S-curve B, C or D under way: to plan_target_hz_, which is plan_change_hz_ away from where the curve began.
  double plan_target_hz_ = 0;
  double plan_change_hz_ = 0;
  double plan_first_change_hz_ = 0;  // before the target moved
  double plan_progress_ = 0;
  bool planned_ = false;
  double hold_left_s_ = 0;  // backlash: standing at its frequency
  VINV_ARCHIVE(RampGenerator, frequency_hz_, plan_target_hz_, plan_change_hz_, plan_first_change_hz_, plan_progress_,
               planned_, hold_left_s_);
};

}  // namespace vinv::drive
