// Two small pieces of state that many functions of the drive share: a first-order lag and an on-delay.
#pragma once

#include <algorithm>

#include "sim/base/archive.hpp"

namespace vinv::drive {

// Implicit Euler, so that any ratio of tick and time constant is stable; a time constant of 0 passes the input through.
class FirstOrderLag {
 public:
  double step(double dt_s, double time_constant_s, double input) {
    const double sum = std::max(time_constant_s, 0.0) + dt_s;
    value_ += sum > 0 ? (input - value_) * dt_s / sum : 0;
    return value_;
  }
  void set(double value) { value_ = value; }
  double value() const { return value_; }

 private:
  double value_ = 0;
  VINV_ARCHIVE(FirstOrderLag, value_);
};

// True once the condition has held for the delay. A delay of 0 is immediate.
class OnDelay {
 public:
  bool step(double dt_s, bool condition, double delay_s) {
    // Half a nanosecond of slack: sums of ticks are not exact.
    const bool due = condition && held_s_ + 5e-10 >= delay_s;
    held_s_ = condition ? std::min(held_s_ + dt_s, 1e6) : 0;
    return due;
  }
  void clear() { held_s_ = 0; }
  double held_s() const { return held_s_; }

 private:
  double held_s_ = 0;
  VINV_ARCHIVE(OnDelay, held_s_);
};

}  // namespace vinv::drive
