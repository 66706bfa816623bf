// Deceleration at a power failure: the motor's energy feeds the drive while it brings the motor to a stop, instead of
// letting it coast. Typical for the family (FR-A700 Pr.261 to Pr.266, Pr.294); the ramp itself is the drive's.
#pragma once

#include <cstdint>

#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class PowerFailureStop {
 public:
  struct Settings {
    bool on = false;
    bool resumes = false;               // goes on as before when the supply is back; else it stops in any case
    bool avoids_under_voltage = false;  // decelerates faster while the link is low
    double subtracted_hz = 0;           // taken off at once ...
    double subtracted_from_hz = 0;      // ... at and above this output frequency
    double begins_below_v = 0;          // DC link, which the avoidance then holds
    double held_above_v = 0;            // DC link above which the deceleration waits
    double gain = 1;                    // of the under-voltage avoidance
  };
  struct Input {
    bool supply_good = true;  // as seen at the input
    bool phase_lost = false;  // begins at once, whatever the link
    bool running = false;     // the output is on
    bool start_on = false;    // a direction is commanded
    double output_hz = 0;     // magnitude
    double dc_link_v = 0;
  };
  struct Decision {
    double lower_by_hz = 0;  // takes this off the frequency in this tick
    bool hold = false;       // the deceleration waits
    double raise_by_hz = 0;  // adds this to the output frequency, for this tick; negative: more braking
  };
  Decision step(double dt_s, const Settings& settings, const Input& input);
  // The drive has to decelerate, or to stay stopped, whatever is commanded.
  bool active() const { return active_; }

 private:
  bool active_ = false;
  OnDelay supply_back_;
  double to_subtract_hz_ = 0;
  double last_dc_link_v_ = 0;
  FirstOrderLag slope_v_s_;
  VINV_ARCHIVE(PowerFailureStop, active_, supply_back_, to_subtract_hz_, last_dc_link_v_, slope_v_s_);
};

}  // namespace vinv::drive
