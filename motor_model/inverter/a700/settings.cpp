// FR-A700 parameters to drive::DriveSettings, beyond what the families share. Typical for the family.
#include <algorithm>
#include <cmath>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

using mitsubishi::or_else;
using mitsubishi::SettingsSelection;

// SettingsSelection::variant: bits.
enum Variant : std::uint32_t {
  kRestartOff = 1,      // CS is assigned and off
  kBoostForward = 2,    // X17 with Pr.14 = 4 and 5
  kSecondSPattern = 8,  // X20
  kHeldByX13 = 4,       // Pr.11 = 8888 and X13 on
  kFailureStop = 16,    // deceleration at a power failure ...
  kFailureSlow = 32,    // ... below Pr.266
  kContact = 64,        // stop-on-contact ...
  kContactSlow = 128,   // ... at low output frequency
};

void set_second_and_third(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  if (selection.second) {
    s.electronic_thermal_a_rms = or_else(p, pr::kSecondThermal, s.electronic_thermal_a_rms);
    // Pr.49: 0 leaves the first level in force, 9999 switches at every frequency.
    if (p.value(pr::kSecondStallFrequency) != 0) s.stall_level_percent = p.value(pr::kSecondStallLevel);
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
  if (p.value(pr::kThirdStallFrequency) != 0) s.stall_level_percent = p.value(pr::kThirdStallLevel);
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
      const unsigned up = (selection.variant & kSecondSPattern) != 0 ? pr::kSPattern2Up : pr::kSPattern1Up;
      s.ramp_pattern = drive::RampPattern::kSCurveC;
      s.s_time_acceleration_s = s.acceleration_s * p.value(up) / 100;
      s.s_time_deceleration_s = s.deceleration_s * p.value(up + 1) / 100;
      break;
    }
    default: s.ramp_pattern = drive::RampPattern::kLinear;
  }
}

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
  const bool reflected = store_.integer(155) == 0 || core_.outputs().state == drive::RunState::kConstant;
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
  return s;
}

bool A700Inverter::vector_control() const {
  return !store_.is_9999(pr::kMotorCapacity) && !store_.is_9999(pr::kMotorPoles) && !settings_selection_.vf_by_x18;
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
  set_second_and_third(s, p, selection);
  const bool vector = !p.is_9999(pr::kMotorCapacity) && !p.is_9999(pr::kMotorPoles) && !selection.vf_by_x18;
  if (vector) {
    mitsubishi::set_vector_control(s, p, mitsubishi::standard_motor(surroundings(), p.value(pr::kMotorCapacity)));
    s.droop_hz = s.base_frequency_hz * p.value(pr::kDroopGain) / 100;
    s.droop_filter_s = p.value(pr::kDroopFilter);
    s.droop_in_ramps = p.integer(pr::kDroopActivation) % 10 != 0;
  } else {
    set_vf_points(s, p);
  }
  if (!p.is_9999(pr::kHoldTime)) s.start_hold_s = p.value(pr::kHoldTime);
  // Pr.71: 1, 4, 13-18, 23, 33, 43 and 53 are constant-torque motors.
  const int motor = p.integer(pr::kAppliedMotor);
  s.motor_forced_cooling = motor == 1 || motor == 4 || (motor >= 13 && motor <= 18) || motor == 23 || motor == 33 ||
                           motor == 43 || motor == 53;
  // Pr.10: 9999 brakes from the starting frequency on.
  if (p.is_9999(pr::kDcBrakeFrequency)) s.dc_brake_frequency_hz = p.value(pr::kStartingFrequency);
  // Pr.11 = 8888: as long as X13 is on.
  if (p.value(pr::kDcBrakeTime) == 8888) s.dc_brake_s = (selection.variant & kHeldByX13) != 0 ? 1e9 : 0;
  s.earth_fault_detection = true;
  if (p.integer(pr::kRegenerative) % 10 == 1) s.chopper_duty_percent = p.value(pr::kBrakeDuty);
  if ((selection.variant & kRestartOff) != 0) s.restart_enabled = false;
  set_restart(s, p);
  if ((selection.variant & kFailureStop) != 0) set_failure_stop(s, p, (selection.variant & kFailureSlow) != 0);
  if ((selection.variant & kContact) != 0) set_contact(s, p, (selection.variant & kContactSlow) != 0);
  return s;
}

}  // namespace vinv::inverter::a700
