#include "motor_model/drive/inverter_overload.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kCooling_s = 120;  // from full to empty
constexpr double kTripSlack = 1e-9;
// Typical for such drives, which lower the carrier or the permitted overload near standstill.
constexpr double kSlow_hz = 10;
constexpr double kExcessAtStandstill = 1.4;

}  // namespace

double InverterOverload::time_to_trip_s(double current_ratio) {
  return 60 * std::pow(20.0, -(current_ratio - 1.5) / 0.5);
}

double InverterOverload::effective_ratio(double current_ratio, double frequency_hz) {
  if (current_ratio <= 1 || frequency_hz >= kSlow_hz) return current_ratio;
  const double slow = 1 - frequency_hz / kSlow_hz;
  return 1 + (current_ratio - 1) * (1 + (kExcessAtStandstill - 1) * slow);
}

void InverterOverload::step(double dt_s, double current_ratio, double frequency_hz, double start_ratio) {
  const double ratio = effective_ratio(current_ratio, frequency_hz);
  if (ratio > start_ratio) {
    fraction_ += dt_s / time_to_trip_s(ratio);
    if (fraction_ > 1 - kTripSlack) fraction_ = 1;
  } else {
    fraction_ = std::max(fraction_ - dt_s / kCooling_s, 0.0);
  }
}

}  // namespace vinv::drive
