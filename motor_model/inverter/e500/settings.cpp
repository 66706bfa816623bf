#include "motor_model/inverter/e500/settings.hpp"

#include "motor_model/inverter/e500/parameter_numbers.hpp"

namespace vinv::inverter::e500 {
namespace {

using mitsubishi::or_else;
using mitsubishi::SettingsSelection;
using mitsubishi::SettingsSurroundings;

void set_pattern(drive::DriveSettings& s, const ParameterStore& p, const SettingsSelection& selection) {
  switch (p.integer(pr::kPattern)) {
    case 1: s.ramp_pattern = drive::RampPattern::kSCurveA; break;
    case 2: s.ramp_pattern = drive::RampPattern::kSCurveB; break;
    default: s.ramp_pattern = drive::RampPattern::kLinear;
  }
  // Pr.60: 1 and 2 without, 11 and 12 with brake resistor; 2 and 12 allow more current.
  const int mode = p.integer(pr::kShortestMode);
  if (mode != 0 && !selection.jog) {
    const double reference = or_else(p, pr::kShortestReference, s.rated_current_a_rms);
    const double percent = mode % 10 == 2 ? 180 : 150;
    s.shortest_acceleration = s.shortest_deceleration = true;
    s.shortest_watches_link = mode < 10;
    s.shortest_current_acceleration_a_rms = reference * or_else(p, pr::kShortestAcceleration, percent) / 100;
    s.shortest_current_deceleration_a_rms = reference * or_else(p, pr::kShortestDeceleration, percent) / 100;
  }
}

}  // namespace

drive::DriveSettings make_settings(const ParameterStore& p, const SettingsSelection& selection,
                                   const SettingsSurroundings& around) {
  drive::DriveSettings s = mitsubishi::common_settings(p, selection, around);
  set_pattern(s, p, selection);
  if (!p.is_9999(pr::kMotorCapacity) && !selection.vf_by_x18) {
    mitsubishi::set_vector_control(s, p, mitsubishi::standard_motor(around, p.value(pr::kMotorCapacity)));
  }
  if (selection.second) s.electronic_thermal_a_rms = or_else(p, pr::kSecondThermal, s.electronic_thermal_a_rms);
  // Pr.71: 1 and 13-16 are constant-torque motors; 100 and above switch to one with signal RT.
  const int motor = p.integer(pr::kAppliedMotor);
  const int kind = motor % 100;
  s.motor_forced_cooling = kind == 1 || (kind >= 13 && kind <= 16) || (motor >= 100 && selection.second);
  s.earth_fault_detection = around.model->voltage_class_v >= 400 || p.integer(pr::kEarthFaultAtStart) == 1;
  if (p.integer(pr::kRegenerative) == 1) s.chopper_duty_percent = p.value(pr::kBrakeDuty);
  return s;
}

}  // namespace vinv::inverter::e500
