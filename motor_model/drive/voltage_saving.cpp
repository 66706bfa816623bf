#include "motor_model/drive/voltage_saving.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kLook_s = 0.25;   // power is averaged over this time between two changes ...
constexpr double kSettle_s = 0.1;  // ... after this one
constexpr double kStep = 0.02;
constexpr double kLeast = 0.4;
constexpr double kNewLoad = 0.25;  // a change of power by this share is another load: full voltage again
constexpr double kReturn_s = 4;    // per second

}  // namespace

double VoltageSaving::step(double dt_s, bool on, double output_power_w) {
  if (!on) {
    factor_ = std::min(1.0, factor_ + kReturn_s * dt_s);
    direction_ = -1;
    sum_ws_ = since_s_ = last_power_w_ = 0;
    return factor_;
  }
  since_s_ += dt_s;
  if (since_s_ > kSettle_s) sum_ws_ += output_power_w * dt_s;
  if (since_s_ < kSettle_s + kLook_s) return factor_;
  look(sum_ws_ / (since_s_ - kSettle_s));
  sum_ws_ = since_s_ = 0;
  return factor_;
}

void VoltageSaving::look(double power_w) {
  const double before = last_power_w_;
  last_power_w_ = power_w;
  if (before > 0 && std::abs(power_w - before) > kNewLoad * before) {
    factor_ = 1;
    direction_ = -1;
    return;
  }
  if (before > 0 && power_w > before) direction_ = -direction_;
  factor_ = std::clamp(factor_ + direction_ * kStep, kLeast, 1.0);
}

}  // namespace vinv::drive
