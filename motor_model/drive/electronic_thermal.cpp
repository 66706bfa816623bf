#include "motor_model/drive/electronic_thermal.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace vinv::drive {
namespace {

struct Point {
  double frequency_hz;
  double current;
};
// Typical for a self-cooled 50 Hz motor.
constexpr std::array<Point, 6> kSelfCooled{{{1, 0.4}, {5, 0.5}, {15, 0.6}, {20, 0.7}, {30, 0.9}, {50, 1.0}}};

}  // namespace

double ElectronicThermal::continuous_current(double frequency_hz) {
  if (frequency_hz <= kSelfCooled.front().frequency_hz) return kSelfCooled.front().current;
  for (std::size_t i = 1; i < kSelfCooled.size(); ++i) {
    const Point& low = kSelfCooled[i - 1];
    const Point& high = kSelfCooled[i];
    if (frequency_hz < high.frequency_hz) {
      return low.current +
             (high.current - low.current) * (frequency_hz - low.frequency_hz) / (high.frequency_hz - low.frequency_hz);
    }
  }
  return kSelfCooled.back().current;
}

void ElectronicThermal::step(double dt_s, double current_ratio, double frequency_hz, bool forced_cooling) {
  const double c = forced_cooling ? 1.0 : continuous_current(frequency_hz);
  const double end = current_ratio * current_ratio / (c * c);
  state_ -= (end - state_) * std::expm1(-dt_s / kTimeConstant_s);  // exact for a constant current
}

}  // namespace vinv::drive
