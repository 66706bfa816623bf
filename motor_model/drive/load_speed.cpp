#include "motor_model/drive/load_speed.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {

double LoadSpeed::step(double dt_s, const Settings& s, double output_hz, double current_a_rms) {
  current_a_.step(dt_s, s.filter_s, current_a_rms);
  if (decided_) return set_hz_;
  const double magnitude = std::abs(output_hz);
  if (magnitude >= s.range_top_hz / 2) {
    sum_as_ += current_a_.value() * dt_s;
    sum_s_ += dt_s;
  }
  if (magnitude < s.range_top_hz || sum_s_ <= 0) return std::max(s.middle_hz, s.range_top_hz);
  const double average = sum_as_ / sum_s_;
  const double span = s.middle_current_a - s.high_current_a;
  const double load =
      span > 0 ? std::clamp((average - s.high_current_a) / span, 0.0, 1.0) : (average <= s.high_current_a ? 0.0 : 1.0);
  set_hz_ = s.high_hz + (s.middle_hz - s.high_hz) * load;
  decided_ = true;
  return set_hz_;
}

}  // namespace vinv::drive
