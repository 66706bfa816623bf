// Modes, communication errors, resets, parameters with a meaning of their own, and counters of the FR-A700.
// FR-A7NE manual 4.3 to 4.6; the rest typical for the family.
#include "motor_model/inverter/a700/inverter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/a700/parameter_numbers.hpp"
#include "motor_model/inverter/a700/part_life.hpp"

namespace vinv::inverter::a700 {

using drive::RunDirection;
using port::OperationMode;
using port::Refusal;
using port::WriteOutcome;
using port::WriteRequest;

namespace {

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kPhaseLost_s = 1;       // an input phase must be missing this long
constexpr double kThermistorHot_s = 10;  // the thermistor must be hot this long
constexpr double kHour_s = 3600;
constexpr std::int64_t kCarry_h = 65536;         // a monitor of hours begins anew here
constexpr std::uint32_t kMostFrequency = 40000;  // 0.01 Hz
constexpr double kBlackoutShare = 0.3;  // of the nominal supply: less is a power failure, more an under-voltage

std::string at(double seconds, const char* text) {
  char out[160];
  std::snprintf(out, sizeof out, "%s at %.3f s", text, seconds);
  return out;
}

}  // namespace

// --- operation mode ---

ModeSituation A700Inverter::mode_situation() const {
  const InputSignals wired = wired_signals();
  const auto chosen = [&](InputSignal signal) {
    return has_function(signal) ? std::optional(wired.has(signal)) : std::nullopt;
  };
  ModeSituation s;
  s.raw_pr79 = store_.integer(pr::kOperationMode);
  s.raw_pr340 = s_.raw_pr340;
  s.interlock_off = has_function(InputSignal::kX12) ? wired.has(InputSignal::kX12) : wired.has(InputSignal::kMrs);
  s.x16 = chosen(InputSignal::kX16);
  s.x65 = chosen(InputSignal::kX65);
  s.x66 = chosen(InputSignal::kX66);
  s.stopped = !running();
  s.start_signal = any_start_signal();
  return s;
}

std::optional<std::string> A700Inverter::panel_commands() const {
  const int owner = store_.integer(pr::kPanelOwner);
  if (owner == 2) return std::nullopt;
  return "Pr.551 = " + std::to_string(owner) + " gives PU operation to " +
         (owner == 1 ? "the RS-485 terminals" : "the USB connector");
}

Outcome A700Inverter::press_key(PanelKey key) {
  // Pr.161 = 10 and 11 leave STOP alone.
  if (store_.integer(pr::kKeyLock) >= 10 && key != PanelKey::kStopReset && ready()) {
    return Unexpected(std::string("HOLD: the keys are locked by Pr.161"));
  }
  return MitsubishiInverter::press_key(key);
}

// The key goes round EXT, PU, PU jog (with Pr.340 = 10 and 12 NET takes the place of EXT).
Outcome A700Inverter::panel_mode_key() {
  if (v_.mode != OperationMode::kPu) return MitsubishiInverter::panel_mode_key();
  if (v_.panel.screen != mitsubishi::Screen::kJog) {
    if (running()) return MitsubishiInverter::panel_mode_key();
    v_.panel.screen = mitsubishi::Screen::kJog;
    return {};
  }
  if (running() || v_.panel.run != RunDirection::kStop) return Unexpected(std::string("stop the jog run first"));
  v_.panel.screen = mitsubishi::Screen::kMonitor;
  v_.panel.jog_run = false;
  // Where PU is the only mode the key goes between PU and PU jog.
  if (!requested_mode(ModeRequest::kPanelKey)) return {};
  return MitsubishiInverter::panel_mode_key();
}

// --- power-on, power-off ---

void A700Inverter::start_family() {
  const std::int64_t errors = record_.counters[kLineErrors];
  const CommunicationError communication = s_.communication;
  const double energized = s_.energized_s;
  const double energy = s_.energy_j;
  const double aged = s_.capacitor_aged_s;
  const bool again = s_.alive;  // a reset, not a power-on
  s_ = State{};
  s_.alive = true;
  s_.communication = communication;
  s_.communication.reset();
  s_.energized_s = energized;
  s_.energy_j = energy;
  s_.capacitor_aged_s = aged;
  if (!again) ++record_.counters[kInrushOperations];
  s_.line_errors = errors;
  s_.raw_pr340 = store_.integer(pr::kLinkStart);
  v_.network.frequency_hz = static_cast<double>(record_.counters[kNetworkFrequency]) / 100;
  if (!again && store_.integer(pr::kRemoteOutputHold) == 0) {
    for (unsigned number : {496u, 497u}) {
      store_.write(*data_.parameters.index(port::ParameterId{static_cast<std::uint16_t>(number), 0}), 0,
                   Storage::kRamOnly);
    }
  }
  copy_parameter({pr::kTorqueCommand, 0}, {pr::kTorqueCommandRam, 0}, Storage::kRamOnly);
  // Pr.340 = 2 and 12 with restart (Pr.57): what was commanded before a short power failure goes on.
  if (remembered_.valid) {
    v_.network.command = remembered_.command;
    v_.network.frequency_hz = remembered_.frequency_hz;
  }
  remembered_ = {};
}

void A700Inverter::stop_family(EepromRecord& record) {
  const bool resumes = (s_.raw_pr340 == 2 || s_.raw_pr340 == 12) && !store_.is_9999(pr::kRestart) && breaker_ &&
                       v_.mode == OperationMode::kNetwork;
  remembered_ = {resumes, v_.network.command, v_.network.frequency_hz};
  keep_whole_seconds(record);
  measure_main_capacitor(record);
  record.counters[kEnergyJoule] += static_cast<std::int64_t>(s_.energy_j);
  eeprom_changed_ = true;
  // Pr.501 goes into the EEPROM once an hour only (FR-A7NE manual 4.5.1).
  s_ = State{};
}

void A700Inverter::keep_whole_seconds(EepromRecord& record) {
  const auto seconds = static_cast<std::int64_t>(s_.energized_s);
  s_.energized_s -= static_cast<double>(seconds);
  record.counters[kEnergizedSeconds] += seconds;
  record.counters[kMaintenanceSeconds] += seconds;
  const auto aged = static_cast<std::int64_t>(s_.capacitor_aged_s);
  s_.capacitor_aged_s -= static_cast<double>(aged);
  record.counters[kCapacitorAgeing] += aged;
}

void A700Inverter::count_family(EepromRecord& record) const {
  record.counters[kEnergizedSeconds] += static_cast<std::int64_t>(s_.energized_s);
  record.counters[kMaintenanceSeconds] += static_cast<std::int64_t>(s_.energized_s);
  record.counters[kEnergyJoule] += static_cast<std::int64_t>(s_.energy_j);
  record.counters[kCapacitorAgeing] += static_cast<std::int64_t>(s_.capacitor_aged_s);
}

void A700Inverter::count(double dt_s) {
  s_.energized_s += dt_s;
  s_.capacitor_aged_s += dt_s * ageing_rate(plant_.config().ambient_c);
  const plant::PlantMeasurements& m = plant_.measurements();
  if (m.gates_on) s_.energy_j += std::max(0.0, m.output_power_w) * dt_s;
  if (s_.energized_s < kHour_s) return;
  keep_whole_seconds(record_);
  const double whole = std::floor(s_.energy_j);
  s_.energy_j -= whole;
  record_.counters[kEnergyJoule] += static_cast<std::int64_t>(whole);
  record_.counters[kLineErrors] = s_.line_errors;
  eeprom_changed_ = true;
}

void A700Inverter::archive_family(Archive& a) {
  a.must_match("connector of the option", static_cast<std::uint64_t>(connector_));
  a.io(s_);
  a.io(remembered_);
}

// --- brake sequence ---

// Pr.292 = 7 with, 8 without a report of the brake (BRI); in vector control only.
void A700Inverter::follow_brake(drive::DriveCommand& command, const drive::Sensors& sensors) {
  const int selection = store_.integer(pr::kAutomaticAcceleration);
  const bool fitted = (selection == 7 || selection == 8) && vector_control();
  if (!fitted || v_.alarm.row || !command.permit || command.output_stop) {
    s_.brake.reset();
    return;
  }
  const double output_hz = core_.outputs().output_frequency_hz;
  if (command.direction != RunDirection::kStop) s_.last_direction = static_cast<double>(command.direction);
  const auto decision =
      s_.brake.step(kPeriod_s,
                    {store_.value(pr::kBrakeOpenFrequency), store_.value(pr::kBrakeOpenCurrent),
                     store_.value(pr::kBrakeOpenTime), store_.value(pr::kBrakeStartTime),
                     store_.value(pr::kBrakeCloseFrequency), store_.value(pr::kBrakeStopTime), selection == 7},
                    {command.direction != RunDirection::kStop, std::abs(output_hz),
                     sensors.current_a_rms / model_.rated_current_a_rms * 100, s_.brake_open});
  using Fault = drive::BrakeSequence::Fault;
  const double now_s = to_seconds(now_);
  switch (decision.fault) {
    case Fault::kNone: break;
    case Fault::kNotAsked: raise("E.MB4", at(now_s, "no current of Pr.279 to open the brake, judged")); return;
    case Fault::kNotOpened: raise("E.MB5", at(now_s, "the brake did not report that it is open, judged")); return;
    case Fault::kClosed: raise("E.MB6", at(now_s, "the brake closed while running, seen")); return;
    case Fault::kNotClosed: raise("E.MB7", at(now_s, "the brake did not close, judged")); return;
  }
  if (!decision.run) return;
  if (command.direction == RunDirection::kStop) {
    command.direction = s_.last_direction < 0 ? RunDirection::kReverse : RunDirection::kForward;
    command.set_frequency_hz = decision.most_hz;
  } else if (decision.most_hz >= 0) {
    command.set_frequency_hz = std::min(command.set_frequency_hz, decision.most_hz);
  }
}

// --- causes ---

void A700Inverter::follow_communication() {
  const bool network = v_.mode == OperationMode::kNetwork;
  const double now_s = to_seconds(now_);
  CommunicationError::Input in;
  in.line_lost = v_.network.communication_lost;
  in.line_acts = network && network_commands();
  in.option_failed = causes_.option || (v_.network.option_failed && network);
  in.running = running();
  in.wait_s = store_.value(pr::kErrorWait);
  in.stop_mode = store_.integer(pr::kErrorStop);
  const auto alarm = s_.communication.step(kPeriod_s, in);
  if (s_.communication.occurred()) ++s_.line_errors;
  if (v_.alarm.row) return;
  if (alarm == CommunicationError::Alarm::kLine) {
    raise("E.OP3", at(now_s, "communication line lost for longer than Pr.500, judged"));
  } else if (alarm == CommunicationError::Alarm::kOption) {
    raise("E.3",
          at(now_s, causes_.option ? "no contact to the option board" : "the option board reports a fault of its own"));
  } else if (option_fitted_ && connector_ != 3) {
    raise(connector_ == 1 ? "E.1" : "E.2", at(now_s, "the network option is in the wrong connector, seen"));
  }
  if (!v_.alarm.row) follow_causes_of_its_own();
}

// Pr.875 = 1: the motor decelerates first.
void A700Inverter::follow_late_alarm() {
  if (s_.late_alarm == LateAlarm::kNone && settings_.motor_alarms_wait) {
    if (s_.thermal_relay_open) s_.late_alarm = LateAlarm::kThermalRelay;
    const bool thermal = running() && settings_.electronic_thermal_a_rms > 0;
    if (thermal && core_.outputs().motor_thermal_fraction >= 1) s_.late_alarm = LateAlarm::kMotorThermal;
  }
  if (s_.late_alarm == LateAlarm::kNone || running()) return;
  const double now_s = to_seconds(now_);
  switch (s_.late_alarm) {
    case LateAlarm::kMotorThermal: raise("E.THM", at(now_s, "motor thermal, after the stop of Pr.875 = 1")); break;
    case LateAlarm::kThermalRelay: raise("E.OHT", at(now_s, "thermal relay open, after the stop of Pr.875 = 1")); break;
    case LateAlarm::kThermistor: raise("E.PTC", at(now_s, "thermistor hot, after the stop of Pr.875 = 1")); break;
    case LateAlarm::kNone: break;
  }
  s_.late_alarm = LateAlarm::kNone;
}

void A700Inverter::follow_causes_of_its_own() {
  follow_late_alarm();
  if (v_.alarm.row) return;
  const double now_s = to_seconds(now_);
  const drive::DriveOutputs& out = core_.outputs();
  const auto absent = std::count(mains_.phase_present.begin(), mains_.phase_present.end(), false);
  if (s_.phase_lost.step(kPeriod_s, running() && absent == 1 && store_.integer(pr::kInputPhaseLoss) == 1,
                         kPhaseLost_s)) {
    raise("E.ILF", at(now_s, "an input phase is missing with Pr.872 = 1, judged"));
  } else if (s_.thermistor_hot.step(kPeriod_s, has_function(InputSignal::kPtc) && causes_.thermistor,
                                    kThermistorHot_s)) {
    if (settings_.motor_alarms_wait && running()) {
      if (s_.late_alarm == LateAlarm::kNone) s_.late_alarm = LateAlarm::kThermistor;
      return;
    }
    raise("E.PTC", at(now_s, "the thermistor at terminal AU has been hot for 10 s, judged"));
  } else if (out.current_detected && store_.integer(pr::kCurrentDetectionAlarm) == 1) {
    raise("E.CDO", at(now_s, "output current above Pr.150 with Pr.167 = 1"));
  } else if (out.power_failure && !settings_.restart_enabled) {
    const bool blackout = !breaker_ || absent > 1 || mains_.voltage_v_rms < kBlackoutShare * nominal_mains_v_rms_;
    raise(blackout ? "E.IPF" : "E.UVT", at(now_s, blackout ? "the supply failed while running, judged"
                                                           : "the supply was too low while running, judged"));
  } else if (password_shuts_option_out()) {
    raise("E.OPT", at(now_s, "a password with Pr.296 = 0 or 100 and a network option, seen"));
  } else if (settings_.vector.on && settings_.vector.torque_control && store_.integer(pr::kTorqueSource) >= 3) {
    raise("E.OPT", at(now_s, "Pr.804 takes the torque command from an option that is not fitted, seen"));
  } else {
    const bool current_2 = store_.integer(pr::kAnalogSelection) % 10 >= 6;
    const bool current_4 = store_.integer(pr::kTerminal4Input) == 0;
    if ((current_2 && wiring_.at(mitsubishi::AnalogInput::k2) >= 30) ||
        (current_4 && wiring_.at(mitsubishi::AnalogInput::k4) >= 30)) {
      raise("E.AIE", at(now_s, "30 mA or more into an analog current input"));
    }
  }
}

port::AlarmHistory A700Inverter::alarm_history() const {
  port::AlarmHistory history = record_.alarms;
  // Shown in place of the newest while it lasts, not stored (FR-A7NE manual 4.5.1, caution 3).
  if (s_.communication.shown()) history[0] = data_.alarms.rows()[*data_.alarms.by_name("E.OP3")].code;
  return history;
}

// --- network ---

WriteOutcome A700Inverter::decide_family(const WriteRequest& request) {
  if (!network_commands()) return Unexpected(Refusal::kWrongMode);
  switch (request.kind) {
    case WriteRequest::Kind::kFrequency:
    case WriteRequest::Kind::kStoredFrequency:
      if (request.value > kMostFrequency) return Unexpected(Refusal::kOutOfRange);
      if (network_rights().speed == 1) return Unexpected(Refusal::kWrongMode);
      v_.network.frequency_hz = request.value / 100.0;
      if (request.kind == WriteRequest::Kind::kStoredFrequency) {
        record_.counters[kNetworkFrequency] = request.value;
        eeprom_written();
      }
      return {};
    case WriteRequest::Kind::kClearAlarmHistory:
      record_.alarms = {};
      eeprom_written();
      return {};
    default: return Unexpected(Refusal::kNoSuchItem);
  }
}

WriteOutcome A700Inverter::decide_reset(const WriteRequest& request) {
  // FR-A7NE manual 4.6: no reset from the network after a communication line error.
  const bool line_error =
      v_.network.communication_lost || (v_.alarm.row && data_.alarms.rows()[*v_.alarm.row].name == "E.OP3");
  if (line_error) return Unexpected(Refusal::kFaulted);
  if (request.kind == WriteRequest::Kind::kErrorReset) {
    if (!v_.alarm.row) return Unexpected(Refusal::kNotFaulted);
    if (store_.integer(pr::kCommunicationReset) == 1 && v_.mode != OperationMode::kNetwork) {
      return Unexpected(Refusal::kWrongMode);
    }
    return MitsubishiInverter::decide_reset({.kind = WriteRequest::Kind::kResetInverter});
  }
  if (request.value > 1) return Unexpected(Refusal::kOutOfRange);
  if (request.value == 1) return MitsubishiInverter::decide_reset(request);
  if (v_.alarm.row && data_.alarms.rows()[*v_.alarm.row].reset != ResetRule::kAny) return Unexpected(Refusal::kFaulted);
  begin_reset();
  return {};
}

std::uint16_t A700Inverter::network_frequency() const {
  return static_cast<std::uint16_t>(std::lround(v_.network.frequency_hz * 100));
}

// --- parameters ---

bool A700Inverter::in_user_group(unsigned number) const {
  // Pr.160: 0 shows all, 1 the registered ones, 9999 the simple mode's. Pr.77 and Pr.160 themselves stay in reach.
  if (number == pr::kUserGroup || number == pr::kWriteDisable || store_.value(pr::kUserGroup) == 0) return true;
  if (!store_.is_9999(pr::kUserGroup)) return record_.groups[0].contains(static_cast<std::uint16_t>(number));
  static constexpr unsigned kSimple[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 79, 125, 126};
  return std::find(std::begin(kSimple), std::end(kSimple), number) != std::end(kSimple);
}

std::optional<Refusal> A700Inverter::command_parameter(unsigned number, std::int32_t raw) {
  switch (number) {
    case pr::kRetryCount: record_.retry_count = 0; break;
    case pr::kEnergyClear:
      // 10 and 9999 choose how far the meter goes; 0 sets it back.
      if (raw != 0) break;
      record_.counters[kEnergyJoule] = 0;
      s_.energy_j = 0;
      break;
    case pr::kHourMeterClear:
      if (raw != 0) break;
      record_.operating_seconds = 0;
      v_.operating_s = 0;
      break;
    case pr::kGroupBatch:
      if (raw == kRaw9999) {
        record_.groups[0].clear();
      } else if (raw != 0) {
        return Refusal::kOutOfRange;  // the number of registered parameters is for reading
      }
      break;
    case pr::kGroupAdd: return raw == kRaw9999 ? std::nullopt : group_command(0, true, raw);
    case pr::kGroupRemove: return group_command(0, false, raw);
    case pr::kErrorCount:
      s_.line_errors = 0;
      record_.counters[kLineErrors] = 0;
      break;
    case pr::kMainCapacitorMeasuring: record_.counters[kMainCapacitorMeasuring] = raw; break;
    case pr::kPassword: return enter_password(raw);
    case pr::kMaintenanceTimer:
      if (raw != 0) return Refusal::kOutOfRange;
      keep_whole_seconds(record_);
      record_.counters[kMaintenanceSeconds] = 0;
      break;
    default: break;
  }
  return std::nullopt;
}

std::int32_t A700Inverter::command_value(unsigned number) const {
  const std::int64_t energized_h = (record_.counters[kEnergizedSeconds] + static_cast<std::int64_t>(s_.energized_s)) /
                                   static_cast<std::int64_t>(kHour_s);
  const std::int64_t operated_h =
      (record_.operating_seconds + static_cast<std::int64_t>(v_.operating_s)) / static_cast<std::int64_t>(kHour_s);
  switch (number) {
    case pr::kRetryCount: return record_.retry_count;
    case pr::kEnergyClear:
    case pr::kHourMeterClear:
    case pr::kGroupAdd:
    case pr::kGroupRemove:
    case pr::kSavingClear: return kRaw9999;
    case pr::kGroupBatch: return record_.groups[0].count;
    case pr::kErrorCount: return static_cast<std::int32_t>(std::min<std::int64_t>(s_.line_errors, 65535));
    case pr::kLifeAlarm: return life_alarms();
    case pr::kInrushLife:
    case pr::kControlCapacitorLife:
    case pr::kMainCapacitorLife: return part_percent(number);
    case pr::kMainCapacitorMeasuring: return static_cast<std::int32_t>(record_.counters[kMainCapacitorMeasuring]);
    case pr::kPassword: return shown_password();
    case pr::kMaintenanceTimer:
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(
          (record_.counters[kMaintenanceSeconds] + static_cast<std::int64_t>(s_.energized_s)) / 360000, 0, 9998));
    case pr::kEnergizedCarry: return static_cast<std::int32_t>(std::min<std::int64_t>(energized_h / kCarry_h, 65535));
    case pr::kOperatedCarry: return static_cast<std::int32_t>(std::min<std::int64_t>(operated_h / kCarry_h, 65535));
    default: return 0;
  }
}

// Pr.125 and Pr.903 (frequency) are one value, as are Pr.126 and Pr.905.
void A700Inverter::link_parameters(unsigned number, Storage storage) {
  switch (number) {
    case pr::kVoltageInputGain: copy_parameter({pr::kVoltageInputGain, 0}, {pr::kVoltageGain, 1}, storage); break;
    case pr::kVoltageGain: copy_parameter({pr::kVoltageGain, 1}, {pr::kVoltageInputGain, 0}, storage); break;
    case pr::kCurrentInputGain: copy_parameter({pr::kCurrentInputGain, 0}, {pr::kCurrentGain, 1}, storage); break;
    // One torque command, of which Pr.806 is kept.
    case pr::kTorqueCommandRam:
      copy_parameter({pr::kTorqueCommandRam, 0}, {pr::kTorqueCommand, 0}, Storage::kRamOnly);
      break;
    case pr::kTorqueCommand:
      copy_parameter({pr::kTorqueCommand, 0}, {pr::kTorqueCommandRam, 0}, Storage::kRamOnly);
      break;
    case pr::kCurrentGain: copy_parameter({pr::kCurrentGain, 1}, {pr::kCurrentInputGain, 0}, storage); break;
    default: break;
  }
}

}  // namespace vinv::inverter::a700
