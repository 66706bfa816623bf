// FR-A700 parameters to drive::DriveSettings, beyond what the families share. Typical for the family.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/motor_settings.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

using mitsubishi::or_else;
using mitsubishi::SettingsSelection;

void set_second_and_third(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  if (selection.second) {
    s.electronic_thermal_a_rms = or_else(p, pr::kSecondThermal, s.electronic_thermal_a_rms);
    // Pr.49: 0 leaves the first level in force; up to this frequency the second one holds, 9999 at every frequency.
    if (p.value(pr::kSecondStallFrequency) != 0 && (selection.variant & kAboveSecondStall) == 0) {
      s.stall_level_percent = p.value(pr::kSecondStallLevel);
    }
  }
  if (!selection.third) return;
  // Pr.110 and Pr.112 to Pr.114: 9999 leaves the third function without effect.
  if (!p.is_9999(pr::kThirdRamp) && !selection.jog) {
    s.acceleration_s = p.value(pr::kThirdRamp);
    s.deceleration_s = or_else(p, pr::kThirdDeceleration, s.acceleration_s);
  }
  s.torque_boost_percent = or_else(p, pr::kThirdBoost, s.torque_boost_percent);
  if (!p.is_9999(pr::kThirdBaseFrequency)) {
    s.base_frequency_hz = s.cushion_pattern_base_hz = p.value(pr::kThirdBaseFrequency);
  }
  if (p.value(pr::kThirdStallFrequency) != 0 && (selection.variant & kAboveThirdStall) == 0)
    s.stall_level_percent = p.value(pr::kThirdStallLevel);
}

void set_pattern(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  switch (p.integer(pr::kPattern)) {
    case 1: s.ramp_pattern = drive::RampPattern::kSCurveA; break;
    case 2: s.ramp_pattern = drive::RampPattern::kSCurveB; break;
    case 3:
      s.ramp_pattern = drive::RampPattern::kBacklash;
      s.backlash_up_hz = p.value(pr::kBacklashUpFrequency);
      s.backlash_up_s = p.value(pr::kBacklashUpTime);
      s.backlash_down_hz = p.value(pr::kBacklashDownFrequency);
      s.backlash_down_s = p.value(pr::kBacklashDownTime);
      break;
    case 4: {
      // X20 chooses the second pair.
      const bool second = (selection.variant & kSecondSPattern) != 0;
      s.ramp_pattern = drive::RampPattern::kSCurveC;
      s.s_time_acceleration_s = s.acceleration_s * p.value(second ? pr::kSPattern2Up : pr::kSPattern1Up) / 100;
      s.s_time_deceleration_s = s.deceleration_s * p.value(second ? pr::kSPattern2Down : pr::kSPattern1Down) / 100;
      break;
    }
    case 5:
      s.ramp_pattern = drive::RampPattern::kSCurveD;
      s.s_time_acceleration_s = p.value(pr::kSPatternBeginUp);
      s.s_end_acceleration_s = p.value(pr::kSPatternEndUp);
      s.s_time_deceleration_s = p.value(pr::kSPatternBeginDown);
      s.s_end_deceleration_s = p.value(pr::kSPatternEndDown);
      break;
    default: s.ramp_pattern = drive::RampPattern::kLinear;
  }
}

// Pr.292: 1 and 11 the shortest ramps, without and with a brake resistor; 3 ramps within the rated current. Pr.293
// keeps one of the two set times, Pr.61 to 63 change the reference.
void set_automatic(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  const int mode = p.integer(pr::kAutomaticAcceleration);
  if ((mode != 1 && mode != 3 && mode != 11) || selection.jog || s.vector.on) return;
  const double reference = or_else(p, pr::kReferenceCurrent, s.rated_current_a_rms);
  const double percent = mode == 3 ? 100 : 150;
  const int only = p.integer(pr::kAutomaticSeparate);
  s.shortest_acceleration = only != 2;
  s.shortest_deceleration = only != 1;
  s.shortest_watches_link = mode != 11;
  s.shortest_current_acceleration_a_rms = reference * or_else(p, pr::kReferenceAcceleration, percent) / 100;
  s.shortest_current_deceleration_a_rms = reference * or_else(p, pr::kReferenceDeceleration, percent) / 100;
}

// Pr.292 = 5 and 6: elevator mode, of which the starting frequency and the stall level are here.
void set_elevator(drive::DriveSettings& s, const ParameterStore& p) {
  const int mode = p.integer(pr::kAutomaticAcceleration);
  if ((mode != 5 && mode != 6) || s.vector.on) return;
  s.start_frequency_hz = or_else(p, pr::kElevatorStart, 2);
  const double reference = or_else(p, pr::kReferenceCurrent, s.rated_current_a_rms) / s.rated_current_a_rms;
  s.stall_level_percent = reference * or_else(p, pr::kReferenceAcceleration, mode == 5 ? 150 : 180);
}

constexpr double kLinkHold = 0.95;  // of the over-voltage level: where the factory sets Pr.883

bool around_400v(const mitsubishi::SettingsSurroundings& s) { return s.model->voltage_class_v >= 400; }

// Pr.71 = 2 with Pr.19 set: Pr.100 to Pr.109. Not in vector control.
void set_vf_points(drive::DriveSettings& s, const ParameterStore& p) {
  if (p.integer(pr::kAppliedMotor) != 2 || p.value(pr::kBaseVoltage) >= 8888) return;
  for (unsigned i = 0; i < s.vf_points.size(); ++i) {
    const unsigned frequency = pr::kVf1Frequency + 2 * i;
    if (!p.is_9999(frequency)) s.vf_points[s.vf_point_count++] = {p.value(frequency), p.value(frequency + 1)};
  }
  std::sort(s.vf_points.begin(), s.vf_points.begin() + s.vf_point_count,
            [](const drive::VfPoint& a, const drive::VfPoint& b) { return a.frequency_hz < b.frequency_hz; });
}

// Pr.57, 58, 162 to 165, 299 and 611. Without an encoder 2 and 12 are 0 and 10.
void set_restart(drive::DriveSettings& s, const ParameterStore& p) {
  const int selection = p.integer(pr::kRestartSelection);
  s.restart_method = selection % 10 == 1 ? drive::RestartMethod::kReducedVoltage : drive::RestartMethod::kSearch;
  s.restart_at_every_start = selection >= 10 && s.restart_enabled;
  s.restart_finds_direction =
      p.is_9999(pr::kRestartDirection) ? p.integer(pr::kReversePrevention) == 0 : p.integer(pr::kRestartDirection) == 1;
  s.restart_first_cushion_s = p.value(pr::kFirstCushionTime);
  s.restart_first_voltage_percent = p.value(pr::kFirstCushionVoltage);
  s.restart_stall_level_percent = p.value(pr::kRestartStallLevel);
  s.restart_acceleration_s = or_else(p, pr::kRestartAcceleration, -1);
}

// Pr.264 to Pr.266.
void set_failure_stop(drive::DriveSettings& s, const ParameterStore& p, bool slow) {
  const double first_s = p.value(pr::kFailureDeceleration1);
  s.deceleration_s = slow ? or_else(p, pr::kFailureDeceleration2, first_s) : first_s;
  s.ramp_pattern = drive::RampPattern::kLinear;
  s.shortest_deceleration = false;
  s.stop_by_coasting = false;
}

// Pr.48, 275 and 276.
void set_contact(drive::DriveSettings& s, const ParameterStore& p, bool slow) {
  s.stall_level_percent = p.value(pr::kSecondStallLevel);
  s.fast_current_limit = false;
  s.flux_factor = or_else(p, pr::kContactExcitation, 100) / 100;
  if (!slow || p.is_9999(pr::kContactCarrier)) return;
  const double khz = p.value(pr::kContactCarrier);
  s.carrier_hz = khz == 0 ? 700 : khz * 1000;
}

constexpr double kContactCarrier_hz = 3;  // output frequency up to which Pr.276 holds

}  // namespace

SettingsSelection A700Inverter::selection(const mitsubishi::Inputs& in) const {
  const bool jog = jogging();
  // Pr.155 = 10: RT and X9 act only at constant speed.
  const bool reflected = store_.integer(pr::kReflectionTime) == 0 || core_.outputs().state == drive::RunState::kConstant;
  SettingsSelection s{.second = in.signals.has(InputSignal::kRt) && !jog,
                      .third = in.signals.has(InputSignal::kX9) && !jog,
                      .jog = jog,
                      .vf_by_x18 = in.signals.has(InputSignal::kX18)};
  if (!reflected) {
    s.second = settings_selection_.second;
    s.third = settings_selection_.third;
  }
  // With the switch-over to the commercial supply CS has another meaning.
  if (has_function(InputSignal::kCs) && !in.signals.has(InputSignal::kCs) && !drives_contactors()) {
    s.variant |= kRestartOff;
  }
  const double output_hz = std::abs(core_.outputs().output_frequency_hz);
  if (s_.supply.failure_stop.active()) {
    s.variant |= kFailureStop;
    if (output_hz < store_.value(pr::kFailureSwitchover)) s.variant |= kFailureSlow;
  }
  if (!jog && on_contact(in.signals)) {
    s.variant |= kContact;
    if (output_hz <= kContactCarrier_hz) s.variant |= kContactSlow;
  }
  if (in.signals.has(InputSignal::kX17)) s.variant |= kBoostForward;
  if (in.signals.has(InputSignal::kX13)) s.variant |= kHeldByX13;
  if (in.signals.has(InputSignal::kX20)) s.variant |= kSecondSPattern;
  if (s_.second_motor) s.variant |= kSecondMotor;
  if (in.signals.has(InputSignal::kMc)) s.variant |= kTorqueByMc;
  const double hz = std::abs(core_.outputs().output_frequency_hz);
  const auto above = [&](unsigned number) { return !store_.is_9999(number) && hz > store_.value(number); };
  if (above(pr::kRampSwitchFrequency)) s.variant |= kAboveSwitch;
  if (above(pr::kSecondStallFrequency)) s.variant |= kAboveSecondStall;
  if (above(pr::kThirdStallFrequency)) s.variant |= kAboveThirdStall;
  return s;
}

bool A700Inverter::vector_control() const {
  return control_method(store_, motor_selection(settings_selection_)) != ControlMethod::kVf;
}

drive::DriveSettings A700Inverter::make_settings(const SettingsSelection& selection) const {
  const ParameterStore& p = store_;
  drive::DriveSettings s = mitsubishi::common_settings(p, selection, surroundings());
  set_pattern(s, p, selection);
  // Pr.14 = 4 and 5: X17 on is constant torque, off boosts one direction.
  const int pattern = p.integer(pr::kLoadPattern);
  if (pattern >= 4 && (selection.variant & kBoostForward) == 0) {
    s.load_pattern = pattern == 4 ? drive::LoadPattern::kHoistBoostForward : drive::LoadPattern::kHoistBoostReverse;
  }
  // Pr.147: above it the second ramp times hold.
  if ((selection.variant & kAboveSwitch) != 0 && !selection.second && !selection.third && !selection.jog) {
    s.acceleration_s = p.value(pr::kSecondRamp);
    s.deceleration_s = or_else(p, pr::kSecondDeceleration, s.acceleration_s);
  }
  set_second_and_third(s, p, selection);
  const MotorSelection motor = motor_selection(selection);
  const plant::MachineParameters& machine = plant_.config().machine;
  // What the drive knows of its motor's inertia.
  const double shaft_rad_s = machine.rated_speed_rpm * std::numbers::pi / 30;
  const double start_s = machine.inertia_kg_m2 * shaft_rad_s * shaft_rad_s / std::max(machine.rated_power_w, 1.0);
  set_motor(s, p, motor, surroundings(), start_s);
  if (control_method(p, motor) == ControlMethod::kVf) {
    set_vf_points(s, p);
  } else {
    s.droop_hz = s.base_frequency_hz * p.value(pr::kDroopGain) / 100;
    s.droop_filter_s = p.value(pr::kDroopFilter);
    s.droop_in_ramps = p.integer(pr::kDroopActivation) % 10 != 0;
  }
  set_automatic(s, p, selection);
  set_elevator(s, p);
  if (!p.is_9999(pr::kHoldTime)) s.start_hold_s = p.value(pr::kHoldTime);
  // Pr.10: 9999 brakes from the starting frequency on.
  if (p.is_9999(pr::kDcBrakeFrequency)) s.dc_brake_frequency_hz = p.value(pr::kStartingFrequency);
  // Pr.11 = 8888: as long as X13 is on.
  if (p.value(pr::kDcBrakeTime) == 8888) s.dc_brake_s = (selection.variant & kHeldByX13) != 0 ? 1e9 : 0;
  s.earth_fault_detection = true;
  s.current_detect_hold_s = or_else(p, pr::kCurrentDetectionHold, -1);
  s.motor_alarms_wait = p.integer(pr::kFaultDefinition) == 1;
  if (!p.is_9999(pr::kUndervoltageLevel) && around_400v(surroundings())) {
    s.under_voltage_v = p.value(pr::kUndervoltageLevel);
    s.under_voltage_clear_v = std::max(s.under_voltage_clear_v, s.under_voltage_v);
  }
  // Vector control knows four carriers.
  if (s.vector.on) {
    const int carrier = p.integer(pr::kCarrier);
    s.carrier_hz = carrier <= 5 ? 2000 : carrier <= 9 ? 6000 : carrier <= 13 ? 10000 : 14000;
  }
  if (p.integer(pr::kRegenerative) % 10 == 1) s.chopper_duty_percent = p.value(pr::kBrakeDuty);
  if ((selection.variant & kRestartOff) != 0) s.restart_enabled = false;
  if (s.stall_in_deceleration) s.dc_link_hold_v = kLinkHold * s.over_voltage_v;
  set_restart(s, p);
  if ((selection.variant & kFailureStop) != 0) set_failure_stop(s, p, (selection.variant & kFailureSlow) != 0);
  if ((selection.variant & kContact) != 0) set_contact(s, p, (selection.variant & kContactSlow) != 0);
  return s;
}

}  // namespace vinv::inverter::a700
