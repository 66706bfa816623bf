#include "motor_model/inverter/mitsubishi/settings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/run_command.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

void set_ramps(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  s.acceleration_s = p.value(pr::kAcceleration);
  s.deceleration_s = p.value(pr::kDeceleration);
  if (selection.second) {
    s.acceleration_s = p.value(pr::kSecondRamp);
    s.deceleration_s = or_else(p, pr::kSecondDeceleration, s.acceleration_s);
  }
  if (selection.jog) s.acceleration_s = s.deceleration_s = p.value(pr::kJogTime);
  s.ramp_reference_hz = p.value(pr::kRampReference);
}

void set_frequencies(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  s.max_frequency_hz = maximum_frequency_hz(p);
  s.min_frequency_hz = selection.jog ? 0 : p.value(pr::kMinimumFrequency);  // Pr.15 goes before Pr.2
  s.start_frequency_hz = p.value(pr::kStartingFrequency);
  for (unsigned i = 0; i < s.jump_bands.size(); ++i) {
    const unsigned a = pr::kJump1A + 2 * i;
    if (p.is_9999(a) || p.is_9999(a + 1)) continue;
    const double from = p.value(a);
    const double to = p.value(a + 1);
    s.jump_bands[i] = {std::min(from, to), std::max(from, to), from};
  }
  s.up_to_frequency_percent = p.value(pr::kUpToFrequency);
  s.detect_forward_hz = p.value(pr::kDetection);
  s.detect_reverse_hz = or_else(p, pr::kDetectionReverse, s.detect_forward_hz);
}

void set_voltage(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection,
                 const SettingsSurroundings& around) {
  const double base_voltage = p.value(pr::kBaseVoltage);
  s.supply_voltage_v_rms = around.mains_v_rms;
  s.base_voltage_v_rms = base_voltage == 9999   ? around.mains_v_rms
                         : base_voltage == 8888 ? around.mains_v_rms * 0.95
                                                : base_voltage;
  s.base_frequency_hz = p.value(pr::kBaseFrequency);
  s.torque_boost_percent = p.value(pr::kTorqueBoost);
  if (selection.second) {
    s.base_frequency_hz = or_else(p, pr::kSecondBaseFrequency, s.base_frequency_hz);
    s.torque_boost_percent = or_else(p, pr::kSecondBoost, s.torque_boost_percent);
  }
  switch (p.integer(pr::kLoadPattern)) {
    case 1: s.load_pattern = drive::LoadPattern::kVariableTorque; break;
    case 2: s.load_pattern = drive::LoadPattern::kHoistBoostForward; break;
    case 3: s.load_pattern = drive::LoadPattern::kHoistBoostReverse; break;
    default: s.load_pattern = drive::LoadPattern::kConstantTorque;
  }
  const ModelRow& standard = standard_motor(around, or_else(p, pr::kMotorCapacity, around.model->motor_kw));
  s.rated_slip_hz = s.base_frequency_hz * or_else(p, pr::kRatedSlip, 0) / 100;
  s.cushion_pattern_base_hz = s.base_frequency_hz;
  s.motor_slip_hz = s.base_frequency_hz * standard.standard_motor_slip_percent / 100;
  s.motor_stator_ohm = or_else(p, pr::kMotorR1, standard.standard_motor_r1_ohm);
  s.motor_no_load_current_a_rms = or_else(p, pr::kExcitingCurrent, standard.standard_motor_no_load_a_rms);
  s.motor_rated_current_a_rms = p.value(pr::kThermal) > 0 ? p.value(pr::kThermal) : standard.standard_motor_rated_a_rms;
  s.slip_response_s = p.value(pr::kSlipResponse);
  s.slip_in_constant_output = p.is_9999(pr::kSlipConstantOutput);
  s.dc_brake_frequency_hz = p.value(pr::kDcBrakeFrequency);
  s.dc_brake_s = p.value(pr::kDcBrakeTime);
  s.dc_brake_voltage_percent = p.value(pr::kDcBrakeVoltage);
}

void set_stall(drive::DriveSettings& s, const ParameterStore& p) {
  s.stall_level_percent = p.value(pr::kStallLevel);
  s.stall_compensated = !p.is_9999(pr::kStallDoubleSpeed);
  s.stall_level_double_speed_percent = or_else(p, pr::kStallDoubleSpeed, 100);
  s.stall_reduction_start_hz = p.value(pr::kStallReductionStart);
  // Bits of Pr.156: 0 fast current limit off, 1 not in acceleration, 2 not at constant speed, 3 not in deceleration,
  // 4 OL trips. 100 keeps all of it for driving and leaves regeneration alone.
  const int selection = p.integer(pr::kStallSelection);
  const bool driving_only = selection == 100;
  const int bits = driving_only ? 0 : selection;
  s.fast_current_limit = (bits & 1) == 0 && s.stall_level_percent > 0;
  s.stall_in_acceleration = (bits & 2) == 0;
  s.stall_at_constant = (bits & 4) == 0;
  s.stall_in_deceleration = (bits & 8) == 0 && !driving_only;
  s.stall_trips_at_once = (bits & 16) != 0;
}

void set_protections(drive::DriveSettings& s, const ParameterStore& p, const SettingsSurroundings& around) {
  const ModelRow& m = *around.model;
  s.electronic_thermal_a_rms = p.value(pr::kThermal);
  s.over_current_percent = m.over_current_percent;
  s.over_voltage_v = m.over_voltage_v;
  s.under_voltage_v = m.under_voltage_v;
  s.under_voltage_clear_v = m.under_voltage_clear_v;
  s.heat_sink_trip_c = m.heat_sink_trip_c;
  s.output_phase_loss_protection = p.integer(pr::kOutputPhaseLoss) == 1;
  s.chopper_fitted = around.brake_resistor;
  s.chopper_on_v = m.chopper_on_v;
  s.chopper_off_v = m.chopper_off_v;
  s.chopper_duty_percent = m.chopper_duty_percent;
  const double restart = p.value(pr::kRestart);
  s.restart_enabled = restart != 9999;
  s.restart_coast_s = restart == 0 ? m.restart_coast_s : s.restart_enabled ? restart : 0;
  s.restart_cushion_s = p.value(pr::kRestartCushion);
  s.current_detect_percent = p.value(pr::kCurrentDetection);
  s.current_detect_s = p.value(pr::kCurrentDetectionTime);
  s.zero_current_percent = p.value(pr::kZeroCurrent);
  s.zero_current_s = p.value(pr::kZeroCurrentTime);
}

}  // namespace

double or_else(const ParameterStore& p, unsigned number, double fallback) {
  return p.is_9999(number) ? fallback : p.value(number);
}

const ModelRow& standard_motor(const SettingsSurroundings& s, double capacity_kw) {
  const ModelRow* best = s.model;
  for (const ModelRow& m : *s.models) {
    if (m.voltage_class_v != s.model->voltage_class_v) continue;
    if (std::abs(m.motor_kw - capacity_kw) < std::abs(best->motor_kw - capacity_kw)) best = &m;
  }
  return *best;
}

void set_vector_control(drive::DriveSettings& s, const ParameterStore& p, const ModelRow& standard) {
  s.base_voltage_v_rms = p.value(pr::kMotorVoltage);
  s.base_frequency_hz = p.value(pr::kMotorFrequency);
  s.cushion_pattern_base_hz = s.base_frequency_hz;
  s.torque_boost_percent = 0;
  s.load_pattern = drive::LoadPattern::kConstantTorque;
  s.stator_resistance_compensation_ohm = or_else(p, pr::kMotorR1, standard.standard_motor_r1_ohm);
  s.rated_slip_hz = s.base_frequency_hz * or_else(p, pr::kRatedSlip, standard.standard_motor_slip_percent) / 100;
  s.motor_slip_hz = s.base_frequency_hz * standard.standard_motor_slip_percent / 100;
}

double maximum_frequency_hz(const ParameterStore& p) {
  const double high_speed = p.value(pr::kHighSpeedMaximum);
  return high_speed > 120 ? high_speed : p.value(pr::kMaximumFrequency);
}

drive::DriveSettings common_settings(const ParameterStore& p, const SettingsSelection& selection,
                                     const SettingsSurroundings& around) {
  drive::DriveSettings s;
  s.rated_current_a_rms = around.model->rated_current_a_rms;
  s.nominal_dc_link_v = around.mains_v_rms * std::numbers::sqrt2;
  set_ramps(s, p, selection);
  set_frequencies(s, p, selection);
  set_voltage(s, p, selection, around);
  set_stall(s, p);
  set_protections(s, p, around);
  const StopSelection stop = stop_selection(p.value(pr::kStopSelection));
  s.stop_by_coasting = stop.coasting && !selection.jog;
  s.coast_delay_s = stop.coast_delay_s;
  const int carrier = p.integer(pr::kCarrier);
  s.carrier_hz = carrier == 0 ? 700 : carrier == 15 ? 14500 : carrier == 25 ? 2500 : carrier * 1000.0;
  return s;
}

}  // namespace vinv::inverter::mitsubishi
