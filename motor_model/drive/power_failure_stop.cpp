#include "motor_model/drive/power_failure_stop.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kSupplyBack_s = 0.02;  // the supply must be good this long
constexpr double kGain_hz_v = 0.1;      // slip per volt of DC link too high or too low
constexpr double kMost_hz = 5;
constexpr double kIntoRamp_s = 0.1;  // the ramp follows a lasting lack of braking with this time constant
constexpr double kAhead_s = 0.01;    // the link is judged by where it will be then
constexpr double kSlopeFilter_s = 0.003;
constexpr double kHeld_hz = 1;             // the ramp waits while the slip has to be reduced by more
constexpr double kSubtraction_hz_s = 500;  // "at once", for as long as the link does not stand high

}  // namespace

PowerFailureStop::Decision PowerFailureStop::step(double dt_s, const Settings& settings, const Input& input) {
  const double slope = dt_s > 0 && last_dc_link_v_ > 0 ? (input.dc_link_v - last_dc_link_v_) / dt_s : 0;
  last_dc_link_v_ = input.dc_link_v;
  slope_v_s_.step(dt_s, kSlopeFilter_s, slope);
  const bool back = supply_back_.step(dt_s, input.supply_good && !input.phase_lost, kSupplyBack_s);
  if (!settings.on) {
    active_ = false;
    return {};
  }
  if (!active_) {
    const bool fails = input.phase_lost || (!input.supply_good && input.dc_link_v < settings.begins_below_v);
    if (!input.running || !fails) return {};
    active_ = true;
    to_subtract_hz_ = input.output_hz >= settings.subtracted_from_hz ? settings.subtracted_hz : 0;
  }
  // A stop to the end needs a new start; what resumes waits for the supply only.
  if (back && (settings.resumes || !input.start_on)) {
    active_ = false;
    return {};
  }
  if (!input.running) return {};
  const double expected_v = input.dc_link_v + kAhead_s * slope_v_s_.value();
  Decision d;
  d.raise_by_hz = std::clamp((expected_v - settings.held_above_v) * kGain_hz_v, 0.0, kMost_hz);
  d.hold = d.raise_by_hz > kHeld_hz;
  if (!d.hold) {
    d.lower_by_hz = std::min(to_subtract_hz_, kSubtraction_hz_s * dt_s);
    to_subtract_hz_ -= d.lower_by_hz;
  }
  if (settings.avoids_under_voltage) {
    const double lack_hz =
        std::clamp((settings.begins_below_v - expected_v) * kGain_hz_v * settings.gain, 0.0, kMost_hz);
    d.raise_by_hz -= lack_hz;
    d.lower_by_hz += lack_hz * dt_s / kIntoRamp_s;
  }
  return d;
}

}  // namespace vinv::drive
