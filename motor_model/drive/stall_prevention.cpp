#include "motor_model/drive/stall_prevention.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/drive/fast_current_limit.hpp"

namespace vinv::drive {
namespace {

constexpr double kFilter_s = 0.010;         // keeps the magnetising transient from acting
constexpr double kRecovery = 0.03;          // below the level by this part: recovered ...
constexpr double kStillHeld = 0.10;         // ... or by this part while the ramp is still slowed
constexpr double kReferenceEnd_hz = 400;    // where the compensation formula is anchored
constexpr double kLowestLevel_percent = 1;  // a reduced level is not "off"
constexpr double kPulledDownBand_hz = 0.05;
constexpr double kBelowFastLimit = 0.95;
constexpr double kLeastFactor = 0.2;  // of the fast limit that is believed

// The controller. Times: how fast the slip of the level is taken away or given. Short against the rotor's time
// constant, long against lag and tick; found with motors of 0.4 to 7.5 kW and inertias of 1 to 50 times their own.
constexpr double kOver_s = 0.04;   // proportional part above the level
constexpr double kUnder_s = 0.06;  // and below it, where nothing is urgent
constexpr double kLearn_s = 0.3;   // integral action on top of it
constexpr double kLearnOverFactor = 2;
constexpr double kAdapt_s = 0.05;     // the learnt rate also changes by its own size: rates span three decades
constexpr double kSlowing = 1.5;      // part above the level that stops the learnt rate
constexpr double kMostShare = 2;      // below the level up to this multiple of the learnt rate
constexpr double kTorqueBand = 0.02;  // of the current, around no torque: its sign there is not sharp

bool selected(const DriveSettings& s, Motion motion) {
  switch (motion) {
    case Motion::kAccelerating: return s.stall_in_acceleration;
    case Motion::kConstant: return s.stall_at_constant;
    case Motion::kDecelerating: return s.stall_in_deceleration;
  }
  return false;
}

// The sign of the torque from the power that crosses the air gap: the voltage's less what the stator resistance takes.
double torque_sign(const OutputSample& output, double stator_ohm) {
  if (output.current_a_rms <= 0) return 0;
  const double air_gap_a = output.active_current_a_rms - resistive_current_a_rms(output, stator_ohm);
  return std::clamp(air_gap_a / (kTorqueBand * output.current_a_rms), -1.0, 1.0);
}

// A level beyond the fast limit cannot be reached: the current would stand at the limit, with ever less voltage.
double reachable(const DriveSettings& s, double level_a_rms) {
  const double fast_a_rms = FastCurrentLimit::level_a_peak(s) / std::numbers::sqrt2;
  return fast_a_rms > 0 ? std::min(level_a_rms, kBelowFastLimit * fast_a_rms) : level_a_rms;
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

void StallPrevention::observe(double dt_s, const DriveSettings& settings, const Measurement& m) {
  current_.step(dt_s, kFilter_s, m.output.current_a_rms);
  // The fast limit acts on a motor that is driven too hard, and hides by how much: this much would flow without it.
  const bool limited = m.voltage_factor < 1;
  const double driving_a_rms = limited ? m.output.current_a_rms / std::max(m.voltage_factor, kLeastFactor)
                                       : m.output.current_a_rms * torque_sign(m.output, settings.motor_stator_ohm);
  const double before = driving_.value();
  driving_.step(dt_s, kFilter_s, driving_a_rms);
  ahead_a_rms_ = driving_.value() + (dt_s > 0 ? (driving_.value() - before) / dt_s * kFilter_s : 0);
}

void StallPrevention::release() {
  pulled_down_.clear();
  over_level_ = false;
  fresh_ = true;
}

double StallPrevention::permitted_hz_s(double dt_s, const DriveSettings& settings, const Situation& situation,
                                       double level_a_rms) {
  const bool down = situation.motion == Motion::kDecelerating;
  const double most = down ? situation.deceleration_hz_s : situation.acceleration_hz_s;
  double least = -situation.deceleration_hz_s;
  if (down) least = 0;  // a deceleration is held, not turned round
  if (situation.motion == Motion::kAccelerating) least = -situation.acceleration_hz_s;

  const double rated =
      settings.motor_rated_current_a_rms > 0 ? settings.motor_rated_current_a_rms : settings.rated_current_a_rms;
  const double slip_hz = settings.motor_slip_hz * level_a_rms / rated;
  const auto below_level = [&](double current_a_rms) {
    const double harmful = down ? -current_a_rms : current_a_rms;
    return std::clamp(1 - harmful / level_a_rms, -1.0, 1.0);
  };
  if (fresh_) learnt_hz_s_ = situation.motion == Motion::kConstant ? 0 : slip_hz / kOver_s;
  fresh_ = false;

  const double error = below_level(driving_.value());
  const double gain =
      (slip_hz / (kOver_s * kLearn_s) + std::abs(learnt_hz_s_) / kAdapt_s) * (error < 0 ? kLearnOverFactor : 1.0);
  learnt_hz_s_ = std::clamp(learnt_hz_s_ + dt_s * gain * error, least, most);

  const double ahead = below_level(ahead_a_rms_);
  const double share = learnt_hz_s_ > 0 ? std::clamp(1 + ahead / kSlowing, 0.0, kMostShare) : 1.0;
  const double rate = learnt_hz_s_ * share + slip_hz / (ahead < 0 ? kOver_s : kUnder_s) * ahead;
  // What is only expected holds the ramp but does not lower it.
  return std::clamp(rate, error > 0 ? std::max(least, std::min(learnt_hz_s_, 0.0)) : least, most);
}

StallPrevention::Decision StallPrevention::step(double dt_s, const DriveSettings& settings,
                                                const Situation& situation) {
  Decision d;
  const Motion motion = situation.motion;
  d.level_a_rms =
      reachable(settings, stall_level_percent(settings, situation.frequency_hz) / 100 * settings.rated_current_a_rms);
  if (motion != motion_) fresh_ = true;
  motion_ = motion;

  const bool decelerating = motion == Motion::kDecelerating;
  if (d.level_a_rms > 0 && selected(settings, motion)) {
    const double rate = permitted_hz_s(dt_s, settings, situation, d.level_a_rms);
    const bool slowed = rate < (decelerating ? situation.deceleration_hz_s : situation.acceleration_hz_s);
    if (slowed) d.most_hz_s = rate;
    const double harmful = decelerating ? -driving_.value() : driving_.value();
    if (harmful > d.level_a_rms) over_level_ = true;
    const double released = d.level_a_rms * (1 - (slowed && motion != Motion::kConstant ? kStillHeld : kRecovery));
    if (harmful < released) over_level_ = false;
    if (rate < 0) over_level_ = true;  // never in silence
  } else {
    over_level_ = false;
    fresh_ = true;
  }
  const bool link_high = decelerating && settings.dc_link_hold_v > 0 && situation.dc_link_v > settings.dc_link_hold_v;
  if (link_high) d.most_hz_s = 0;
  d.link_high = link_high;
  d.active = over_level_ || link_high;

  const bool down =
      over_level_ && !decelerating && situation.frequency_hz <= settings.stall_trip_frequency_hz + kPulledDownBand_hz;
  const bool too_long = pulled_down_.step(dt_s, down, settings.stall_trip_s);
  d.trip = too_long || (over_level_ && settings.stall_trips_at_once);
  return d;
}

}  // namespace vinv::drive
