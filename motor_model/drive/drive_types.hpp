// What goes into and comes out of the control core at each tick: effective settings, command, sensors, outputs.
// Physical values throughout; which parameter sets them is the family's personality (motor_model/inverter).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "motor_model/drive/vector_settings.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::drive {

enum class RampPattern : std::uint8_t { kLinear, kSCurveA, kSCurveB, kBacklash, kSCurveC, kSCurveD };
VINV_ENUM_RANGE(RampPattern, kLinear, kSCurveD);
// How a turning motor is caught: at the speed that it has, or at the frequency of before with the voltage rising.
enum class RestartMethod : std::uint8_t { kSearch, kReducedVoltage };
VINV_ENUM_RANGE(RestartMethod, kSearch, kReducedVoltage);
enum class LoadPattern : std::uint8_t { kConstantTorque, kVariableTorque, kHoistBoostForward, kHoistBoostReverse };
VINV_ENUM_RANGE(LoadPattern, kConstantTorque, kHoistBoostReverse);

// A point of an adjustable V/f law; line-to-line.
struct VfPoint {
  double frequency_hz = 0;
  double voltage_v_rms = 0;
  VINV_ARCHIVE(VfPoint, frequency_hz, voltage_v_rms);
};

struct FrequencyBand {
  double low_hz = 0;
  double high_hz = 0;  // jump band off when high <= low; the frequency that is taken instead is jump_to_hz
  double jump_to_hz = 0;
  VINV_ARCHIVE(FrequencyBand, low_hz, high_hz, jump_to_hz);
};

// Effective settings for this tick: the personality has already chosen between first and second functions and jog.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): the order is the reader's
struct DriveSettings {
  // ratings
  double rated_current_a_rms = 1.6;
  double nominal_dc_link_v = 566;
  double supply_voltage_v_rms = 400;
  // frequency limits
  double max_frequency_hz = 120;
  double min_frequency_hz = 0;
  double start_frequency_hz = 0.5;
  std::array<FrequencyBand, 3> jump_bands{};
  // ramps; 0 s is an immediate change where stall prevention does not watch it
  double acceleration_s = 5;
  double deceleration_s = 5;
  double ramp_reference_hz = 50;        // the times are from 0 to this frequency
  double cushion_pattern_base_hz = 50;  // base frequency of S-curve A
  RampPattern ramp_pattern = RampPattern::kLinear;
  double s_time_acceleration_s = 0;  // S-curve C: at each end of the ramp, D: at its start
  double s_time_deceleration_s = 0;
  double s_end_acceleration_s = 0;  // S-curve D: at the ramp's end
  double s_end_deceleration_s = 0;
  double backlash_up_hz = 0;  // backlash: the acceleration stops here ...
  double backlash_up_s = 0;   // ... for this long
  double backlash_down_hz = 0;
  double backlash_down_s = 0;
  double start_hold_s = 0;  // the output stays at the start frequency this long
  // V/f
  double base_frequency_hz = 50;
  double base_voltage_v_rms = 400;  // at and above base frequency
  double torque_boost_percent = 4;  // of base voltage at 0 Hz
  LoadPattern load_pattern = LoadPattern::kConstantTorque;
  std::array<VfPoint, 5> vf_points{};  // between 0 Hz and base frequency, rising
  std::uint32_t vf_point_count = 0;    // 0: the load pattern's shape
  double flux_factor = 1;  // with stator resistance compensation: of the V/f law's flux below base frequency
  double stator_resistance_compensation_ohm = 0;  // flux vector control: adds most of R * I to the voltage; 0: off
  // the motor as the drive takes it to be: how hard stall prevention acts, and how it tells driving from braking
  double motor_slip_hz = 2;     // at the motor's rated current
  double motor_stator_ohm = 0;  // per phase
  // slip compensation
  double rated_slip_hz = 0;              // 0: off
  double motor_rated_current_a_rms = 0;  // for slip compensation and electronic thermal; 0: rated_current
  double motor_no_load_current_a_rms = 0;
  double slip_response_s = 0.5;
  bool slip_in_constant_output = true;  // above base frequency too
  // droop
  double droop_hz = 0;  // lower output at the motor's rated torque current; 0: off
  double droop_filter_s = 0.3;
  bool droop_in_ramps = false;  // while accelerating and decelerating too
  // DC injection brake
  double dc_brake_frequency_hz = 3;
  double dc_brake_s = 0.5;              // 0: off
  double dc_brake_voltage_percent = 4;  // of base voltage; 0: off
  bool zero_speed_brake = false;        // in vector control: the speed is held at 0 instead
  // stall prevention (current)
  double stall_level_percent = 150;               // of rated current; 0: off
  double stall_level_double_speed_percent = 100;  // compensation factor (E500 Pr.23), see stall_level_percent()
  bool stall_compensated = false;                 // false: the level is the same at every frequency
  double stall_reduction_start_hz = 50;
  bool stall_in_acceleration = true;
  bool stall_at_constant = true;
  bool stall_in_deceleration = true;
  bool stall_trips_at_once = false;  // trips E.OLT as soon as OL would be signalled
  bool fast_current_limit = true;    // hardware limit just below the over-current level
  double dc_link_hold_v = 0;         // a deceleration waits above this DC link voltage; 0: off
  // shortest acceleration/deceleration
  bool shortest_acceleration = false;  // ramp as fast as the stall level (or the reference below) allows
  bool shortest_deceleration = false;
  bool shortest_watches_link = true;  // the deceleration slows down ahead of an over-voltage; not with a brake resistor
  double shortest_current_acceleration_a_rms = 0;
  double shortest_current_deceleration_a_rms = 0;
  // stop selection
  bool stop_by_coasting = false;
  double coast_delay_s = 0;  // from the stop command; the output goes on until then
  // protections
  double electronic_thermal_a_rms = 0;  // 0: off
  bool motor_forced_cooling = false;    // constant-torque motor: no derating at low speed
  bool second_motor = false;            // it is the one that runs, with a thermal state of its own
  bool motor_alarms_wait = false;       // electronic thermal and thermal relay are left to the personality
  double inverter_overload_start_percent = 110;
  double over_current_percent = 200;  // of rated current, instantaneous peak; for the plant's comparator
  double over_voltage_v = 800;
  double under_voltage_v = 345;
  double under_voltage_clear_v = 380;
  double stall_trip_frequency_hz = 0.5;  // E.OLT when pulled down to this ...
  double stall_trip_s = 3;               // ... for this long
  double heat_sink_trip_c = 95;
  bool output_phase_loss_protection = true;
  bool earth_fault_detection = true;  // tested when the output comes on
  // brake chopper
  bool chopper_fitted = true;
  double chopper_on_v = 740;
  double chopper_off_v = 725;
  double chopper_duty_percent = 3;  // permitted duty; the chopper is held off while it is used up
  // instantaneous power failure
  bool restart_enabled = false;
  double restart_coast_s = 0.5;  // wait after the power returns
  double restart_cushion_s = 1;  // voltage is raised over this time
  double power_failure_detect_s = 0.015;
  RestartMethod restart_method = RestartMethod::kSearch;
  bool restart_at_every_start = false;
  bool restart_finds_direction = true;       // else the search finds a motor that turns as commanded only
  double restart_first_cushion_s = 0;        // the voltage has by then ...
  double restart_first_voltage_percent = 0;  // ... this part of the V/f law's
  double restart_stall_level_percent = -1;   // until the set frequency is reached; below 0: stall_level_percent
  double restart_acceleration_s = -1;        // likewise; below 0: acceleration_s
  // detection outputs
  double up_to_frequency_percent = 10;  // of the set frequency
  double detect_forward_hz = 6;         // FU
  double detect_reverse_hz = 6;
  double current_detect_percent = 150;  // Y12
  double current_detect_s = 0;
  double zero_current_percent = 5;  // Y13
  double zero_current_s = 0.5;
  double current_detect_hold_s = 0.1;  // Y12 stays on at least this long; negative: until the next start
  // control of speed or torque; takes the place of V/f law, slip compensation and stall prevention
  VectorSettings vector;
  // carrier, for the loss model and the monitor
  double carrier_hz = 1000;
  VINV_ARCHIVE(DriveSettings, rated_current_a_rms, nominal_dc_link_v, supply_voltage_v_rms, max_frequency_hz,
               min_frequency_hz, start_frequency_hz, jump_bands, acceleration_s, deceleration_s, ramp_reference_hz,
               cushion_pattern_base_hz, ramp_pattern, s_time_acceleration_s, s_time_deceleration_s,
               s_end_acceleration_s, s_end_deceleration_s, backlash_up_hz, backlash_up_s, backlash_down_hz,
               backlash_down_s, start_hold_s, base_frequency_hz, base_voltage_v_rms, torque_boost_percent, load_pattern,
               vf_points, vf_point_count, flux_factor, stator_resistance_compensation_ohm, motor_slip_hz,
               motor_stator_ohm, rated_slip_hz, motor_rated_current_a_rms, motor_no_load_current_a_rms, slip_response_s,
               slip_in_constant_output, droop_hz, droop_filter_s, droop_in_ramps, dc_brake_frequency_hz, dc_brake_s,
               dc_brake_voltage_percent, zero_speed_brake, stall_level_percent, stall_level_double_speed_percent,
               stall_compensated, stall_reduction_start_hz, stall_in_acceleration, stall_at_constant,
               stall_in_deceleration, stall_trips_at_once, fast_current_limit, dc_link_hold_v, shortest_acceleration,
               shortest_deceleration, shortest_watches_link, shortest_current_acceleration_a_rms,
               shortest_current_deceleration_a_rms, stop_by_coasting, coast_delay_s, electronic_thermal_a_rms,
               motor_forced_cooling, second_motor, motor_alarms_wait, inverter_overload_start_percent,
               over_current_percent, over_voltage_v, under_voltage_v, under_voltage_clear_v, stall_trip_frequency_hz,
               stall_trip_s, heat_sink_trip_c, output_phase_loss_protection, earth_fault_detection, chopper_fitted,
               chopper_on_v, chopper_off_v, chopper_duty_percent, restart_enabled, restart_coast_s, restart_cushion_s,
               power_failure_detect_s, restart_method, restart_at_every_start, restart_finds_direction,
               restart_first_cushion_s, restart_first_voltage_percent, restart_stall_level_percent,
               restart_acceleration_s, up_to_frequency_percent, detect_forward_hz, detect_reverse_hz,
               current_detect_percent, current_detect_s, zero_current_percent, zero_current_s, current_detect_hold_s,
               vector, carrier_hz);
};

enum class RunDirection : std::int8_t { kReverse = -1, kStop = 0, kForward = 1 };
VINV_ENUM_RANGE(RunDirection, kReverse, kForward);

struct DriveCommand {
  RunDirection direction = RunDirection::kStop;
  double set_frequency_hz = 0;     // magnitude, before limits and jumps
  bool output_stop = false;        // MRS: output off at once, the motor coasts
  bool external_thermal = false;   // OH opened
  double torque_percent = 0;       // torque control: commanded, positive in the commanded direction
  double backward_limit_hz = -1;   // torque control: speed limit against that direction; negative: the same
  bool permit = true;              // false in start-up, reset and while a retry waits: no output
  bool pre_excite = false;         // vector control: flux and zero speed while there is no start
  bool catch_motor = false;        // an output that comes on meets a turning motor, as after a power failure
  double lower_by_hz = 0;          // takes the frequency down by this at once
  double raise_by_hz = 0;          // adds this to the output frequency, for this tick
  bool hold_deceleration = false;  // a deceleration waits
  bool link_overload = false;      // OL because the personality raises the frequency for the DC link's sake
  double voltage_factor = 1;       // of the V/f law's voltage
};

struct Sensors {
  double current_a_rms = 0;
  double current_peak_a = 0;
  double active_current_a_rms = 0;
  double dc_link_v = 0;
  double heat_sink_c = 25;
  bool control_power = true;
  bool chopper_on = false;
  bool chopper_failed = false;     // injected
  bool earth_fault = false;        // injected
  bool output_phase_open = false;  // injected
  // hardware comparators since the last tick
  bool over_current = false;
  bool over_voltage = false;
  bool under_voltage = false;
  double comparator_value = 0;  // A peak or V at the event
  Duration comparator_after{};  // since the last tick
  // from a speed search of the personality (restart after power failure without a sensor): electrical, Hz
  double rotor_frequency_hz = 0;
  // from its estimator of vector control: air gap, signed
  double torque_nm = 0;
};

enum class RunState : std::uint8_t {
  kStopped,
  kAccelerating,
  kConstant,
  kDecelerating,
  kDcBraking,
  kCoastDelay,
  kPowerFailure,
  kRestartWait,
  kTripped,
};
VINV_ENUM_RANGE(RunState, kStopped, kTripped);

// What a trip is in physics; the family names it (families/*/alarms.csv).
enum class TripKind : std::uint8_t {
  kOverCurrentAcceleration,
  kOverCurrentConstant,
  kOverCurrentDeceleration,
  kOverVoltageAcceleration,
  kOverVoltageConstant,
  kOverVoltageDeceleration,
  kInverterOverload,
  kMotorOverload,
  kHeatSink,
  kStallPrevention,
  kBrakeTransistor,
  kEarthFault,
  kOutputPhaseLoss,
  kExternalThermal,
};
VINV_ENUM_RANGE(TripKind, kOverCurrentAcceleration, kExternalThermal);

// The cause chain that reports show: what was measured against which level, in which state.
struct Trip {
  TripKind kind{};
  Duration after{};  // since the start of the tick in which it happened
  double value = 0;  // A, V, degC or accumulated fraction
  double level = 0;
  RunState state{};
  double output_frequency_hz = 0;
  VINV_ARCHIVE(Trip, kind, after, value, level, state, output_frequency_hz);
};

struct DriveOutputs {
  // to the stage
  bool gates_on = false;
  double stage_frequency_hz = 0;  // signed
  double stage_voltage_peak_v = 0;
  bool chopper_enabled = false;
  // status
  RunState state = RunState::kStopped;
  bool running = false;            // RUN
  double output_frequency_hz = 0;  // signed, compensated; what the monitor shows is its magnitude
  double ramp_frequency_hz = 0;    // signed, generator output
  bool up_to_frequency = false;
  bool overload = false;              // OL
  bool link_overload = false;         // likewise, because of the DC link
  bool power_failure = false;         // IPF
  bool frequency_detected = false;    // FU
  bool current_detected = false;      // Y12
  bool zero_current = false;          // Y13
  bool thermal_pre_alarm = false;     // TH at 85 %
  double motor_thermal_fraction = 0;  // of trip
  double inverter_thermal_fraction = 0;
  double brake_duty_fraction = 0;  // of the permitted duty
  // control of speed or torque
  double torque_command_percent = 0;  // signed
  bool torque_limited = false;
  bool speed_limited = false;
  std::optional<Trip> trip;  // new in this tick
  VINV_ARCHIVE(DriveOutputs, gates_on, stage_frequency_hz, stage_voltage_peak_v, chopper_enabled, state, running,
               output_frequency_hz, ramp_frequency_hz, up_to_frequency, overload, link_overload, power_failure,
               frequency_detected, current_detected, zero_current, thermal_pre_alarm, motor_thermal_fraction,
               inverter_thermal_fraction, brake_duty_fraction, torque_command_percent, torque_limited, speed_limited,
               trip);
};

}  // namespace vinv::drive
