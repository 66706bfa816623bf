// Load torque high-speed frequency control: the current of the acceleration says how much the drive carries, and a
// light load goes faster. Typical for the family (FR-A700 Pr.270 = 2, 3; Pr.4, 5, 271 to 274; signal X19).
#pragma once

#include <cstdint>

#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class LoadSpeed {
 public:
  struct Settings {
    double high_hz = 60;    // up to high_current_a of average current
    double middle_hz = 30;  // from middle_current_a on; on a line between the two
    double high_current_a = 0;
    double middle_current_a = 0;
    double range_top_hz = 30;  // the current is averaged from half of this frequency up to it
    double filter_s = 0.012;
  };
  // A start begins with reset(). Returns the set frequency, Hz.
  double step(double dt_s, const Settings& settings, double output_hz, double current_a_rms);
  void reset() { *this = LoadSpeed{}; }

 private:
  FirstOrderLag current_a_;
  double sum_as_ = 0;
  double sum_s_ = 0;
  bool decided_ = false;
  double set_hz_ = 0;
  VINV_ARCHIVE(LoadSpeed, current_a_, sum_as_, sum_s_, decided_, set_hz_);
};

}  // namespace vinv::drive
