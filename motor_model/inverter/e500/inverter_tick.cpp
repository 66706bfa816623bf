// One control tick of the FR-E500: supply, resets, mailbox, modes, inputs, frequency sources, core, stage, monitors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/multi_speed.hpp"
#include "motor_model/inverter/e500/parameter_numbers.hpp"

namespace vinv::inverter::e500 {
namespace {

using drive::RunDirection;
using port::NetTerminal;
using port::OperationMode;

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kCurrentMonitor_s = 0.1;       // filter of the current monitor
constexpr double kFilterUnit_s = 0.005;         // Pr.74: times 2 to the power of the setting
constexpr double kAmFullScale_v = 10;
constexpr std::int64_t kHourMeterSaved_s = 3600;

// Signals that never come from the network: the thermal relay is wired, and X16 chooses the mode.
constexpr InputSignals mask_of(std::initializer_list<InputSignal> signals) {
  InputSignals mask;
  for (InputSignal s : signals) mask.set(s, true);
  return mask;
}
constexpr InputSignals kSpeedSignals =
    mask_of({InputSignal::kRl, InputSignal::kRm, InputSignal::kRh, InputSignal::kRex});
constexpr InputSignals kOperationSignals = mask_of({InputSignal::kRt, InputSignal::kX18});

std::uint16_t to_word(double value) {
  return static_cast<std::uint16_t>(std::clamp(std::lround(value), 0L, 65535L));
}

}  // namespace

void E500Inverter::tick(Instant now) {
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
  events_ = plant_.advance(kControlPeriod);
  publish();
}

void E500Inverter::follow_supply() {
  const double dc_link_v = plant_.measurements().dc_link_v;
  if (control_alive_ && dc_link_v < model_.control_off_v) {
    control_alive_ = false;
    if (store_.integer(pr::kRemoteSetting) == 1) {
      const auto remote = static_cast<std::int32_t>(std::lround(v_.remote.frequency_hz() * 100));
      if (remote != record_.remote_frequency) eeprom_changed_ = true;
      record_.remote_frequency = remote;
    }
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

void E500Inverter::follow_reset_terminal() {
  const bool closed = wiring_.closed[kRes];
  if (closed && !v_.in_reset && reset_accepted()) {
    begin_reset();
    v_.in_reset = true;
  }
  if (!v_.in_reset) return;
  v_.in_reset = closed;
  v_.ready_at = now_ + kResetTime;
}

void E500Inverter::follow_mode() {
  const OperationMode next = follow_settings(v_.mode, mode_situation());
  if (next != v_.mode) change_mode(next);
  // The sense of MRS follows Pr.17 only at rest (OI-FR-E5NCO manual 5.1, note).
  if (!running() && !v_.any_start_signal) v_.mrs_inverted = store_.integer(pr::kMrsSense) == 2;
}

void E500Inverter::change_mode(OperationMode next) {
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

InputSignals E500Inverter::assigned(bool rl, bool rm, bool rh, bool mrs) const {
  InputSignals out;
  const auto add = [&](unsigned function, bool closed) {
    const auto signal = data_.signals.input(store_.integer(function));
    if (signal && closed) out.set(*signal, true);
  };
  add(pr::kRlFunction, rl);
  add(pr::kRmFunction, rm);
  add(pr::kRhFunction, rh);
  add(pr::kMrsFunction, mrs);
  return out;
}

bool E500Inverter::has_function(InputSignal signal) const {
  for (unsigned function : {pr::kRlFunction, pr::kRmFunction, pr::kRhFunction, pr::kMrsFunction}) {
    if (data_.signals.input(store_.integer(function)) == signal) return true;
  }
  return false;
}

InputSignals E500Inverter::wired_signals() const {
  const auto& closed = wiring_.closed;
  InputSignals signals = assigned(closed[kRl], closed[kRm], closed[kRh], closed[kMrs]);
  // Pr.17 = 2: a normally closed contact.
  if (v_.mrs_inverted && has_function(InputSignal::kMrs)) {
    signals.set(InputSignal::kMrs, !signals.has(InputSignal::kMrs));
  }
  return signals;
}

E500Inverter::Inputs E500Inverter::read_inputs() {
  const InputSignals wired = wired_signals();
  const auto& command = v_.network.command;
  const InputSignals from_network = assigned(command.has(NetTerminal::kRl), command.has(NetTerminal::kRm),
                                             command.has(NetTerminal::kRh), command.has(NetTerminal::kMrs));
  const StopSelection stop = stop_selection(store_.value(pr::kStopSelection));
  Inputs in;
  StartSignals start{wiring_.closed[kStf], wiring_.closed[kStr], wired.has(InputSignal::kStop)};
  bool by_panel = false;
  in.signals = wired;
  in.output_stop = wired.has(InputSignal::kMrs);
  switch (v_.mode) {
    case OperationMode::kPu:
      in.signals.bits &= ~kSpeedSignals.bits;
      in.signals.set(InputSignal::kAu, false);
      by_panel = true;
      // With Pr.79 = 7 signal MRS is the interlock, an output stop in external operation only.
      if (store_.integer(pr::kOperationMode) == 7) in.output_stop = false;
      break;
    case OperationMode::kCombined2: by_panel = true; break;
    case OperationMode::kNetwork: {
      const bool network_operates = store_.integer(pr::kOperationRight) == 0;
      const bool network_sets_speed = store_.integer(pr::kSpeedRight) == 0;
      if (network_operates) {
        in.signals = in.signals.only({~kOperationSignals.bits}) | from_network.only(kOperationSignals);
        in.output_stop = in.output_stop || from_network.has(InputSignal::kMrs);
        const bool stopped = command.has(NetTerminal::kStop);
        start = {command.has(NetTerminal::kStf) && !stopped, command.has(NetTerminal::kStr) && !stopped, false};
      }
      if (network_sets_speed) {
        in.signals = in.signals.only({~kSpeedSignals.bits}) | from_network.only(kSpeedSignals);
        in.signals.set(InputSignal::kAu, false);
      }
      break;
    }
    default: break;
  }
  if (by_panel) start = {};
  const RunDirection by_signals = v_.start_latch.step(start, stop.str_is_direction);
  in.direction = permitted(by_panel ? v_.panel.run : by_signals, store_.integer(pr::kReversePrevention));
  v_.any_start_signal = wiring_.closed[kStf] || wiring_.closed[kStr] || command.has(NetTerminal::kStf) ||
                        command.has(NetTerminal::kStr) || v_.panel.run != RunDirection::kStop ||
                        by_signals != RunDirection::kStop;
  if (v_.panel.stopped_by_panel) in.direction = RunDirection::kStop;
  // The contact of the thermal relay is closed while all is well.
  in.external_thermal = has_function(InputSignal::kOh) && (!wired.has(InputSignal::kOh) || causes_.external_thermal);
  return in;
}

double E500Inverter::terminal_2_percent() {
  const double full_scale_v = store_.integer(pr::kVoltageRange) == 0 ? 5 : 10;
  const bool by_converter = v_.mode == OperationMode::kNetwork && v_.network.converter;
  const double percent = by_converter ? *v_.network.converter * 100.0 / 255
                                      : std::min(100.0, wiring_.terminal_2_v / full_scale_v * 100);
  const double filter_s = kFilterUnit_s * std::exp2(store_.integer(pr::kInputFilter));
  return v_.input_2.step(percent, kPeriod_s, filter_s);
}

double E500Inverter::terminal_4_percent() {
  const double filter_s = kFilterUnit_s * std::exp2(store_.integer(pr::kInputFilter));
  return v_.input_4.step(std::min(100.0, wiring_.terminal_4_ma / 20 * 100), kPeriod_s, filter_s);
}

double E500Inverter::set_frequency(const Inputs& inputs) {
  // Both inputs are followed in every mode, so that a change of source meets a settled filter.
  const double percent_2 = terminal_2_percent();
  const double percent_4 = terminal_4_percent();
  const AnalogLine line_2{store_.value(pr::kVoltageBias, 2), store_.value(pr::kVoltageBias, 1),
                          store_.value(pr::kVoltageGain, 2), store_.value(pr::kVoltageGain, 1)};
  const AnalogLine line_4{store_.value(pr::kCurrentBias, 2), store_.value(pr::kCurrentBias, 1),
                          store_.value(pr::kCurrentGain, 2), store_.value(pr::kCurrentGain, 1)};
  const bool panel_sets = v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined1;
  const bool network_sets = v_.mode == OperationMode::kNetwork && store_.integer(pr::kSpeedRight) == 0;

  if (v_.mode == OperationMode::kPu && v_.panel.jog_run) {
    v_.pid.reset();
    return store_.value(pr::kJogFrequency);
  }
  const int remote = store_.integer(pr::kRemoteSetting);
  if (remote == 0 || v_.mode == OperationMode::kPu) {
    if (const auto speed = multi_speed_hz(store_, inputs.signals)) {
      v_.pid.reset();
      return *speed;
    }
  }
  double main_hz = 0;
  if (network_sets) {
    main_hz = v_.network.frequency_hz;
  } else if (v_.mode != OperationMode::kPu && inputs.signals.has(InputSignal::kAu)) {
    main_hz = line_4.frequency(percent_4);
  } else if (panel_sets) {
    main_hz = v_.panel_frequency_hz;
  } else {
    main_hz = line_2.frequency(percent_2);
  }
  if (const int action = store_.integer(pr::kPidAction); action != 0) {
    if (inputs.direction == RunDirection::kStop) {
      v_.pid.reset();
      return main_hz;
    }
    const auto share = [](double percent, const AnalogLine& line) {
      const double span = line.gain_percent - line.bias_percent;
      return span > 0.1 ? (percent - line.bias_percent) / span * 100 : 0;
    };
    const auto limit = [this](unsigned number, double none) {
      return store_.is_9999(number) ? none : store_.value(number);
    };
    drive::PidSettings pid;
    pid.action = action == 21 ? drive::PidAction::kForward : drive::PidAction::kReverse;
    pid.proportional_band_percent = limit(pr::kPidBand, 0);
    pid.integral_s = limit(pr::kPidIntegral, 0);
    pid.derivative_s = limit(pr::kPidDerivative, 0);
    pid.upper_limit_percent = limit(pr::kPidUpper, 1e9);
    pid.lower_limit_percent = limit(pr::kPidLower, -1e9);
    // Set point: Pr.133 where panel or network set the speed, else terminal 2. Measured value: terminal 4.
    const double set_point =
        panel_sets || network_sets ? store_.value(pr::kPidSetPoint) : share(percent_2, line_2);
    return v_.pid.step(kPeriod_s, pid, set_point, share(percent_4, line_4)) / 100 * line_2.gain_hz;
  }
  v_.pid.reset();
  if (remote == 0 || v_.mode == OperationMode::kPu) return main_hz;
  return main_hz + remote_frequency(inputs, main_hz);
}

double E500Inverter::remote_frequency(const Inputs& inputs, double main_hz) {
  const double up_s = store_.value(pr::kSecondRamp);
  const double down_s = store_.is_9999(pr::kSecondDeceleration) ? up_s : store_.value(pr::kSecondDeceleration);
  const double reference_hz = store_.value(pr::kRampReference);
  drive::RemoteSettings remote;
  remote.memory = store_.integer(pr::kRemoteSetting) == 1;
  remote.raise_rate_hz_s = reference_hz / std::max(up_s, kPeriod_s);
  remote.lower_rate_hz_s = reference_hz / std::max(down_s, kPeriod_s);
  remote.max_hz = std::max(0.0, maximum_frequency_hz(store_) - main_hz);
  const double hz = v_.remote.step(kPeriod_s, remote,
                                   {inputs.signals.has(InputSignal::kRh), inputs.signals.has(InputSignal::kRm),
                                    inputs.signals.has(InputSignal::kRl), inputs.direction != RunDirection::kStop});
  if (const auto store = v_.remote.take_store()) {
    record_.remote_frequency = static_cast<std::int32_t>(std::lround(*store * 100));
    eeprom_written();
  }
  return hz;
}

const drive::DriveSettings& E500Inverter::settings_for(const SettingsSelection& selection) {
  if (settings_revision_ != store_.revision() || !(settings_selection_ == selection)) {
    settings_ = make_settings(store_, selection, {&model_, &data_.models, nominal_mains_v_rms_, brake_resistor_});
    settings_revision_ = store_.revision();
    settings_selection_ = selection;
  }
  return settings_;
}

plant::StageInput E500Inverter::tune(const Inputs& inputs) {
  if (v_.alarm.row || inputs.direction == RunDirection::kStop || inputs.output_stop) {
    v_.tuning.abort();
    v_.tuning_status = v_.alarm.row ? TuningStatus::kAlarm : TuningStatus::kStopped;
    finish_tuning();
    return {};
  }
  const auto stage = v_.tuning.step(kPeriod_s, model_.rated_current_a_rms,
                                    plant_.measurements().dc_link_v / std::numbers::sqrt3, plant_.measurements());
  if (v_.tuning.running()) return stage;
  v_.tuning_status = v_.tuning.succeeded() ? TuningStatus::kDone : TuningStatus::kAlarm;
  if (v_.tuning.succeeded()) store_tuned_resistance(v_.tuning.resistance_ohm());
  finish_tuning();
  return {};
}

plant::StageInput E500Inverter::control() {
  const Inputs in = read_inputs();
  v_.direction = in.direction;
  const bool jog = v_.mode == OperationMode::kPu && v_.panel.jog_run;
  const auto& settings =
      settings_for({in.signals.has(InputSignal::kRt) && !jog, jog, in.signals.has(InputSignal::kX18)});
  const double set_hz = set_frequency(in);
  v_.published.set_frequency_hz = std::min(set_hz, settings.max_frequency_hz);

  const bool permit = now_ >= v_.ready_at && !v_.in_reset && v_.retry.phase != Retry::Phase::kWaiting;
  if (!v_.tuning.running() && permit && !v_.alarm.row && in.direction != RunDirection::kStop && !in.output_stop &&
      !running() && store_.integer(pr::kAutoTuning) == 1 && !store_.is_9999(pr::kMotorCapacity)) {
    v_.tuning.start();
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

  const plant::PlantMeasurements& m = plant_.measurements();
  drive::Sensors sensors;
  sensors.current_a_rms = m.output_current_a_rms;
  sensors.current_peak_a = m.current_peak_a;
  sensors.active_current_a_rms = m.active_current_a_rms;
  sensors.dc_link_v = m.dc_link_v;
  sensors.heat_sink_c = m.heat_sink_c;
  sensors.chopper_on = m.chopper_on;
  sensors.chopper_failed = causes_.brake_transistor;
  sensors.earth_fault = causes_.earth_fault;
  sensors.output_phase_open = causes_.output_phase_open;
  sensors.rotor_frequency_hz = plant_.config().machine.pole_pairs * m.speed_rpm / 60;
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

void E500Inverter::publish() {
  Published& p = v_.published;
  if (!control_alive_) {
    p = Published{};
    return;
  }
  const drive::DriveOutputs& out = core_.outputs();
  const plant::PlantMeasurements& m = plant_.measurements();
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
  p.status.ready = ready() && !v_.alarm.row && m.dc_link_v > model_.under_voltage_v;

  p.output_frequency = to_word(std::abs(out.output_frequency_hz) * 100);
  const double current = v_.current_monitor.step(m.output_current_a_rms, kPeriod_s, kCurrentMonitor_s);
  p.output_current = to_word(current * 100);
  p.output_voltage = to_word(m.gates_on ? m.output_voltage_v_rms * 10 : 0);

  OutputSignals o;
  o.set(OutputSignal::kRun, p.status.running);
  o.set(OutputSignal::kSu, p.status.up_to_frequency);
  o.set(OutputSignal::kOl, p.status.overload);
  o.set(OutputSignal::kFu, p.status.frequency_detected);
  o.set(OutputSignal::kRy, p.status.ready);
  o.set(OutputSignal::kY12, out.current_detected);
  o.set(OutputSignal::kY13, out.zero_current);
  const bool pid = store_.integer(pr::kPidAction) != 0 && v_.direction != RunDirection::kStop;
  o.set(OutputSignal::kFdn, pid && v_.pid.below_lower_limit());
  o.set(OutputSignal::kFup, pid && v_.pid.above_upper_limit());
  o.set(OutputSignal::kPidForward, pid && p.status.forward);
  o.set(OutputSignal::kLf, v_.network.communication_lost);
  o.set(OutputSignal::kAbc, alarm_output);
  p.outputs = o;

  double share = 0;
  const auto ratio = [](double value, double full_scale) { return full_scale > 0 ? value / full_scale : 0; };
  switch (store_.integer(pr::kAmSelection)) {
    case 1: share = ratio(current, store_.value(pr::kCurrentFullScale)); break;
    case 2: share = ratio(m.gates_on ? m.output_voltage_v_rms : 0, model_.voltage_class_v); break;
    default: share = ratio(std::abs(out.output_frequency_hz), store_.value(pr::kFrequencyFullScale));
  }
  p.am_v = std::clamp(share * kAmFullScale_v * store_.value(pr::kAmCalibration) / 100, 0.0, kAmFullScale_v);
  p.fan = store_.integer(pr::kFan) == 0 || m.gates_on;

  if (p.status.running) v_.operating_s += kPeriod_s;
  if (v_.operating_s >= kHourMeterSaved_s) {
    record_.operating_seconds += kHourMeterSaved_s;
    v_.operating_s -= kHourMeterSaved_s;
    eeprom_changed_ = true;
  }
}

}  // namespace vinv::inverter::e500
