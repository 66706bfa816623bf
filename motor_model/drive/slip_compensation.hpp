// Slip compensation (E500 Pr.245-247): raises the output frequency by the slip that the torque current stands for.
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class SlipCompensation {
 public:
  // Frequency to add to the magnitude of the ramp frequency, Hz; negative while regenerating. ramp_hz >= 0.
  double step(double dt_s, const DriveSettings& settings, double ramp_hz, double torque_current_a_rms);
  void clear() { lag_.set(0); }

 private:
  FirstOrderLag lag_;
  VINV_ARCHIVE(SlipCompensation, lag_);
};

// Droop (A700 Pr.286-288): lowers the output frequency in proportion to the torque current, so that several motors on
// one load share it.
class Droop {
 public:
  // Frequency to subtract from the magnitude of the ramp frequency, Hz; negative while regenerating.
  double step(double dt_s, const DriveSettings& settings, bool ramping, double torque_current_a_rms);
  void clear() { lag_.set(0); }

 private:
  FirstOrderLag lag_;
  VINV_ARCHIVE(Droop, lag_);
};

}  // namespace vinv::drive
