#include "motor_model/drive/drive_core.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "motor_model/drive/frequency_limits.hpp"
#include "motor_model/drive/vf_curve.hpp"

namespace vinv::drive {
namespace {

// Lag of the current in the stator resistance compensation: keeps its positive feedback slow.
constexpr double kCompensationLag_s = 0.05;

double sign_of(RunDirection direction) { return static_cast<double>(direction); }

RampTimes ramp_times(const DriveSettings& s) {
  return {s.acceleration_s,      s.deceleration_s,        s.ramp_reference_hz,     s.cushion_pattern_base_hz,
          s.ramp_pattern,        s.s_time_acceleration_s, s.s_time_deceleration_s, s.backlash_up_hz,
          s.backlash_up_s,       s.backlash_down_hz,      s.backlash_down_s,       s.s_end_acceleration_s,
          s.s_end_deceleration_s};
}

// Stall prevention needs ramps that take time.
RampTimes watched(RampTimes times, const DriveSettings& s, bool stalled_at_constant) {
  const double least_s = times.reference_hz / kSteepestWatched_hz_s;
  const bool on = s.stall_level_percent > 0;
  if (on && (s.stall_in_acceleration || stalled_at_constant)) {
    times.acceleration_s = std::max(times.acceleration_s, least_s);
  }
  if (on && (s.stall_in_deceleration || s.stall_at_constant)) {
    times.deceleration_s = std::max(times.deceleration_s, least_s);
  }
  return times;
}

DriveSettings settings_of_restart(DriveSettings s) {
  if (s.restart_stall_level_percent >= 0) s.stall_level_percent = s.restart_stall_level_percent;
  if (s.restart_acceleration_s >= 0) s.acceleration_s = s.restart_acceleration_s;
  return s;
}

}  // namespace

struct DriveCore::Tick {
  double dt_s;
  const DriveSettings& settings;
  const DriveCommand& command;
  const Sensors& sensors;
  double reference_hz;          // magnitude after jumps and limits; 0 where it is below the start frequency
  bool wanted;                  // the command asks for rotation
  double torque_current_a_rms;  // negative while the motor brakes

  bool pre_excited() const { return command.pre_excite && settings.vector.on; }
};

bool DriveCore::output_on() const {
  switch (state_) {
    case RunState::kAccelerating:
    case RunState::kConstant:
    case RunState::kDecelerating:
    case RunState::kDcBraking:
    case RunState::kCoastDelay: return true;
    case RunState::kStopped:
    case RunState::kPowerFailure:
    case RunState::kRestartWait:
    case RunState::kTripped: break;
  }
  return false;
}

void DriveCore::output_off(RunState state) {
  state_ = state;
  ramp_.set(0);
  stall_.release();
  shortest_.release();
  slip_.clear();
  droop_.clear();
  vector_.reset();
  start_hold_left_s_ = 0;
  current_limit_.clear();
  compensation_current_.set(0);
  coast_delay_.clear();
  cushion_.end();
  power_failure_.end();
  stalled_at_constant_ = false;
  catching_ = false;
  overload_ = link_overload_ = false;
}

void DriveCore::reset(Accumulators accumulators) {
  if (state_ == RunState::kTripped) output_off(RunState::kStopped);
  if (accumulators == Accumulators::kClear) {
    protections_.clear_accumulators();
    brake_duty_.clear();
  }
  out_.state = state_;
  out_.trip.reset();
}

void DriveCore::force_trip() {
  output_off(RunState::kTripped);
  out_.gates_on = false;
  out_.stage_frequency_hz = 0;
  out_.stage_voltage_peak_v = 0;
  out_.state = state_;
  out_.running = false;
  out_.output_frequency_hz = 0;
  out_.ramp_frequency_hz = 0;
  out_.up_to_frequency = false;
  out_.overload = out_.link_overload = false;
  out_.power_failure = false;
  out_.frequency_detected = false;
}

void DriveCore::trip(const Trip& cause) {
  output_off(RunState::kTripped);
  out_.trip = cause;
}

const DriveOutputs& DriveCore::tick(Duration period, const DriveSettings& settings, const DriveCommand& command,
                                    const Sensors& sensors) {
  const OutputSample output{sensors.current_a_rms, sensors.active_current_a_rms,
                            out_.stage_voltage_peak_v / std::numbers::sqrt2};
  const double limited = limited_reference_hz(settings, command.set_frequency_hz);
  const double reference = limited >= settings.start_frequency_hz ? limited : 0;
  const Tick t{std::max(to_seconds(period), 0.0),
               settings,
               command,
               sensors,
               reference,
               command.direction != RunDirection::kStop && reference > 0,
               torque_current_a_rms(output, settings.motor_stator_ohm)};

  out_.trip.reset();
  link_.observe(settings, sensors);
  stall_.observe(t.dt_s, settings, {output, current_limit_.factor()});
  compensation_current_.step(t.dt_s, kCompensationLag_s, sensors.current_a_rms);
  brake_duty_.step(t.dt_s, sensors.chopper_on, settings.chopper_duty_percent);
  const Protections::Situation before{state_, output_on(), out_.output_frequency_hz};
  protections_.observe(t.dt_s, settings, sensors, before);

  if (state_ != RunState::kTripped) {
    if (!sensors.control_power || !command.permit) {
      // Nothing is judged here: a cause that is still there when the permit returns trips then.
      output_off(RunState::kStopped);
    } else if (const auto cause = protections_.check(t.dt_s, settings, command, sensors, before)) {
      trip(*cause);
    } else {
      stop_or_run(t);
    }
  }
  set_stage(t);
  publish(t);
  return out_;
}

void DriveCore::stop_or_run(const Tick& t) {
  if (state_ == RunState::kPowerFailure || state_ == RunState::kRestartWait) {
    supply_failed(t);
    return;
  }
  if (output_on() && link_.low()) {
    state_before_dip_ = state_;
    state_ = RunState::kPowerFailure;
    power_failure_.begin();
    supply_failed(t);
    return;
  }
  if (t.command.output_stop) {
    output_off(RunState::kStopped);
    return;
  }
  const bool start_on = t.command.direction != RunDirection::kStop;
  switch (state_) {
    case RunState::kStopped:
      if (link_.low()) return;
      if (t.wanted)
        start(t);
      else if (t.pre_excited())
        begin_brake(t);
      return;
    case RunState::kDcBraking:
      if (t.wanted)
        start(t);
      else
        brake(t);
      return;
    case RunState::kCoastDelay:
      if (start_on) break;
      if (!t.settings.stop_by_coasting || coast_delay_.step(t.dt_s, true, t.settings.coast_delay_s)) {
        output_off(RunState::kStopped);
      }
      return;
    default: break;
  }
  coast_delay_.clear();
  if (!start_on && t.settings.stop_by_coasting) {
    // The output goes on at the frequency it has; a start within the delay takes it on from there.
    state_ = RunState::kCoastDelay;
    overload_ = link_overload_ = false;
    if (coast_delay_.step(t.dt_s, true, t.settings.coast_delay_s)) output_off(RunState::kStopped);
    return;
  }
  run_ramp(t, t.wanted ? sign_of(t.command.direction) * t.reference_hz : 0);
}

// The output comes on at the start frequency.
void DriveCore::start(const Tick& t) {
  const VectorControl excited = vector_;  // the flux of zero speed is kept
  output_off(RunState::kAccelerating);
  vector_ = excited;
  const double target = sign_of(t.command.direction) * t.reference_hz;
  ramp_.set(std::copysign(std::min(t.settings.start_frequency_hz, t.reference_hz), target));
  if (ramp_.motion_towards(target) == Motion::kConstant) state_ = RunState::kConstant;
  start_hold_left_s_ = t.settings.start_hold_s;
  protections_.begin_output();
  if (t.settings.earth_fault_detection && t.sensors.earth_fault) {
    trip({TripKind::kEarthFault, {}, 1, 0, state_, ramp_.frequency_hz()});
    return;
  }
  if (t.settings.restart_at_every_start || t.command.catch_motor) catch_motor(t, 0);
}

// The output has come on at the start frequency; it goes on from where the motor is.
void DriveCore::catch_motor(const Tick& t, double before_hz) {
  const DriveSettings& s = t.settings;
  double from_hz = s.restart_method == RestartMethod::kSearch ? t.sensors.rotor_frequency_hz : before_hz;
  if (!s.restart_finds_direction && from_hz * sign_of(t.command.direction) < 0) from_hz = 0;
  from_hz = std::clamp(from_hz, -s.max_frequency_hz, s.max_frequency_hz);
  if (std::abs(from_hz) > s.start_frequency_hz) ramp_.set(from_hz);
  catching_ = true;
  cushion_.begin();
}

Motion DriveCore::motion(double target_hz) const {
  const Motion m = ramp_.motion_towards(target_hz);
  return m == Motion::kAccelerating && stalled_at_constant_ ? Motion::kConstant : m;
}

void DriveCore::run_ramp(const Tick& t, double target_hz) {
  std::optional<DriveSettings> of_restart;
  if (catching_) of_restart = settings_of_restart(t.settings);
  const DriveSettings& s = of_restart ? *of_restart : t.settings;
  if (t.command.lower_by_hz > 0) ramp_.lower(t.command.lower_by_hz, s.start_frequency_hz);
  const Motion now = motion(target_hz);  // apart from stall prevention
  const double magnitude = std::abs(ramp_.frequency_hz());
  const double level_a_rms = stall_level_percent(s, magnitude) / 100 * s.rated_current_a_rms;
  const RampTimes times = shortest_.step(t.dt_s, s, watched(ramp_times(s), s, stalled_at_constant_), now,
                                         stall_.filtered_current_a_rms(), t.sensors.dc_link_v, level_a_rms);
  const bool arrived = ramp_.motion_towards(target_hz) == Motion::kConstant;
  const auto stall = stall_.step(t.dt_s, s,
                                 {now, magnitude, arrived ? 0 : acceleration_rate_hz_s(times),
                                  deceleration_rate_hz_s(times), t.sensors.dc_link_v});
  link_overload_ = stall.link_high || t.command.link_overload;
  overload_ = stall.active || link_overload_;
  if (stall.trip) {
    const RunState state = now == Motion::kAccelerating ? RunState::kAccelerating
                           : now == Motion::kConstant   ? RunState::kConstant
                                                        : RunState::kDecelerating;
    trip({TripKind::kStallPrevention,
          {},
          stall_.filtered_current_a_rms(),
          stall.level_a_rms,
          state,
          out_.output_frequency_hz});
    return;
  }
  if (now == Motion::kConstant && stall.most_hz_s < 0) stalled_at_constant_ = true;
  if (stall.most_hz_s < 0) {
    ramp_.lower(-stall.most_hz_s * t.dt_s, s.stall_trip_frequency_hz);
  } else if (start_hold_left_s_ > 0 && now == Motion::kAccelerating) {
    start_hold_left_s_ -= t.dt_s;
  } else if (!(cushion_.rising() && now == Motion::kAccelerating) &&
             !(t.command.hold_deceleration && now == Motion::kDecelerating)) {
    // While a restart catches the motor the frequency stays where the motor is.
    ramp_.step_at_most(t.dt_s, target_hz, times, stall.most_hz_s);
  }

  const double f = ramp_.frequency_hz();
  if (now == Motion::kDecelerating) {
    if (target_hz * f < 0 || (target_hz != 0 && f == 0)) {
      // Reversal: below the start frequency there is no output, so it goes on from the other side.
      if (std::abs(f) <= s.start_frequency_hz) {
        ramp_.set(std::copysign(std::min(s.start_frequency_hz, std::abs(target_hz)), target_hz));
      }
    } else if (target_hz == 0 && std::abs(f) <= DcBrake::begins_at_hz(s)) {
      if (DcBrake::fitted(s) || t.pre_excited()) {
        begin_brake(t);
      } else {
        output_off(RunState::kStopped);
      }
      return;
    }
  }
  if (ramp_.motion_towards(target_hz) != Motion::kAccelerating) stalled_at_constant_ = false;
  switch (motion(target_hz)) {
    case Motion::kAccelerating: state_ = RunState::kAccelerating; break;
    case Motion::kConstant: state_ = RunState::kConstant; break;
    case Motion::kDecelerating: state_ = RunState::kDecelerating; break;
  }
  if (state_ == RunState::kConstant && !cushion_.rising()) catching_ = false;
}

void DriveCore::begin_brake(const Tick& t) {
  output_off(RunState::kDcBraking);
  dc_brake_.begin();
  brake(t);
}

void DriveCore::brake(const Tick& t) {
  const bool brakes = dc_brake_.step(t.dt_s, t.settings);
  if (!brakes && !t.pre_excited()) output_off(RunState::kStopped);
}

void DriveCore::supply_failed(const Tick& t) {
  const bool start_on = t.command.direction != RunDirection::kStop;
  overload_ = link_overload_ = false;
  // MRS holds a restart back like a link that is not yet charged.
  const bool low = link_.low() || (t.command.output_stop && power_failure_.failed());
  switch (power_failure_.step(t.dt_s, t.settings, low, start_on)) {
    case PowerFailure::Verdict::kOff:
      state_ = power_failure_.waiting() ? RunState::kRestartWait : RunState::kPowerFailure;
      return;
    case PowerFailure::Verdict::kResume:
      if (t.command.output_stop)
        output_off(RunState::kStopped);
      else
        state_ = state_before_dip_;
      return;
    case PowerFailure::Verdict::kStopped: output_off(RunState::kStopped); return;
    case PowerFailure::Verdict::kRestart: break;
  }
  if (!t.wanted) {
    output_off(RunState::kStopped);
    return;
  }
  const double before_hz = ramp_.frequency_hz();
  start(t);
  if (state_ != RunState::kTripped) catch_motor(t, before_hz);
}

void DriveCore::set_stage(const Tick& t) {
  const DriveSettings& s = t.settings;
  out_.gates_on = output_on();
  out_.chopper_enabled =
      s.chopper_fitted && t.sensors.control_power && !t.sensors.chopper_failed && brake_duty_.permits();
  out_.ramp_frequency_hz = out_.gates_on ? ramp_.frequency_hz() : 0;
  out_.output_frequency_hz = 0;
  out_.stage_frequency_hz = 0;
  out_.stage_voltage_peak_v = 0;
  out_.torque_command_percent = 0;
  out_.torque_limited = false;
  out_.speed_limited = false;
  if (!out_.gates_on) return;

  const double limit = current_limit_.step(t.dt_s, s, t.sensors.current_peak_a, t.sensors.active_current_a_rms);
  if (state_ == RunState::kDcBraking) {
    out_.ramp_frequency_hz = 0;
    if (t.pre_excited() || (s.vector.on && s.zero_speed_brake)) {
      set_vector_stage(t, 0, limit, Motion::kConstant);
      return;
    }
    out_.stage_voltage_peak_v = limit * phase_peak_v(DcBrake::voltage_v_rms(s));
    return;
  }
  const double ramp = ramp_.frequency_hz();
  const double magnitude = std::abs(ramp);
  const double slip = slip_.step(t.dt_s, s, magnitude, t.torque_current_a_rms);
  const double droop = droop_.step(t.dt_s, s, state_ != RunState::kConstant, t.torque_current_a_rms);
  if (s.vector.on) {
    const Motion motion = state_ == RunState::kAccelerating   ? Motion::kAccelerating
                          : state_ == RunState::kDecelerating ? Motion::kDecelerating
                                                              : Motion::kConstant;
    set_vector_stage(t, std::copysign(std::max(0.0, magnitude - droop), ramp), limit, motion);
    return;
  }
  // Compensation does not raise the output above the maximum frequency, nor lower it below the start frequency.
  const double output = std::clamp(magnitude + slip - droop + t.command.raise_by_hz,
                                   std::min(magnitude, s.start_frequency_hz), std::max(magnitude, s.max_frequency_hz));
  const RunDirection rotation = ramp < 0 ? RunDirection::kReverse : RunDirection::kForward;
  const double raised = cushion_.rising() ? cushion_.step(t.dt_s, s) : 1;
  const double voltage = vf_voltage_v_rms(s, output, rotation, compensation_current_.value());
  out_.output_frequency_hz = std::copysign(output, ramp);
  out_.stage_frequency_hz = out_.output_frequency_hz;
  out_.stage_voltage_peak_v = raised * limit * t.command.voltage_factor * phase_peak_v(voltage);
}

void DriveCore::set_vector_stage(const Tick& t, double reference_hz, double limit, Motion motion) {
  const DriveSettings& s = t.settings;
  const double direction = reference_hz < 0 ? -1 : 1;
  const double backward = t.command.backward_limit_hz < 0 ? std::abs(reference_hz)
                          : t.wanted                      ? t.command.backward_limit_hz
                                                          : 0;
  const auto out = vector_.step(t.dt_s, s.vector,
                                {reference_hz, backward, direction * t.command.torque_percent,
                                 t.sensors.rotor_frequency_hz, t.sensors.torque_nm, limit, motion});
  const double raised = cushion_.rising() ? cushion_.step(t.dt_s, s) : 1;
  out_.output_frequency_hz = out.frequency_hz;
  out_.stage_frequency_hz = out.frequency_hz;
  out_.stage_voltage_peak_v = raised * limit * phase_peak_v(std::min(out.voltage_v_rms, s.supply_voltage_v_rms));
  out_.torque_command_percent = out.torque_percent;
  out_.torque_limited = out.torque_limited;
  out_.speed_limited = out.speed_limited;
  if (!out.stalled) return;
  const RunState state = state_;
  trip({TripKind::kStallPrevention, {}, std::abs(out.torque_percent), s.vector.stall_percent, state, out.frequency_hz});
}

void DriveCore::publish(const Tick& t) {
  const DriveSettings& s = t.settings;
  out_.state = state_;
  // RUN is off during DC injection: it tells of a frequency at or above the start frequency.
  out_.running = out_.gates_on && state_ != RunState::kDcBraking;
  out_.overload = out_.gates_on && (overload_ || out_.torque_limited);
  out_.link_overload = out_.gates_on && link_overload_;
  out_.power_failure = power_failure_.failed();
  detection_.step(t.dt_s, s,
                  {out_.running, out_.ramp_frequency_hz, out_.output_frequency_hz,
                   sign_of(t.command.direction) * t.reference_hz, t.sensors.current_a_rms});
  out_.up_to_frequency = detection_.up_to_frequency();
  out_.frequency_detected = detection_.frequency_detected();
  out_.current_detected = detection_.current_detected();
  out_.zero_current = detection_.zero_current();
  const bool thermal_on = s.electronic_thermal_a_rms > 0;
  out_.thermal_pre_alarm = thermal_on && protections_.motor().pre_alarm();
  out_.motor_thermal_fraction = thermal_on ? protections_.motor().fraction() : 0;
  out_.inverter_thermal_fraction = protections_.inverter().fraction();
  out_.brake_duty_fraction = brake_duty_.fraction();
}

}  // namespace vinv::drive
