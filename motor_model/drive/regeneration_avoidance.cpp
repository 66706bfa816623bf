#include "motor_model/drive/regeneration_avoidance.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kGain_hz_v = 0.15;  // rise per volt above the level
constexpr double kAhead_s = 0.01;    // the link is judged by where it will be then
constexpr double kSlopeFilter_s = 0.003;
constexpr double kFall_s = 0.1;          // the rise is taken back with this time constant
constexpr double kSteepest_v_s = 10000;  // a rise of this counts at sensitivity 1, a fifth of it at 5
constexpr double kNearLevel = 0.93;      // ... not far below the level

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
  const double expected_v = dc_link_v + kAhead_s * std::max(0.0, slope_v_s_.value());
  const bool steep = decelerating && settings.sensitivity > 0 && dc_link_v > kNearLevel * settings.level_v &&
                     slope_v_s_.value() > kSteepest_v_s / settings.sensitivity;
  const bool high = dc_link_v > settings.level_v;
  const double over_v = high ? expected_v - settings.level_v : 0;
  const double wanted =
      std::min(settings.most_hz, settings.voltage_gain * settings.frequency_gain * kGain_hz_v * over_v);
  raise_hz_ = wanted > raise_hz_ ? wanted : raise_hz_ + (wanted - raise_hz_) * std::min(1.0, dt_s / kFall_s);
  const bool active = high || steep;
  return {raise_hz_, active, active};
}

}  // namespace vinv::drive
