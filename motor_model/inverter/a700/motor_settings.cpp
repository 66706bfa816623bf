#include "motor_model/inverter/a700/motor_settings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

using mitsubishi::or_else;

constexpr MotorNumbers kFirst{71, 800, 80, 81, 82, 83, 84, 90, 91, 92, 93, 94, 96, 859, 89, 9, 820, 821, 822, 826};
constexpr MotorNumbers kSecond{450, 451, 453, 454, 455, 456, 457, 458, 459, 460,
                               461, 462, 463, 860, 569, 51,  830, 831, 832, 836};

constexpr double kTypicalLeakage = 0.2;         // of the rated impedance, stator and rotor together
constexpr double kResponseAt100_rad_s = 200.0;  // Pr.820 = 100 % of the real speed controller
constexpr double kTorqueLag = 3;                // this much slower than that, because the torque follows late

// A setting of the second motor may fall back to the first one's.
double gain_of(const ParameterStore& p, unsigned number, unsigned first) {
  return or_else(p, number, or_else(p, first, 0));
}

bool constant_torque(int motor) {
  return motor == 1 || motor == 4 || (motor >= 13 && motor <= 18) || motor == 23 || motor == 33 || motor == 43 ||
         motor == 53;
}

// What the drive takes the motor to be, from its constants or those of the standard motor.
struct Motor {
  double rated_current_a = 0;
  double no_load_a = 0;
  double torque_a = 0;
  double r1_ohm = 0;
  double slip_share = 0;
  double leakage_ohm = 0;
  double magnetising_ohm = 0;
};

Motor motor_of(const ParameterStore& p, const MotorNumbers& n, const ModelRow& standard, double voltage_v_rms,
               double power_w) {
  Motor m;
  m.rated_current_a =
      !p.is_9999(n.thermal) && p.value(n.thermal) > 0 ? p.value(n.thermal) : standard.standard_motor_rated_a_rms;
  m.r1_ohm = or_else(p, n.r1, standard.standard_motor_r1_ohm);
  const double phase_v = voltage_v_rms / std::numbers::sqrt3;
  // Pr.94: the magnetising reactance says the current without load where Pr.82 does not.
  double no_load = standard.standard_motor_no_load_a_rms;
  if (!p.is_9999(n.x) && p.value(n.x) > 0) no_load = phase_v / p.value(n.x);
  m.no_load_a = std::min(or_else(p, n.exciting_current, no_load), 0.95 * m.rated_current_a);
  m.no_load_a = std::max(m.no_load_a, 0.05 * m.rated_current_a);
  const double torque_a = std::sqrt(m.rated_current_a * m.rated_current_a - m.no_load_a * m.no_load_a);
  m.torque_a = or_else(p, n.torque_current, torque_a);
  m.slip_share = standard.standard_motor_slip_percent / 100;
  if (!p.is_9999(n.r2) && p.value(n.r2) > 0) {
    const double rotor_w = 3 * p.value(n.r2) * m.torque_a * m.torque_a;
    m.slip_share = rotor_w / (power_w + rotor_w);
  }
  const double impedance = phase_v / std::max(m.rated_current_a, 1e-3);
  m.leakage_ohm = or_else(p, n.l1, kTypicalLeakage / 2 * impedance) + or_else(p, n.l2, kTypicalLeakage / 2 * impedance);
  const double emf = std::sqrt(std::max(0.0, phase_v * phase_v - std::pow(m.r1_ohm * m.no_load_a, 2)));
  m.magnetising_ohm = emf / m.no_load_a;
  return m;
}

}  // namespace

const MotorNumbers& motor_numbers(bool second) { return second ? kSecond : kFirst; }

ControlMethod control_method(const ParameterStore& p, const MotorSelection& selection) {
  const MotorNumbers& n = motor_numbers(selection.second);
  if (selection.vf_by_x18 || p.is_9999(n.capacity) || p.is_9999(n.poles)) return ControlMethod::kVf;
  // Pr.451 = 9999 and methods without a known meaning (13, 14) are 20.
  switch (p.is_9999(n.method) ? 20 : p.integer(n.method)) {
    case 10: return ControlMethod::kSpeed;
    case 11: return ControlMethod::kTorque;
    case 12: return selection.torque_by_mc ? ControlMethod::kTorque : ControlMethod::kSpeed;
    default: return ControlMethod::kFluxVector;
  }
}

double speed_integral_s(const ParameterStore& p, bool second) {
  return gain_of(p, motor_numbers(second).integral, motor_numbers(false).integral);
}

bool needs_encoder(unsigned number, int raw) {
  return number == pr::kControlMethod && ((raw >= 0 && raw <= 5) || raw == 9);
}

double rated_torque_nm(const ParameterStore& p, const MotorNumbers& n, double slip_share) {
  const double pole_pairs = or_else(p, n.poles, 4) / 2;
  const double shaft_rad_s = 2 * std::numbers::pi * p.value(n.frequency) / pole_pairs * (1 - slip_share);
  return shaft_rad_s > 0 ? p.value(n.capacity) * 1000 / shaft_rad_s : 0;
}

void set_motor(drive::DriveSettings& s, const ParameterStore& p, const MotorSelection& selection,
               const mitsubishi::SettingsSurroundings& around, double motor_start_s) {
  const MotorNumbers& n = motor_numbers(selection.second);
  const MotorNumbers& first = motor_numbers(false);
  const ControlMethod method = control_method(p, selection);
  s.second_motor = selection.second;
  s.motor_forced_cooling = constant_torque(p.integer(n.applied));
  if (selection.second) s.electronic_thermal_a_rms = or_else(p, n.thermal, p.value(first.thermal));
  const double capacity_kw = or_else(p, n.capacity, around.model->motor_kw);
  const ModelRow& standard = mitsubishi::standard_motor(around, capacity_kw);
  const Motor m = motor_of(p, n, standard, s.base_voltage_v_rms, capacity_kw * 1000);
  s.motor_slip_hz = s.base_frequency_hz * m.slip_share;
  s.motor_stator_ohm = m.r1_ohm;
  s.motor_no_load_current_a_rms = m.no_load_a;
  s.motor_rated_current_a_rms = m.rated_current_a;
  if (method == ControlMethod::kVf) return;

  const Motor v = motor_of(p, n, standard, p.value(n.voltage), capacity_kw * 1000);
  s.base_voltage_v_rms = p.value(n.voltage);
  s.base_frequency_hz = s.cushion_pattern_base_hz = p.value(n.frequency);
  s.torque_boost_percent = 0;
  s.load_pattern = drive::LoadPattern::kConstantTorque;
  s.stator_resistance_compensation_ohm = v.r1_ohm;
  s.motor_slip_hz = s.base_frequency_hz * v.slip_share;
  s.motor_no_load_current_a_rms = v.no_load_a;
  // Pr.89 and Pr.569: how much of the slip is compensated.
  s.rated_slip_hz =
      s.base_frequency_hz * or_else(p, pr::kRatedSlip, v.slip_share * 100) / 100 * or_else(p, n.speed_gain, 100) / 100;
  if (method == ControlMethod::kFluxVector) return;

  drive::VectorSettings& c = s.vector;
  c.on = true;
  c.torque_control = method == ControlMethod::kTorque;
  c.rated_frequency_hz = s.base_frequency_hz;
  c.rated_slip_hz = s.base_frequency_hz * v.slip_share;
  c.rated_torque_nm = rated_torque_nm(p, n, v.slip_share);
  c.no_load_current_a_rms = v.no_load_a;
  c.torque_current_a_rms = v.torque_a;
  c.stator_ohm = v.r1_ohm;
  c.leakage_ohm = v.leakage_ohm;
  c.magnetising_ohm = v.magnetising_ohm;
  c.start_s = motor_start_s;
  c.response_rad_s = gain_of(p, n.p_gain, first.p_gain) / 100 * kResponseAt100_rad_s / kTorqueLag;
  c.integral_s = speed_integral_s(p, selection.second);
  c.speed_filter_s = gain_of(p, n.speed_filter, first.speed_filter);
  c.torque_filter_s = gain_of(p, n.torque_filter, first.torque_filter);
  if (p.integer(pr::kFeedForward) == 1) {
    c.feed_forward = p.value(pr::kFeedForwardGain) / 100;
    c.load_inertia = p.value(pr::kLoadInertia);
    c.feed_forward_filter_s = p.value(pr::kFeedForwardFilter);
    c.feed_forward_most_percent = p.value(pr::kFeedForwardLimit);
  }
  c.limit_accelerating_percent = or_else(p, pr::kTorqueLimitAccelerating, -1);
  c.limit_decelerating_percent = or_else(p, pr::kTorqueLimitDecelerating, -1);
  c.constant_torque_above_base = p.integer(pr::kConstantPowerRange) == 1;
  c.idle_excitation = p.value(pr::kExcitationRatio) / 100;
  c.stall_hz = p.value(pr::kLowSpeedDetection);
  c.stall_percent = p.value(pr::kOltLevel);
  s.zero_speed_brake = p.integer(pr::kBrakeOperation) == 1;
  // The torque limit takes the place of stall prevention; the hardware's current limit stays.
  s.stall_level_percent = 0;
}

void set_torque_limits(drive::VectorSettings& c, const ParameterStore& p, bool by_tl) {
  const double common = p.value(pr::kStallLevel);
  c.limit_percent = {common, or_else(p, pr::kTorqueLimitForwardBraking, common),
                     or_else(p, pr::kTorqueLimitReverseDriving, common),
                     or_else(p, pr::kTorqueLimitReverseBraking, common)};
  if (by_tl && !p.is_9999(pr::kTorqueLimit2)) c.limit_percent.fill(p.value(pr::kTorqueLimit2));
}

}  // namespace vinv::inverter::a700
