#include "motor_model/drive/regeneration_avoidance.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kGain_hz_v = 0.1;      // rise per volt above the level
constexpr double kAhead_s = 0.02;       // the link is judged by where it will be then ...
constexpr double kAheadMore_s = 0.004;  // ... and by this more for each step of the sensitivity
constexpr double kSlopeFilter_s = 0.003;
constexpr double kFall_s = 0.02;  // the rise is taken back with this time constant
constexpr double kHeld_hz = 0.5;  // a deceleration waits while the frequency has to rise by more

}  // namespace

RegenerationAvoidance::Decision RegenerationAvoidance::step(double dt_s, const Settings& settings, bool decelerating,
                                                            double dc_link_v) {
  const double slope = dt_s > 0 && last_dc_link_v_ > 0 ? (dc_link_v - last_dc_link_v_) / dt_s : 0;
  last_dc_link_v_ = dc_link_v;
  slope_v_s_.step(dt_s, kSlopeFilter_s, slope);
  if (!settings.on) {
    raise_hz_ = 0;
    return {};
  }
  const double ahead_s = kAhead_s + (decelerating ? settings.sensitivity * kAheadMore_s : 0);
  const double over_v = std::max(0.0, dc_link_v + ahead_s * std::max(0.0, slope_v_s_.value()) - settings.level_v);
  const double needed = settings.voltage_gain * settings.frequency_gain * kGain_hz_v * over_v;
  const double wanted = std::min(settings.most_hz, needed);
  raise_hz_ = wanted > raise_hz_ ? wanted : raise_hz_ + (wanted - raise_hz_) * std::min(1.0, dt_s / kFall_s);
  return {raise_hz_, needed > kHeld_hz, over_v > 0};
}

}  // namespace vinv::drive
