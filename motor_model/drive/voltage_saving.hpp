// Energy saving mode: at constant speed the output voltage is lowered as long as that lowers the output power.
// Typical for the family (FR-A700 Pr.60 = 4); the search is chosen.
#pragma once

#include "sim/base/archive.hpp"

namespace vinv::drive {

class VoltageSaving {
 public:
  // on: constant speed. Returns the factor of the V/f law's voltage, 1 in every other state.
  double step(double dt_s, bool on, double output_power_w);

 private:
  void look(double power_w);

  double factor_ = 1;
  double direction_ = -1;
  double sum_ws_ = 0;
  double since_s_ = 0;
  double last_power_w_ = 0;
  VINV_ARCHIVE(VoltageSaving, factor_, direction_, sum_ws_, since_s_, last_power_w_);
};

}  // namespace vinv::drive
