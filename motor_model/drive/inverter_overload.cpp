#include "motor_model/drive/inverter_overload.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kCooling_s = 120;  // from full to empty
constexpr double kTripSlack = 1e-9;

}  // namespace

double InverterOverload::time_to_trip_s(double current_ratio) {
  return 60 * std::pow(20.0, -(current_ratio - 1.5) / 0.5);
}

void InverterOverload::step(double dt_s, double current_ratio, double start_ratio) {
  if (current_ratio > start_ratio) {
    fraction_ += dt_s / time_to_trip_s(current_ratio);
    if (fraction_ > 1 - kTripSlack) fraction_ = 1;
  } else {
    fraction_ = std::max(fraction_ - dt_s / kCooling_s, 0.0);
  }
}

}  // namespace vinv::drive
