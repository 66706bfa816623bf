// The hardware current limit just below the over-current level. The real one leaves out pulses; with an averaged stage
// that is less voltage.
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class FastCurrentLimit {
 public:
  // Factor 0 ... 1 for the output voltage of the coming tick. A regenerating motor is left alone: less voltage would
  // raise its current.
  double step(double dt_s, const DriveSettings& settings, double current_peak_a, double active_current_a_rms);
  void clear();
  // Magnitude of the current vector at which it acts; 0: off.
  static double level_a_peak(const DriveSettings& settings);
  double factor() const { return factor_; }

 private:
  double factor_ = 1;
  double last_peak_a_ = 0;
  VINV_ARCHIVE(FastCurrentLimit, factor_, last_peak_a_);
};

}  // namespace vinv::drive
