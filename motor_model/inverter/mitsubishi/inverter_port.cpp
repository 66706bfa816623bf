// What the option board sees: reads of what the last tick published, writes through the mailbox.
// OI-FR-E5NCO manual 4.2 (modes), 8.7 (commands, monitors, parameters, resets).
#include <cmath>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::mitsubishi {

using port::NetTerminal;
using port::OperationMode;
using port::Refusal;
using port::WriteOutcome;
using port::WriteRequest;

bool MitsubishiInverter::ready() const { return control_alive_ && now_ >= v_.ready_at && !v_.in_reset; }

Result<std::uint32_t, Refusal> MitsubishiInverter::read_parameter(port::ParameterId id) const {
  if (!control_alive_) return Unexpected(Refusal::kNotReady);
  const auto row = data_.parameters.index(id);
  if (!row) return Unexpected(Refusal::kNoSuchItem);
  if (locked(Writer::kNetwork, id.number, false)) return Unexpected(Refusal::kWriteDisabled);
  return static_cast<std::uint32_t>(shown_raw(*row));
}

std::uint8_t MitsubishiInverter::active_alarm() const {
  return v_.alarm.row && alarm_visible() ? data_.alarms.rows()[*v_.alarm.row].code : std::uint8_t{0};
}

port::NetTerminals MitsubishiInverter::start_signals() const {
  using drive::RunDirection;
  const auto& command = v_.network.command;
  const InputSignals wired = assigned(wiring_.closed);
  const InputSignals of_network = assigned(command);
  const auto on = [&](InputSignal signal, RunDirection direction) {
    return wired.has(signal) || of_network.has(signal) || v_.panel.run == direction || v_.direction == direction;
  };
  port::NetTerminals signals;
  signals.set(NetTerminal::kStf, on(InputSignal::kStf, RunDirection::kForward));
  signals.set(NetTerminal::kStr, on(InputSignal::kStr, RunDirection::kReverse));
  return signals;
}

WriteOutcome MitsubishiInverter::post_write(Instant, const WriteRequest& request) {
  if (!ready()) return Unexpected(Refusal::kNotReady);
  return v_.mailbox.post(request);
}

WriteOutcome MitsubishiInverter::decide(const WriteRequest& request) {
  if (!ready()) return Unexpected(Refusal::kNotReady);
  const bool network = v_.mode == OperationMode::kNetwork;
  switch (request.kind) {
    case WriteRequest::Kind::kOperationMode:
      if (request.value >= personality_.mode_writes) return Unexpected(Refusal::kOutOfRange);
      return decide_mode(request.value == 1   ? ModeRequest::kNetworkOn
                         : request.value == 2 ? ModeRequest::kPanelByNetwork
                                              : ModeRequest::kNetworkOff);
    case WriteRequest::Kind::kParameter: {
      const auto row = data_.parameters.index(request.parameter);
      if (!row) return Unexpected(Refusal::kNoSuchItem);
      if (const auto refusal = write_refusal(data_.parameters.rows()[*row], access(Writer::kNetwork))) {
        return Unexpected(*refusal);
      }
      if (request.value > INT32_MAX || !data_.parameters.rows()[*row].accepts(request.value)) {
        return Unexpected(Refusal::kOutOfRange);
      }
      if (locked(Writer::kNetwork, request.parameter.number, true)) return Unexpected(Refusal::kWriteDisabled);
      if (not_fitted(request.parameter.number, static_cast<std::int32_t>(request.value))) {
        return Unexpected(Refusal::kOutOfRange);
      }
      const Storage storage = store_.integer(pr::kEepromWrite) == 1 ? Storage::kRamOnly : Storage::kRamAndEeprom;
      const auto refusal = write_parameter(*row, static_cast<std::int32_t>(request.value), storage);
      return refusal ? WriteOutcome(Unexpected(*refusal)) : WriteOutcome();
    }
    case WriteRequest::Kind::kRestoreDefaults: {
      if (request.value >= personality_.clear_writes) return Unexpected(Refusal::kOutOfRange);
      if (const auto refusal = clear_refusal(access(Writer::kNetwork))) return Unexpected(*refusal);
      clear_parameters(request.value % 2 == 0 ? ClearKind::kParameterClear : ClearKind::kAllClear, request.value < 2);
      return {};
    }
    case WriteRequest::Kind::kErrorReset: return decide_reset(request);
    default: break;
  }
  // Before any other command NET operation must be on (8.7, note).
  if (!network) return Unexpected(Refusal::kWrongMode);
  switch (request.kind) {
    case WriteRequest::Kind::kCommand: return decide_command(request.terminals);
    case WriteRequest::Kind::kResetInverter: return decide_reset(request);
    case WriteRequest::Kind::kClearAlarmHistory:
      record_.alarms = {};
      eeprom_written();
      return {};
    default: return decide_family(request);
  }
}

WriteOutcome MitsubishiInverter::decide_family(const WriteRequest&) { return Unexpected(Refusal::kNoSuchItem); }

WriteOutcome MitsubishiInverter::decide_reset(const WriteRequest& request) {
  if (request.kind != WriteRequest::Kind::kResetInverter) return Unexpected(Refusal::kNoSuchItem);
  if (!reset_accepted()) return Unexpected(v_.alarm.row ? Refusal::kFaulted : Refusal::kNotFaulted);
  begin_reset();
  return {};
}

WriteOutcome MitsubishiInverter::decide_mode(ModeRequest request) {
  if (!network_commands()) return Unexpected(Refusal::kWrongMode);
  const auto next = requested_mode(request);
  if (!next) return Unexpected(next.error());
  if (*next != v_.mode) change_mode(*next);
  return {};
}

WriteOutcome MitsubishiInverter::decide_command(port::NetTerminals terminals) {
  if (!network_commands()) return Unexpected(Refusal::kWrongMode);
  const bool starts = terminals.has(NetTerminal::kStf) || terminals.has(NetTerminal::kStr);
  if (starts && store_.integer(pr::kOperationRight) != 0) return Unexpected(Refusal::kWrongMode);
  v_.network.command = terminals;
  return {};
}

}  // namespace vinv::inverter::mitsubishi
