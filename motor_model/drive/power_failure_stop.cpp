#include "motor_model/drive/power_failure_stop.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kSupplyBack_s = 0.02;  // the supply must be good this long
constexpr double kGain_hz_s_v = 1;      // faster deceleration per volt of DC link that is missing, at a gain of 1

}  // namespace

double PowerFailureStop::step(double dt_s, const Settings& settings, const Input& input) {
  const bool back = supply_back_.step(dt_s, input.supply_good && !input.phase_lost, kSupplyBack_s);
  if (!settings.on) {
    active_ = false;
    return 0;
  }
  if (!active_) {
    const bool fails = input.phase_lost || (!input.supply_good && input.dc_link_v < settings.begins_below_v);
    if (!input.running || !fails) return 0;
    active_ = true;
    return input.output_hz >= settings.subtracted_from_hz ? settings.subtracted_hz : 0;
  }
  // A stop to the end needs a new start; what resumes waits for the supply only.
  if (back && (settings.resumes || !input.start_on)) {
    active_ = false;
    return 0;
  }
  if (!settings.avoids_under_voltage || !input.running) return 0;
  return std::max(0.0, settings.begins_below_v - input.dc_link_v) * kGain_hz_s_v * settings.gain * dt_s;
}

}  // namespace vinv::drive
