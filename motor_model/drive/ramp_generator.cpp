#include "motor_model/drive/ramp_generator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motor_model/drive/s_curve.hpp"

namespace vinv::drive {
namespace {

// Arrival within this part of a step counts: sums of ticks are not exact.
constexpr double kArrivalSlack = 1e-9;
constexpr double kMuchFurther = 1.25;

double rate_hz_s(double reference_hz, double time_s) {
  if (time_s <= 0 || reference_hz <= 0) return std::numeric_limits<double>::infinity();
  return reference_hz / time_s;
}

}  // namespace

double acceleration_rate_hz_s(const RampTimes& times) { return rate_hz_s(times.reference_hz, times.acceleration_s); }
double deceleration_rate_hz_s(const RampTimes& times) { return rate_hz_s(times.reference_hz, times.deceleration_s); }

Motion RampGenerator::motion_towards(double target_hz) const {
  if (target_hz == frequency_hz_) return Motion::kConstant;
  if (target_hz * frequency_hz_ < 0) return Motion::kDecelerating;
  return std::abs(target_hz) > std::abs(frequency_hz_) ? Motion::kAccelerating : Motion::kDecelerating;
}

void RampGenerator::set(double frequency_hz) {
  frequency_hz_ = frequency_hz;
  planned_ = false;
  hold_left_s_ = 0;
}

void RampGenerator::lower(double by_hz, double floor_hz) {
  const double magnitude = std::abs(frequency_hz_);
  const double lowered = std::max(magnitude - by_hz, std::min(floor_hz, magnitude));
  set(std::copysign(lowered, frequency_hz_));
}

void RampGenerator::step(double dt_s, double target_hz, const RampTimes& times) {
  const double target = target_hz * frequency_hz_ < 0 ? 0 : target_hz;
  const Motion motion = motion_towards(target);
  if (motion == Motion::kConstant || dt_s <= 0) {
    if (motion == Motion::kConstant) planned_ = false;
    return;
  }
  const double rate = motion == Motion::kAccelerating ? acceleration_rate_hz_s(times) : deceleration_rate_hz_s(times);
  const double s_time = motion == Motion::kAccelerating ? times.s_time_acceleration_s : times.s_time_deceleration_s;
  const double s_end = motion == Motion::kAccelerating ? times.s_end_acceleration_s : times.s_end_deceleration_s;
  const bool rounded = (times.pattern == RampPattern::kSCurveC && s_time > 0) ||
                       (times.pattern == RampPattern::kSCurveD && s_time + s_end > 0);
  if (times.pattern == RampPattern::kSCurveB || rounded) {
    step_planned(dt_s, target, rate, s_time, s_end, times.pattern);
    return;
  }
  planned_ = false;
  if (times.pattern == RampPattern::kSCurveA && times.s_curve_base_hz > 0) {
    step_s_curve_a(dt_s, target, motion, times);
  } else if (times.pattern == RampPattern::kBacklash) {
    step_backlash(dt_s, target, motion, rate, times);
  } else {
    step_linear(dt_s, target, rate);
  }
}

void RampGenerator::step_at_most(double dt_s, double target_hz, const RampTimes& times, double most_hz_s) {
  RampGenerator next = *this;
  next.step(dt_s, target_hz, times);
  const double change_hz = std::abs(next.frequency_hz_ - frequency_hz_);
  const double most_hz = std::max(most_hz_s, 0.0) * dt_s;
  if (change_hz <= most_hz) {
    *this = next;
  } else {
    step(dt_s * most_hz / change_hz, target_hz, times);
  }
}

void RampGenerator::step_linear(double dt_s, double target_hz, double rate_hz_s) {
  const double step_hz = rate_hz_s * dt_s;
  const double change_hz = target_hz - frequency_hz_;
  if (std::abs(change_hz) <= step_hz * (1 + kArrivalSlack)) {
    frequency_hz_ = target_hz;
  } else {
    frequency_hz_ += std::copysign(step_hz, change_hz);
  }
}

void RampGenerator::step_s_curve_a(double dt_s, double target_hz, Motion motion, const RampTimes& times) {
  const bool up = motion == Motion::kAccelerating;
  const double total_s = up ? times.acceleration_s : times.deceleration_s;
  if (total_s <= 0) {
    frequency_hz_ = target_hz;
    return;
  }
  // The curve is a function of the frequency alone, so the present frequency says where on it we are.
  const double sign = std::copysign(1.0, up ? target_hz : frequency_hz_);
  const double now_s = s_curve_a_time_s(std::abs(frequency_hz_), total_s, times.s_curve_base_hz);
  const double end_s = s_curve_a_time_s(std::abs(target_hz), total_s, times.s_curve_base_hz);
  if (std::abs(end_s - now_s) <= dt_s * (1 + kArrivalSlack)) {
    frequency_hz_ = target_hz;
  } else {
    frequency_hz_ = sign * s_curve_a_frequency_hz(up ? now_s + dt_s : now_s - dt_s, total_s, times.s_curve_base_hz);
  }
}

void RampGenerator::step_backlash(double dt_s, double target_hz, Motion motion, double rate_hz_s,
                                  const RampTimes& times) {
  if (hold_left_s_ > 0) {
    hold_left_s_ -= dt_s;
    return;
  }
  const double before = std::abs(frequency_hz_);
  step_linear(dt_s, target_hz, rate_hz_s);
  const double after = std::abs(frequency_hz_);
  const bool up = motion == Motion::kAccelerating;
  const double hold_hz = up ? times.hold_up_hz : times.hold_down_hz;
  const bool passed = up ? before < hold_hz && after >= hold_hz : before > hold_hz && after <= hold_hz;
  if (!passed) return;
  hold_left_s_ = up ? times.hold_up_s : times.hold_down_s;
  if (hold_left_s_ > 0) frequency_hz_ = std::copysign(hold_hz, frequency_hz_ != 0 ? frequency_hz_ : target_hz);
}

void RampGenerator::step_planned(double dt_s, double target_hz, double rate_hz_s, double s_time_s, double s_end_s,
                                 RampPattern pattern) {
  const bool d = pattern == RampPattern::kSCurveD;
  const bool even = pattern == RampPattern::kSCurveC;
  // C takes its S time in addition to the straight ramp's; a short way is all S. So with D, which has two.
  const auto s_curve_d = [&](double change_hz) {
    return s_curve_d_of(std::abs(change_hz) / rate_hz_s, s_time_s, s_end_s);
  };
  const auto duration = [&](double change_hz) {
    const double straight = std::abs(change_hz) / rate_hz_s;
    if (d) return s_curve_d(change_hz).total_s;
    return even ? straight + std::min(s_time_s, straight) : straight;
  };
  const auto share = [&](double change_hz) {
    const double total = duration(change_hz);
    return total > 0 ? std::min(0.5, (total - std::abs(change_hz) / rate_hz_s) / total) : 0;
  };
  const auto remaining = [&](double progress) {
    if (d) return s_curve_d_remaining(progress, s_curve_d(plan_change_hz_));
    return even ? s_curve_c_remaining(progress, share(plan_change_hz_)) : drive::s_curve_b_remaining(progress);
  };
  const double remaining_hz = target_hz - frequency_hz_;
  const bool same_direction = planned_ && remaining_hz * plan_change_hz_ > 0;
  if (!same_direction) {
    plan_progress_ = 0;
    plan_change_hz_ = remaining_hz;
    plan_first_change_hz_ = remaining_hz;
  } else if (target_hz != plan_target_hz_) {
    // A moved target keeps the present slope, which depends on the progress alone; the curve would otherwise begin anew
    // at every tick under a moving reference. Much further away, the slope belongs to the first half of the new curve.
    plan_change_hz_ = remaining_hz / remaining(plan_progress_);
    if (plan_progress_ > 0.5 && std::abs(plan_change_hz_) > kMuchFurther * std::abs(plan_first_change_hz_)) {
      plan_progress_ = 1 - plan_progress_;
      plan_change_hz_ = remaining_hz / remaining(plan_progress_);
      plan_first_change_hz_ = plan_change_hz_;
    }
  }
  planned_ = true;
  plan_target_hz_ = target_hz;
  plan_progress_ += dt_s / duration(plan_change_hz_);
  if (plan_progress_ >= 1 - kArrivalSlack) {
    set(target_hz);
  } else {
    frequency_hz_ = target_hz - plan_change_hz_ * remaining(plan_progress_);
  }
}

}  // namespace vinv::drive
