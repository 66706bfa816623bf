// Stall prevention: changes the frequency so that the output current stays near its level (E500 Pr.22, 23, 66, 156),
// and for families that have it holds a deceleration while the DC link is too high.
//
// A controller of the ramp's rate. The motor answers to slip: a rate above what the shaft can follow lets slip and
// current grow. So the permitted rate is a learnt part, which settles at the acceleration that the torque at the level
// gives the load, and a part in proportion to the distance from the level. Everything is scaled by the slip that
// belongs to the level. Only a current that the frequency can cure counts: one that drives the motor while it
// accelerates, one that brakes it while it decelerates.
#pragma once

#include <limits>

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/ramp_generator.hpp"
#include "motor_model/drive/torque_current.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

// Operation level in percent of the rated current at this output frequency; 0: off.
// Compensated (E500/A500, Pr.23 and 66): above the reduction start frequency fs
//   A + B (L - A)/(L - B) (k - 100)/100 with A = fs L/f, B = fs L/400 Hz,
// L the level and k the compensation factor: k = 100 % lowers the level with 1/f, which is constant power.
double stall_level_percent(const DriveSettings& settings, double frequency_hz);

// No ramp that stall prevention watches is steeper, also where the set time is 0: the current must have time to tell.
inline constexpr double kSteepestWatched_hz_s = 500;

class StallPrevention {
 public:
  struct Measurement {
    OutputSample output;
    double voltage_factor = 1;  // what the fast current limit left of the voltage
  };
  // Every tick, running or not.
  void observe(double dt_s, const DriveSettings& settings, const Measurement& measurement);

  struct Situation {
    Motion motion = Motion::kConstant;  // what the ramp does apart from stall prevention
    double frequency_hz = 0;            // its magnitude
    double acceleration_hz_s = 0;       // what the ramps would do, magnitudes
    double deceleration_hz_s = 0;
    double dc_link_v = 0;
  };
  struct Decision {
    // How fast the magnitude may move in its direction, Hz/s; infinite: as the ramp likes. Negative, not while
    // decelerating: it must be lowered at this rate.
    double most_hz_s = std::numeric_limits<double>::infinity();
    bool active = false;     // OL
    bool link_high = false;  // likewise, because of the DC link
    bool trip = false;       // stall prevention stop
    double level_a_rms = 0;  // at this frequency, not above what the fast current limit lets through; 0: off
  };
  // While the ramp runs.
  Decision step(double dt_s, const DriveSettings& settings, const Situation& situation);
  // The output went off or the frequency is no longer the ramp's.
  void release();

  double filtered_current_a_rms() const { return current_.value(); }

 private:
  double permitted_hz_s(double dt_s, const DriveSettings& settings, const Situation& situation, double level_a_rms);

  FirstOrderLag current_;
  FirstOrderLag driving_;   // the current with the sign of the motor's torque
  double ahead_a_rms_ = 0;  // driving_ without its lag
  Motion motion_ = Motion::kConstant;
  double learnt_hz_s_ = 0;
  bool fresh_ = true;  // nothing learnt in this motion
  OnDelay pulled_down_;
  bool over_level_ = false;
  VINV_ARCHIVE(StallPrevention, current_, driving_, ahead_a_rms_, motion_, learnt_hz_s_, fresh_, pulled_down_,
               over_level_);
};

}  // namespace vinv::drive
