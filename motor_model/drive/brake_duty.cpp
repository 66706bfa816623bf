#include "motor_model/drive/brake_duty.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kPermitsAgain = 0.9;
constexpr double kSlack = 1e-9;

}  // namespace

void BrakeDuty::clear() {
  fraction_ = 0;
  permits_ = true;
}

void BrakeDuty::step(double dt_s, bool chopper_on, double permitted_percent) {
  const double duty = std::min(permitted_percent / 100, 1.0);
  if (duty <= 0) {
    fraction_ = 0;
    permits_ = false;
    return;
  }
  const double budget_s = duty * kWindow_s;
  fraction_ = std::clamp(fraction_ + ((chopper_on ? 1.0 : 0.0) - duty) * dt_s / budget_s, 0.0, 1.0);
  if (fraction_ >= 1 - kSlack) {
    permits_ = false;
  } else if (fraction_ <= kPermitsAgain) {
    permits_ = true;
  }
}

}  // namespace vinv::drive
