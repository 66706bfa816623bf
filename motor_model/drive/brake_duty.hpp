// Duty of the brake resistor (E500 Pr.30, 70): a budget of on-time that refills at the permitted duty.
#pragma once

#include "sim/base/archive.hpp"

namespace vinv::drive {

class BrakeDuty {
 public:
  static constexpr double kWindow_s = 100;

  void step(double dt_s, bool chopper_on, double permitted_percent);
  void clear();
  // Used part of the budget, 0 ... 1.
  double fraction() const { return fraction_; }
  // False from the budget's end until part of it is back.
  bool permits() const { return permits_; }

 private:
  double fraction_ = 0;
  bool permits_ = true;
  VINV_ARCHIVE(BrakeDuty, fraction_, permits_);
};

}  // namespace vinv::drive
