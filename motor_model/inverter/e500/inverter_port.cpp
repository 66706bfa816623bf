// What the option board sees: reads of what the last tick published, writes through the mailbox.
// OI-FR-E5NCO manual 4.2 (modes), 8.7 (commands, monitors, parameters, resets).
#include <cmath>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/parameter_numbers.hpp"

namespace vinv::inverter::e500 {

using port::NetTerminal;
using port::OperationMode;
using port::Refusal;
using port::WriteOutcome;
using port::WriteRequest;

namespace {

constexpr std::uint32_t kMostFrequency = 40000;  // 0.01 Hz

}  // namespace

bool E500Inverter::ready() const { return control_alive_ && now_ >= v_.ready_at && !v_.in_reset; }

Result<std::uint16_t, Refusal> E500Inverter::read_monitor(unsigned number) const {
  switch (number) {
    case 1: return v_.published.output_frequency;
    case 2: return v_.published.output_current;
    case 3: return v_.published.output_voltage;
    default: return Unexpected(Refusal::kNoSuchItem);
  }
}

Result<std::uint32_t, Refusal> E500Inverter::read_parameter(port::ParameterId id) const {
  if (!control_alive_) return Unexpected(Refusal::kNotReady);
  const auto row = data_.parameters.index(id);
  if (!row) return Unexpected(Refusal::kNoSuchItem);
  return static_cast<std::uint32_t>(shown_raw(*row));
}

std::uint8_t E500Inverter::active_alarm() const {
  return v_.alarm.row && alarm_visible() ? data_.alarms.rows()[*v_.alarm.row].code : std::uint8_t{0};
}

port::NetTerminals E500Inverter::start_signals() const {
  using drive::RunDirection;
  const auto& command = v_.network.command;
  const auto on = [&](Terminal wired, NetTerminal of_network, RunDirection direction) {
    return wiring_.closed[wired] || command.has(of_network) || v_.panel.run == direction || v_.direction == direction;
  };
  port::NetTerminals signals;
  signals.set(NetTerminal::kStf, on(kStf, NetTerminal::kStf, RunDirection::kForward));
  signals.set(NetTerminal::kStr, on(kStr, NetTerminal::kStr, RunDirection::kReverse));
  return signals;
}

WriteOutcome E500Inverter::post_write(Instant, const WriteRequest& request) {
  if (!ready()) return Unexpected(Refusal::kNotReady);
  return v_.mailbox.post(request);
}

WriteOutcome E500Inverter::decide(const WriteRequest& request) {
  if (!ready()) return Unexpected(Refusal::kNotReady);
  const bool network = v_.mode == OperationMode::kNetwork;
  switch (request.kind) {
    case WriteRequest::Kind::kOperationMode:
      if (request.value > 1) return Unexpected(Refusal::kOutOfRange);
      return decide_mode(request.value == 1);
    case WriteRequest::Kind::kParameter: {
      const auto row = data_.parameters.index(request.parameter);
      if (!row) return Unexpected(Refusal::kNoSuchItem);
      if (const auto refusal = write_refusal(data_.parameters.rows()[*row], access(Writer::kNetwork))) {
        return Unexpected(*refusal);
      }
      if (request.value > INT32_MAX || !data_.parameters.rows()[*row].accepts(request.value)) {
        return Unexpected(Refusal::kOutOfRange);
      }
      const Storage storage = store_.integer(pr::kEepromWrite) == 1 ? Storage::kRamOnly : Storage::kRamAndEeprom;
      const auto refusal = write_parameter(*row, static_cast<std::int32_t>(request.value), storage);
      return refusal ? WriteOutcome(Unexpected(*refusal)) : WriteOutcome();
    }
    case WriteRequest::Kind::kRestoreDefaults: {
      if (request.value > 1) return Unexpected(Refusal::kOutOfRange);
      if (const auto refusal = clear_refusal(access(Writer::kNetwork))) return Unexpected(*refusal);
      clear_parameters(request.value == 0 ? ClearKind::kParameterClear : ClearKind::kAllClear);
      return {};
    }
    default: break;
  }
  // Before any other command NET operation must be on (8.7, note).
  if (!network) return Unexpected(Refusal::kWrongMode);
  switch (request.kind) {
    case WriteRequest::Kind::kCommand: return decide_command(request.terminals);
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
    case WriteRequest::Kind::kClearAlarmHistory:
      record_.alarms = {};
      eeprom_written();
      return {};
    case WriteRequest::Kind::kResetInverter:
      if (!reset_accepted()) return Unexpected(v_.alarm.row ? Refusal::kFaulted : Refusal::kNotFaulted);
      begin_reset();
      return {};
    default: break;
  }
  return Unexpected(Refusal::kNoSuchItem);
}

WriteOutcome E500Inverter::decide_mode(bool network) {
  const auto next =
      request_mode(v_.mode, network ? ModeRequest::kNetworkOn : ModeRequest::kNetworkOff, mode_situation());
  if (!next) return Unexpected(next.error());
  if (*next != v_.mode) change_mode(*next);
  return {};
}

WriteOutcome E500Inverter::decide_command(port::NetTerminals terminals) {
  const bool starts = terminals.has(NetTerminal::kStf) || terminals.has(NetTerminal::kStr);
  if (starts && store_.integer(pr::kOperationRight) != 0) return Unexpected(Refusal::kWrongMode);
  v_.network.command = terminals;
  return {};
}

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

}  // namespace vinv::inverter::e500
