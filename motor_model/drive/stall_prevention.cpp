#include "motor_model/drive/stall_prevention.hpp"

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kFilter_s = 0.010;         // keeps the magnetising transient from acting
constexpr double kHoldBand = 0.05;          // above the level an acceleration is held, beyond it is taken back
constexpr double kRecovery = 0.03;          // below the level by this part: recovered
constexpr double kReferenceEnd_hz = 400;    // where the compensation formula is anchored
constexpr double kLowestLevel_percent = 1;  // a reduced level is not "off"
constexpr double kPulledDownBand_hz = 0.05;

bool selected(const DriveSettings& s, Motion motion) {
  switch (motion) {
    case Motion::kAccelerating: return s.stall_in_acceleration;
    case Motion::kConstant: return s.stall_at_constant;
    case Motion::kDecelerating: return s.stall_in_deceleration;
  }
  return false;
}

}  // namespace

double stall_level_percent(const DriveSettings& settings, double frequency_hz) {
  const double level = settings.stall_level_percent;
  if (level <= 0) return 0;
  const double start = settings.stall_reduction_start_hz;
  if (!settings.stall_compensated || frequency_hz <= start || start >= kReferenceEnd_hz) return level;
  const double a = start * level / frequency_hz;
  const double b = start * level / kReferenceEnd_hz;
  const double factor = (settings.stall_level_double_speed_percent - 100) / 100;
  return std::clamp(a + b * (level - a) / (level - b) * factor, std::min(kLowestLevel_percent, level), level);
}

void StallPrevention::observe(double dt_s, double current_a_rms) { current_.step(dt_s, kFilter_s, current_a_rms); }

void StallPrevention::release() {
  pulled_down_.clear();
  over_level_ = false;
}

StallPrevention::Decision StallPrevention::step(double dt_s, const DriveSettings& settings,
                                                const Situation& situation) {
  Decision d;
  const Motion motion = situation.motion;
  const double current = current_.value();
  d.level_a_rms = stall_level_percent(settings, situation.frequency_hz) / 100 * settings.rated_current_a_rms;
  // A motoring current falls with the frequency: a hold would keep a blocked motor from ever stopping.
  const bool helps = motion != Motion::kDecelerating || situation.regenerating;
  const bool acts = d.level_a_rms > 0 && selected(settings, motion) && helps;
  if (!acts || current < d.level_a_rms * (1 - kRecovery)) {
    over_level_ = false;
  } else if (current > d.level_a_rms) {
    over_level_ = true;
  }

  if (over_level_) {
    const bool above = current > d.level_a_rms;
    switch (motion) {
      case Motion::kAccelerating:
        if (current > d.level_a_rms * (1 + kHoldBand))
          d.action = RampAction::kLower;
        else if (above)
          d.action = RampAction::kHold;
        break;
      case Motion::kConstant: d.action = above ? RampAction::kLower : RampAction::kHold; break;
      case Motion::kDecelerating:
        if (above) d.action = RampAction::kHold;
        break;
    }
  }
  const bool link_high =
      motion == Motion::kDecelerating && settings.dc_link_hold_v > 0 && situation.dc_link_v > settings.dc_link_hold_v;
  if (link_high) d.action = RampAction::kHold;
  d.active = over_level_ || link_high;

  const bool down = over_level_ && motion != Motion::kDecelerating &&
                    situation.frequency_hz <= settings.stall_trip_frequency_hz + kPulledDownBand_hz;
  const bool too_long = pulled_down_.step(dt_s, down, settings.stall_trip_s);
  d.trip = too_long || (over_level_ && settings.stall_trips_at_once);
  return d;
}

}  // namespace vinv::drive
