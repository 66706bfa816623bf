// Overload of the inverter's transistors, inverse time, referred to the rated output current (E.THT).
#pragma once

#include "sim/base/archive.hpp"

namespace vinv::drive {

class InverterOverload {
 public:
  // Time to the trip from cold at this multiple of the rated current: 60 s at 1.5, 3 s at 2.0, from 10 Hz up.
  static double time_to_trip_s(double current_ratio);

  // What an overload counts for at this output frequency (magnitude): a slow current stays on one transistor for long,
  // which its average does not tell. The part above the rated current counts up to 1.4 times, from 10 Hz down.
  static double effective_ratio(double current_ratio, double frequency_hz);

  // start_ratio: above it the accumulator fills, below it empties.
  void step(double dt_s, double current_ratio, double frequency_hz, double start_ratio);
  void clear() { fraction_ = 0; }
  double fraction() const { return fraction_; }  // trip at 1
  bool tripped() const { return fraction_ >= 1; }

 private:
  double fraction_ = 0;
  VINV_ARCHIVE(InverterOverload, fraction_);
};

}  // namespace vinv::drive
