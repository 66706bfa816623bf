// One control tick of a Mitsubishi inverter: supply, resets, mailbox, modes, core, stage, monitors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

using drive::RunDirection;
using port::NetTerminal;
using port::OperationMode;

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kCurrentMonitor_s = 0.1;  // filter of the current monitor
constexpr std::int64_t kHourMeterSaved_s = 3600;
// Fan: all typical for the family. While stopped with Pr.244 = 1 it runs only until the heat sink has cooled down.
constexpr double kResistanceInStillAir = 3;  // of the heat sink's with the fan
constexpr double kFanOn_c = 60;
constexpr double kFanOff_c = 50;

std::uint16_t to_word(double value) { return static_cast<std::uint16_t>(std::clamp(std::lround(value), 0L, 65535L)); }

}  // namespace

void MitsubishiInverter::tick(Instant now) {
  now_ = now;
  follow_supply();
  plant::StageInput stage;
  if (control_alive_) {
    follow_reset_terminal();
    if (const auto& request = v_.mailbox.request()) v_.mailbox.decide(decide(*request));
    follow_mode();
    follow_causes();
    follow_retry();
    stage = control();
  }
  plant_.set_stage(stage);
  plant_.set_carrier(settings_.carrier_hz);
  plant_.set_cooling(v_.published.fan ? 1 : kResistanceInStillAir);
  events_ = plant_.advance(kControlPeriod);
  publish();
  if (snapshot_grid_ > Duration{} && now.time_since_epoch() % snapshot_grid_ == Duration{}) plant_.restart_solver();
}

void MitsubishiInverter::follow_supply() {
  const double dc_link_v = plant_.measurements().dc_link_v;
  if (control_alive_ && dc_link_v < model_.control_off_v) {
    control_alive_ = false;
    if (store_.integer(pr::kRemoteSetting) == 1) {
      const auto remote = static_cast<std::int32_t>(std::lround(v_.remote.frequency_hz() * 100));
      if (remote != record_.remote_frequency) eeprom_changed_ = true;
      record_.remote_frequency = remote;
    }
    stop_family(record_);
    if (v_.operating_s > 0) eeprom_changed_ = true;
    record_.operating_seconds += std::llround(v_.operating_s);
    // The refused contents are gone; what is written from now on are the values that stand in RAM since then.
    if (causes_.eeprom_damaged) eeprom_changed_ = true;
    causes_.eeprom_damaged = false;
    core_ = drive::DriveCore{};
    Mailbox mailbox = v_.mailbox;
    if (mailbox.request()) mailbox.decide(Unexpected(port::Refusal::kNotReady));
    v_ = Volatile{};
    v_.mailbox = mailbox;
    store_.load_ram_from_eeprom();
    return;
  }
  if (!control_alive_ && dc_link_v > model_.control_on_v) {
    control_alive_ = true;
    start_volatile();
    v_.ready_at = now_ + kStartUpTime;
    if (causes_.eeprom_damaged) raise("E.PE", "the stored parameters are damaged, factory values are in use");
  }
}

void MitsubishiInverter::follow_reset_terminal() {
  const bool closed = assigned(wiring_.closed).has(InputSignal::kRes);
  if (closed && !v_.in_reset && reset_accepted()) {
    begin_reset();
    v_.in_reset = true;
  }
  if (!v_.in_reset) return;
  v_.in_reset = closed;
  v_.ready_at = now_ + kResetTime;
}

void MitsubishiInverter::follow_mode() {
  const OperationMode next = mode_by_settings();
  if (next != v_.mode) change_mode(next);
  // The sense of MRS follows Pr.17 only at rest (OI-FR-E5NCO manual 5.1, note).
  if (!running() && !v_.any_start_signal) v_.mrs_inverted = store_.integer(pr::kMrsSense) != 0;
}

void MitsubishiInverter::change_mode(OperationMode next) {
  // With Pr.79 = 6 the motor may be running: direction and frequency are taken over by the new source.
  const RunDirection direction = v_.direction;
  const double frequency_hz = v_.published.set_frequency_hz;
  const bool goes_on = running() && direction != RunDirection::kStop;
  v_.panel.run = RunDirection::kStop;
  v_.panel.jog_run = false;
  v_.network.command = {};
  v_.network.converter.reset();
  v_.mode = next;
  if (!goes_on || store_.integer(pr::kOperationMode) != 6) return;
  if (next == OperationMode::kPu) {
    v_.panel.run = direction;
    v_.panel_frequency_hz = frequency_hz;
  } else if (next == OperationMode::kNetwork) {
    v_.network.command.set(direction == RunDirection::kForward ? NetTerminal::kStf : NetTerminal::kStr, true);
    v_.network.frequency_hz = frequency_hz;
  }
}

const drive::DriveSettings& MitsubishiInverter::settings_for(const SettingsSelection& selection) {
  if (settings_revision_ != store_.revision() || !(settings_selection_ == selection)) {
    settings_ = make_settings(selection);
    settings_revision_ = store_.revision();
    settings_selection_ = selection;
  }
  return settings_;
}

plant::StageInput MitsubishiInverter::tune(const Inputs& inputs) {
  if (v_.alarm.row || inputs.direction == RunDirection::kStop || inputs.output_stop) {
    v_.tuning.abort();
    v_.tuning_status = v_.alarm.row ? TuningStatus::kAlarm : TuningStatus::kStopped;
    finish_tuning();
    return {};
  }
  const auto stage =
      v_.tuning.step(kPeriod_s, model_.rated_current_a_rms, measured().dc_link_v / std::numbers::sqrt3, measured());
  if (v_.tuning.running()) return stage;
  v_.tuning_status = v_.tuning.succeeded() ? TuningStatus::kDone : TuningStatus::kAlarm;
  if (v_.tuning.succeeded()) store_tuned_resistance(v_.tuning.resistance_ohm());
  finish_tuning();
  return {};
}

plant::StageInput MitsubishiInverter::control() {
  const Inputs in = read_inputs();
  v_.direction = in.direction;
  const auto& settings = settings_for(selection(in));
  const double set_hz = set_frequency(in);
  v_.published.set_frequency_hz = std::min(set_hz, settings.max_frequency_hz);

  const bool permit = now_ >= v_.ready_at && !v_.in_reset && v_.retry.phase != Retry::Phase::kWaiting;
  if (!v_.tuning.running() && permit && !v_.alarm.row && in.direction != RunDirection::kStop && !in.output_stop &&
      !running() && store_.integer(tuning_numbers().setting) == 1 && !store_.is_9999(tuning_numbers().capacity)) {
    v_.tuning.start();
    v_.tuned_setting = tuning_numbers().setting;
    v_.tuning_status = TuningStatus::kRunning;
  }
  // After a tuning run the start signal must go off before the motor turns.
  if (in.direction == RunDirection::kStop) v_.tuned_until_stop = false;
  const bool tuning = v_.tuning.running();
  if (tuning) v_.tuned_until_stop = true;

  drive::DriveCommand command;
  command.direction = v_.tuned_until_stop ? RunDirection::kStop : in.direction;
  command.set_frequency_hz = set_hz;
  command.output_stop = in.output_stop;
  command.external_thermal = in.external_thermal;
  command.permit = permit;

  const plant::PlantMeasurements m = measured();
  drive::Sensors sensors;
  sensors.current_a_rms = m.output_current_a_rms;
  sensors.current_peak_a = m.current_peak_a;
  sensors.active_current_a_rms = m.active_current_a_rms;
  sensors.dc_link_v = m.dc_link_v;
  sensors.heat_sink_c = m.heat_sink_c;
  sensors.chopper_on = m.chopper_on;
  sensors.chopper_failed = causes_.brake_transistor && m.chopper_on;
  sensors.earth_fault = causes_.earth_fault;
  sensors.output_phase_open = causes_.output_phase_open;
  sensors.rotor_frequency_hz = plant_.config().machine.pole_pairs * m.speed_rpm / 60;
  sensors.torque_nm = m.torque_nm;
  for (std::size_t i = 0; i < events_.count; ++i) {
    const plant::PlantEvent& event = events_.items[i];
    switch (event.kind) {
      case plant::PlantEventKind::kOverCurrent: sensors.over_current = true; break;
      case plant::PlantEventKind::kOverVoltage: sensors.over_voltage = true; break;
      case plant::PlantEventKind::kUnderVoltage: sensors.under_voltage = true; break;
    }
    // The comparator that trips is the one to report.
    if (event.kind != plant::PlantEventKind::kUnderVoltage || !(sensors.over_current || sensors.over_voltage)) {
      sensors.comparator_value = event.value;
      sensors.comparator_after = event.after;
    }
  }
  add_command(in, command, sensors);
  const drive::DriveOutputs& out = core_.tick(kControlPeriod, settings, command, sensors);
  if (out.trip) raise_trip(*out.trip);
  if (v_.tuning.running()) return tune(in);

  plant::StageInput stage;
  stage.gates_on = core_.outputs().gates_on;
  stage.frequency_hz = core_.outputs().stage_frequency_hz;
  stage.voltage_peak_v = core_.outputs().stage_voltage_peak_v;
  stage.chopper_enabled = core_.outputs().chopper_enabled;
  stage.chopper_on_v = settings.chopper_on_v;
  stage.chopper_off_v = settings.chopper_off_v;
  return stage;
}

// The comparators of over-current and over-voltage have taps of their own, and act whatever the sensors read.
plant::PlantMeasurements MitsubishiInverter::measured() const {
  constexpr double kOpenThermistor_c = 150;
  plant::PlantMeasurements m = plant_.measurements();
  if (causes_.current_sensor) m.output_current_a_rms = m.current_peak_a = m.active_current_a_rms = 0;
  if (causes_.dc_link_sensor) m.dc_link_v = 0;
  if (causes_.heat_sink_sensor) m.heat_sink_c = kOpenThermistor_c;
  return m;
}

void MitsubishiInverter::publish() {
  Published& p = v_.published;
  if (!control_alive_) {
    p = Published{};
    return;
  }
  const drive::DriveOutputs& out = core_.outputs();
  const plant::PlantMeasurements m = measured();
  const bool alarm_output = v_.alarm.row && alarm_visible();
  const bool tuning = v_.tuning.running();
  p.status.running = out.running || tuning;
  p.status.forward = out.running && out.output_frequency_hz > 0;
  p.status.reverse = out.running && out.output_frequency_hz < 0;
  p.status.up_to_frequency = out.up_to_frequency;
  p.status.overload = out.overload;
  p.status.power_failure = out.power_failure;
  p.status.frequency_detected = out.frequency_detected;
  p.status.alarm = alarm_output;
  p.status.stopping = out.running && v_.direction == RunDirection::kStop;
  p.status.ready = ready() && !v_.alarm.row && m.dc_link_v > model_.under_voltage_v;

  p.output_frequency = to_word(std::abs(out.output_frequency_hz) * 100);
  p.output_current = to_word(v_.current_monitor.step(m.output_current_a_rms, kPeriod_s, kCurrentMonitor_s) * 100);
  p.output_voltage = to_word(m.gates_on ? m.output_voltage_v_rms * 10 : 0);

  OutputSignals o;
  o.set(OutputSignal::kRun, p.status.running);
  o.set(OutputSignal::kSu, p.status.up_to_frequency);
  o.set(OutputSignal::kOl, p.status.overload);
  o.set(OutputSignal::kFu, p.status.frequency_detected);
  o.set(OutputSignal::kRy, p.status.ready);
  o.set(OutputSignal::kY12, out.current_detected);
  o.set(OutputSignal::kY13, out.zero_current);
  o.set(OutputSignal::kFdn, v_.pid_active && v_.pid.below_lower_limit());
  o.set(OutputSignal::kFup, v_.pid_active && v_.pid.above_upper_limit());
  o.set(OutputSignal::kPidForward, v_.pid_active && p.status.forward);
  o.set(OutputSignal::kLf, v_.network.communication_lost);
  o.set(OutputSignal::kAbc, alarm_output);
  publish_family(o);
  p.outputs = o;

  p.fan =
      !causes_.fan && (store_.integer(pr::kFan) == 0 || m.gates_on || m.heat_sink_c > (p.fan ? kFanOff_c : kFanOn_c));

  if (p.status.running) v_.operating_s += kPeriod_s;
  if (v_.operating_s >= kHourMeterSaved_s) {
    record_.operating_seconds += kHourMeterSaved_s;
    v_.operating_s -= kHourMeterSaved_s;
    eeprom_changed_ = true;
  }
}

}  // namespace vinv::inverter::mitsubishi
