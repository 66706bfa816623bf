// Regeneration avoidance: while the motor feeds the DC link too high the frequency rises, and a deceleration waits, so
// that it does not trip. Typical for the family (FR-A700 Pr.882 to Pr.886, Pr.665).
#pragma once

#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class RegenerationAvoidance {
 public:
  struct Settings {
    bool on = false;            // in this state of the motion
    double level_v = 760;       // DC link
    int sensitivity = 0;        // 1 to 5: a fast rise counts too while decelerating; 0: the level only
    double most_hz = 6;         // the frequency rises by this at most
    double voltage_gain = 1;    // answer to the link's voltage
    double frequency_gain = 1;  // ... in frequency
  };
  struct Decision {
    double raise_hz = 0;
    bool hold = false;  // a deceleration waits
    bool active = false;
  };
  Decision step(double dt_s, const Settings& settings, bool decelerating, double dc_link_v);

 private:
  double raise_hz_ = 0;
  double last_dc_link_v_ = 0;
  FirstOrderLag slope_v_s_;
  VINV_ARCHIVE(RegenerationAvoidance, raise_hz_, last_dc_link_v_, slope_v_s_);
};

}  // namespace vinv::drive
