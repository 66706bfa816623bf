// Electronic thermal overload relay of the motor (E500 Pr.9, 48, 71): one thermal state, E.THM.
#pragma once

#include "sim/base/archive.hpp"

namespace vinv::drive {

class ElectronicThermal {
 public:
  static constexpr double kTimeConstant_s = 326;
  static constexpr double kTripState = 1.21;  // 110 % of the rated current, squared
  static constexpr double kPreAlarmFraction = 0.85;

  // Current that a self-cooled motor stands continuously at this output frequency, part of its rated current.
  static double continuous_current(double frequency_hz);

  // current_ratio: of the set motor current, 0 if the protection is off. frequency_hz: magnitude.
  void step(double dt_s, double current_ratio, double frequency_hz, bool forced_cooling);
  void clear() { state_ = 0; }
  double fraction() const { return state_ / kTripState; }
  bool tripped() const { return state_ >= kTripState; }
  bool pre_alarm() const { return fraction() >= kPreAlarmFraction; }

 private:
  double state_ = 0;
  VINV_ARCHIVE(ElectronicThermal, state_);
};

}  // namespace vinv::drive
