// What the FR-E500 shows, stores and answers in its own way. OI-FR-E5NCO manual 4.2 and 8.7; the rest typical for the
// family.
#include "motor_model/inverter/e500/inverter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/e500/parameter_numbers.hpp"
#include "motor_model/inverter/e500/settings.hpp"

namespace vinv::inverter::e500 {

using port::OperationMode;
using port::Refusal;
using port::WriteOutcome;
using port::WriteRequest;

namespace {

constexpr double kMachineSpeedBase_hz = 60;  // Pr.37 is the machine speed at this frequency
constexpr double kAmFullScale_v = 10;
constexpr std::uint32_t kMostFrequency = 40000;  // 0.01 Hz

std::string digits(const char* pattern, double value) {
  char text[32];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

}  // namespace

// --- operation mode, settings ---

ModeSituation E500Inverter::mode_situation() const {
  const InputSignals wired = wired_signals();
  ModeSituation s;
  s.raw_pr79 = store_.integer(pr::kOperationMode);
  s.raw_pr340 = store_.integer(pr::kLinkStart);
  s.interlock_off = wired.has(InputSignal::kMrs);
  s.x16 = wired.has(InputSignal::kX16);
  s.option_fitted = option_fitted_;
  s.stopped = !running();
  // The terminals as they are now; what came through mailbox and keys since the last tick counts too.
  s.start_signal = start_signals().bits != 0;
  return s;
}

mitsubishi::SettingsSelection E500Inverter::selection(const mitsubishi::Inputs& in) const {
  const bool jog = jogging();
  return {
      .second = in.signals.has(InputSignal::kRt) && !jog, .jog = jog, .vf_by_x18 = in.signals.has(InputSignal::kX18)};
}

drive::DriveSettings E500Inverter::make_settings(const mitsubishi::SettingsSelection& selection) const {
  return e500::make_settings(store_, selection, surroundings());
}

// --- network ---

Result<std::uint16_t, Refusal> E500Inverter::read_monitor(unsigned number) const {
  switch (number) {
    case 1: return v_.published.output_frequency;
    case 2: return v_.published.output_current;
    case 3: return v_.published.output_voltage;
    default: return Unexpected(Refusal::kNoSuchItem);
  }
}

void E500Inverter::follow_communication() {
  if (v_.alarm.row) return;
  const double at_s = to_seconds(now_);
  const bool network = v_.mode == OperationMode::kNetwork;
  char when[40];
  std::snprintf(when, sizeof when, "at %.3f s", at_s);
  if (causes_.option) {
    raise("E.OPT", std::string("the option board dropped out ") + when);
  } else if (v_.network.option_failed && network) {
    raise("E.3", std::string("the option board reports a fault of its own ") + when + " in network operation");
  } else if (v_.network.communication_lost && network) {
    raise("E.OP3", std::string("communication of the option board lost ") + when + " in network operation");
  }
}

WriteOutcome E500Inverter::decide_family(const WriteRequest& request) {
  switch (request.kind) {
    case WriteRequest::Kind::kFrequency:
      if (request.value > kMostFrequency) return Unexpected(Refusal::kOutOfRange);
      if (store_.integer(pr::kSpeedRight) != 0) return Unexpected(Refusal::kWrongMode);
      v_.network.frequency_hz = request.value / 100.0;
      return {};
    case WriteRequest::Kind::kAnalogReference:
      if (request.value > 255) return Unexpected(Refusal::kOutOfRange);
      // The converter stands for terminal 2, which sets the speed only with Pr.339 = 1 (8.7.8).
      if (store_.integer(pr::kSpeedRight) != 1) return Unexpected(Refusal::kWrongMode);
      v_.network.converter = static_cast<std::uint8_t>(request.value);
      return {};
    default: return Unexpected(Refusal::kNoSuchItem);
  }
}

// --- parameters ---

bool E500Inverter::in_user_group(unsigned number) const {
  const int selection = store_.integer(pr::kUserGroup);
  // Pr.77 and Pr.160 themselves stay in reach.
  if (selection == 0 || number == pr::kUserGroup || number == pr::kWriteDisable) return true;
  const auto n = static_cast<std::uint16_t>(number);
  const bool first = selection == 1 || selection == 11;
  const bool second = selection == 10 || selection == 11;
  return (first && record_.groups[0].contains(n)) || (second && record_.groups[1].contains(n));
}

std::optional<Refusal> E500Inverter::command_parameter(unsigned number, std::int32_t raw) {
  switch (number) {
    case pr::kRetryCount: record_.retry_count = 0; break;
    case pr::kHourMeterClear:
      record_.operating_seconds = 0;
      v_.operating_s = 0;
      break;
    case pr::kGroup1Add: return group_command(0, true, raw);
    case pr::kGroup1Remove: return group_command(0, false, raw);
    case pr::kGroup2Add: return group_command(1, true, raw);
    case pr::kGroup2Remove: return group_command(1, false, raw);
    default: break;
  }
  return std::nullopt;
}

std::int32_t E500Inverter::command_value(unsigned number) const {
  return number == pr::kRetryCount ? record_.retry_count : 0;
}

// Pr.38 and Pr.903 (frequency) are one value, as are Pr.39 and Pr.905: the full scale that OI-FR-E5NCO manual 8.7.8
// says both establish.
void E500Inverter::link_parameters(unsigned number, Storage storage) {
  switch (number) {
    case pr::kVoltageInputGain: copy_parameter({pr::kVoltageInputGain, 0}, {pr::kVoltageGain, 1}, storage); break;
    case pr::kVoltageGain: copy_parameter({pr::kVoltageGain, 1}, {pr::kVoltageInputGain, 0}, storage); break;
    case pr::kCurrentInputGain: copy_parameter({pr::kCurrentInputGain, 0}, {pr::kCurrentGain, 1}, storage); break;
    case pr::kCurrentGain: copy_parameter({pr::kCurrentGain, 1}, {pr::kCurrentInputGain, 0}, storage); break;
    default: break;
  }
}

// --- outputs ---

void E500Inverter::publish_family(OutputSignals&) {
  mitsubishi::Published& p = v_.published;
  double share = 0;
  const auto ratio = [](double value, double full_scale) { return full_scale > 0 ? value / full_scale : 0; };
  switch (store_.integer(pr::kAmSelection)) {
    case 1: share = ratio(v_.current_monitor.output, store_.value(pr::kCurrentFullScale)); break;
    case 2: share = ratio(measured().gates_on ? measured().output_voltage_v_rms : 0, 2 * model_.voltage_class_v); break;
    default: share = ratio(std::abs(core_.outputs().output_frequency_hz), store_.value(pr::kFrequencyFullScale));
  }
  p.am_v = std::clamp(share * kAmFullScale_v * store_.value(pr::kAmCalibration) / 100, 0.0, kAmFullScale_v);
}

std::string E500Inverter::display() const {
  if (!control_alive_) return "";
  if (v_.in_reset) return "Err.";
  if (now_ < v_.ready_at) return "----";
  if (v_.alarm.row) return alarm_name();
  if (v_.panel.stopped_by_panel) return "PS";
  if (v_.panel.screen == mitsubishi::Screen::kFrequency) return digits("%.2f", v_.panel.edited_hz);
  if (v_.panel.screen == mitsubishi::Screen::kJog && !running()) return "JOG";
  const mitsubishi::Published& p = v_.published;
  if (v_.panel.monitor == 1) return digits("%.2f", p.output_current / 100.0);
  if (v_.panel.monitor == 2) return digits("%.1f", p.output_voltage / 10.0);
  const int selection = store_.integer(pr::kDisplay);
  if (selection == 23) {
    const auto seconds = static_cast<double>(record_.operating_seconds) + v_.operating_s;
    return digits("%.0f", std::floor(seconds / 3600));
  }
  double hz = p.output_frequency / 100.0;
  if (selection == 100 && !p.status.running) hz = p.set_frequency_hz;
  const double machine_speed = store_.value(pr::kSpeedDisplay);
  if (machine_speed > 0) return digits("%.1f", machine_speed * hz / kMachineSpeedBase_hz);
  return digits("%.2f", hz);
}

}  // namespace vinv::inverter::e500
