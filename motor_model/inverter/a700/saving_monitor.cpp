#include "motor_model/inverter/a700/saving_monitor.hpp"

#include <algorithm>

namespace vinv::inverter::a700 {

// Curves with the shape of the family's figures; the numbers are chosen.
double commercial_power_share(Throttling throttling, double speed) {
  const double x = std::clamp(speed, 0.0, 1.0);
  switch (throttling) {
    case Throttling::kDischargeDamper: return 0.55 + x * (0.75 - 0.3 * x);
    case Throttling::kInletDamper: return 0.5 + x * (0.05 + 0.45 * x);
    case Throttling::kValve: return 0.6 + 0.4 * x;
    case Throttling::kNone: break;
  }
  return 1;
}

void SavingMonitor::step(double dt_s, const Settings& s, const Input& in) {
  const double commercial_kw = in.running ? s.motor_kw * s.load * commercial_power_share(s.throttling, in.speed) : 0;
  saving_kw_ = std::max(0.0, commercial_kw - in.input_kw);
  const double whole_kw = s.rate_of_capacity ? s.motor_kw : commercial_kw;
  rate_percent_ = whole_kw > 0 ? saving_kw_ / whole_kw * 100 : 0;
  if (!s.held) {
    saved_kws_ += saving_kw_ * dt_s;
    counted_s_ += dt_s;
  }
  if (!s.average_s) {
    sum_kws_ = sum_percent_s_ = since_s_ = average_kw_ = average_rate_percent_ = 0;
    updated_ = false;
    return;
  }
  sum_kws_ += saving_kw_ * dt_s;
  sum_percent_s_ += rate_percent_ * dt_s;
  since_s_ += dt_s;
  if (since_s_ + 0.5 * dt_s < *s.average_s) return;
  average_kw_ = sum_kws_ / since_s_;
  average_rate_percent_ = sum_percent_s_ / since_s_;
  sum_kws_ = sum_percent_s_ = since_s_ = 0;
  updated_ = !updated_;
}

}  // namespace vinv::inverter::a700
