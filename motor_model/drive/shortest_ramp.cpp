#include "motor_model/drive/shortest_ramp.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kLeast_hz_s = 0.1;
constexpr double kMost_hz_s = 500;
constexpr double kAim = 0.95;          // of the stall level
constexpr double kLinkAim = 0.85;      // of the way from the nominal to the over-voltage level; the chopper is below
constexpr double kAdaption_s = 0.05;   // at full margin the rate grows by e in this time
constexpr double kLinkAhead_s = 0.04;  // the link is judged by where it will be then
constexpr double kLinkRiseFilter_s = 0.005;
constexpr double kLinkSlowsFrom = 2;  // the rate falls in the last 1/2 of the way
constexpr double kWithdrawal = 4;     // an excess takes the rate back this much faster

}  // namespace

RampTimes ShortestRamp::step(double dt_s, const DriveSettings& settings, const RampTimes& times, Motion motion,
                             double current_a_rms, double dc_link_v, double stall_level_a_rms) {
  const bool up = motion == Motion::kAccelerating && settings.shortest_acceleration;
  const bool down = motion == Motion::kDecelerating && settings.shortest_deceleration;
  if (!up && !down) {
    release();
    return times;
  }
  // What an acceleration has learnt is far too steep for the deceleration that follows at once.
  if (motion != motion_) release();
  motion_ = motion;
  double reference = up ? settings.shortest_current_acceleration_a_rms : settings.shortest_current_deceleration_a_rms;
  if (reference <= 0) {
    reference = kAim * (stall_level_a_rms > 0 ? stall_level_a_rms : 1.5 * settings.rated_current_a_rms);
  }
  double margin = reference > 0 ? (reference - current_a_rms) / reference : 0;
  double link_permits = 1;  // part of the rate
  if (down && settings.shortest_watches_link && settings.over_voltage_v > settings.nominal_dc_link_v) {
    // The rotor follows the frequency late, and its energy still comes when the ramp already stands.
    const double rise_v_s = dt_s > 0 && last_dc_link_v_ > 0 ? (dc_link_v - last_dc_link_v_) / dt_s : 0;
    link_rise_v_s_.step(dt_s, kLinkRiseFilter_s, rise_v_s);
    const double expected_v = dc_link_v + kLinkAhead_s * std::max(link_rise_v_s_.value(), 0.0);
    const double room = kLinkAim * (settings.over_voltage_v - settings.nominal_dc_link_v);
    const double left = (settings.nominal_dc_link_v + room - expected_v) / room;
    margin = std::min(margin, left);
    link_permits = std::clamp(kLinkSlowsFrom * left, 0.0, 1.0);
  }
  last_dc_link_v_ = dc_link_v;
  const double gain = margin < 0 ? kWithdrawal * margin : margin;
  rate_hz_s_ =
      std::clamp(rate_hz_s_ * std::exp(dt_s / kAdaption_s * std::clamp(gain, -2.0, 1.0)), kLeast_hz_s, kMost_hz_s);
  RampTimes own = times;
  own.pattern = RampPattern::kLinear;
  own.reference_hz = std::max(kLeast_hz_s, link_permits * rate_hz_s_);
  if (up) own.acceleration_s = 1;
  if (down) own.deceleration_s = 1;
  return own;
}

}  // namespace vinv::drive
