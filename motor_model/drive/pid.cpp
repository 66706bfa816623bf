#include "motor_model/drive/pid.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kDerivativeFilter = 0.1;  // of the derivative time

}  // namespace

void Pid::track(double output_percent) {
  started_ = false;
  tracking_ = true;
  output_ = output_percent;
}

double Pid::step(double dt_s, const PidSettings& s, double set_point_percent, double measured_percent) {
  const double sign = s.action == PidAction::kReverse ? 1 : -1;
  const double high = std::max(s.output_min_percent, s.output_max_percent);
  const double low = s.output_min_percent;
  // Without a proportional part the integral and derivative act with a gain of one.
  const double gain = s.proportional_band_percent > 0 ? 100 / s.proportional_band_percent : 1;
  deviation_ = sign * (set_point_percent - measured_percent);
  const double proportional = s.proportional_band_percent > 0 ? gain * deviation_ : 0;

  // The derivative acts on the measured value, so that a new set point does not kick the output.
  if (!started_) last_measured_ = measured_percent;
  const double filter_s = kDerivativeFilter * s.derivative_s + dt_s;
  if (s.derivative_s > 0 && dt_s > 0) {
    const double rate = (measured_percent - last_measured_) / dt_s;
    derivative_ += (rate - derivative_) * dt_s / filter_s;
  } else {
    derivative_ = 0;
  }
  last_measured_ = measured_percent;
  const double derivative = -sign * gain * s.derivative_s * derivative_;

  const bool retuned =
      started_ && (gain != last_gain_ || s.derivative_s != last_derivative_s_ || s.action != last_action_);
  if (s.integral_s <= 0) {
    integral_ = 0;
  } else if (tracking_ || retuned) {
    integral_ = output_ - proportional - derivative;
  } else {
    const double growth = gain * deviation_ * dt_s / s.integral_s;
    const double sum = proportional + integral_ + derivative;
    // Anti-windup: at a limit the integral moves only back from it.
    if (!(growth > 0 && sum >= high) && !(growth < 0 && sum <= low)) {
      integral_ += growth;
    }
  }
  started_ = true;
  tracking_ = false;
  last_gain_ = gain;
  last_derivative_s_ = s.derivative_s;
  last_action_ = s.action;

  output_ = std::clamp(proportional + integral_ + derivative, low, high);
  fup_ = measured_percent > s.upper_limit_percent;
  fdn_ = measured_percent < s.lower_limit_percent;
  return output_;
}

}  // namespace vinv::drive
