#include "motor_model/drive/traverse.hpp"

#include <algorithm>

namespace vinv::drive {

double Traverse::step(double dt_s, const TraverseSettings& s, double set_hz) {
  const double f1 = set_hz * s.amplitude;
  if (!started_) {
    started_ = true;
    up_ = true;
    position_ = 0;
  }
  // From one turn to the other in the set time; the first way begins in the middle.
  const double time_s = std::max(up_ ? s.up_s : s.down_s, dt_s);
  position_ += (up_ ? 2 : -2) * dt_s / time_s;
  if (position_ >= 1) {
    position_ = 1;
    up_ = false;
  } else if (position_ <= -1) {
    position_ = -1;
    up_ = true;
  }
  // The whole way down lies f2 lower at its begin, the whole way up f3 higher, both fading to the other turn.
  const double dip = up_ ? f1 * s.dip_up * (1 - position_) / 2 : -f1 * s.dip_down * (1 + position_) / 2;
  return std::max(0.0, set_hz + f1 * position_ + dip);
}

}  // namespace vinv::drive
