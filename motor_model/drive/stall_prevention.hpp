// Stall prevention: changes the frequency so that the output current stays near its level (E500 Pr.22, 23, 66, 156),
// and for families that have it holds a deceleration while the DC link is too high.
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/ramp_generator.hpp"

namespace vinv::drive {

// Operation level in percent of the rated current at this output frequency; 0: off.
// Compensated (E500/A500, Pr.23 and 66): above the reduction start frequency fs
//   A + B (L - A)/(L - B) (k - 100)/100 with A = fs L/f, B = fs L/400 Hz,
// L the level and k the compensation factor: k = 100 % lowers the level with 1/f, which is constant power.
double stall_level_percent(const DriveSettings& settings, double frequency_hz);

// What the ramp may do in this tick.
enum class RampAction : std::uint8_t { kFollow, kHold, kLower };

class StallPrevention {
 public:
  struct Decision {
    RampAction action = RampAction::kFollow;
    bool active = false;     // OL
    bool trip = false;       // stall prevention stop
    double level_a_rms = 0;  // at this frequency; 0: off
  };

  // Every tick, running or not.
  void observe(double dt_s, double current_a_rms);
  struct Situation {
    Motion motion = Motion::kConstant;  // what the ramp does apart from stall prevention
    double frequency_hz = 0;            // its magnitude
    bool regenerating = false;
    double dc_link_v = 0;
  };
  // While the ramp runs.
  Decision step(double dt_s, const DriveSettings& settings, const Situation& situation);
  // The output went off or the frequency is no longer the ramp's.
  void release();

  double filtered_current_a_rms() const { return current_.value(); }

 private:
  FirstOrderLag current_;
  OnDelay pulled_down_;
  bool over_level_ = false;
};

}  // namespace vinv::drive
