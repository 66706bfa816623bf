#include "motor_model/drive/vf_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vinv::drive {
namespace {

// The compensation is a positive feedback: all of the drop would sustain whatever current flows at low speed, and stall
// prevention could not bring it down. So it is a part, and only up to this multiple of the rated current.
constexpr double kCompensated = 0.8;
constexpr double kMostCompensated = 1.5;

double boost_percent(const DriveSettings& s, RunDirection rotation) {
  switch (s.load_pattern) {
    case LoadPattern::kHoistBoostForward: return rotation == RunDirection::kReverse ? 0 : s.torque_boost_percent;
    case LoadPattern::kHoistBoostReverse: return rotation == RunDirection::kReverse ? s.torque_boost_percent : 0;
    case LoadPattern::kConstantTorque:
    case LoadPattern::kVariableTorque: break;
  }
  return s.torque_boost_percent;
}

// Straight lines from the boost at 0 Hz through the points to the base voltage at the base frequency.
double adjustable_v_rms(const DriveSettings& s, double frequency_hz, double u_boost) {
  VfPoint from{0, u_boost};
  for (std::uint32_t i = 0; i <= s.vf_point_count; ++i) {
    const VfPoint to = i < s.vf_point_count ? s.vf_points[i] : VfPoint{s.base_frequency_hz, s.base_voltage_v_rms};
    if (frequency_hz < to.frequency_hz) {
      const double share = (frequency_hz - from.frequency_hz) / (to.frequency_hz - from.frequency_hz);
      return from.voltage_v_rms + (to.voltage_v_rms - from.voltage_v_rms) * share;
    }
    from = to;
  }
  return s.base_voltage_v_rms;
}

}  // namespace

double vf_voltage_v_rms(const DriveSettings& settings, double frequency_hz, RunDirection rotation,
                        double current_a_rms) {
  const double u_base = settings.base_voltage_v_rms;
  // A base frequency of 0 makes every frequency one of the constant-voltage range.
  const double x = frequency_hz < settings.base_frequency_hz ? frequency_hz / settings.base_frequency_hz : 1.0;
  const double shape = settings.load_pattern == LoadPattern::kVariableTorque ? x * x : x;
  const double u_boost = u_base * boost_percent(settings, rotation) / 100;
  double u = u_boost + (u_base - u_boost) * shape;
  if (settings.vf_point_count > 0) u = adjustable_v_rms(settings, frequency_hz, u_boost);
  if (settings.stator_resistance_compensation_ohm > 0) {
    const double i = kCompensated * std::min(current_a_rms, kMostCompensated * settings.rated_current_a_rms);
    u = std::max(u, u_base * std::min(1.0, shape * settings.flux_factor) +
                        std::numbers::sqrt3 * settings.stator_resistance_compensation_ohm * i);
  }
  return std::clamp(u, 0.0, std::max(u_base, 0.0));
}

double phase_peak_v(double line_v_rms) { return line_v_rms * std::sqrt(2.0 / 3.0); }

}  // namespace vinv::drive
