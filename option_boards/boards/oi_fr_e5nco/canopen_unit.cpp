// What happens by itself: NMT and guarding, the write queue, alarms and emergency messages.
#include "option_boards/boards/oi_fr_e5nco/canopen_unit.hpp"

#include <algorithm>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "option_boards/boards/oi_fr_e5nco/emergency_codes.hpp"
#include "option_boards/boards/oi_fr_e5nco/words.hpp"

namespace vinv::boards::oi_fr_e5nco {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::PdoFault;
using canopen::WriteResult;
using port::NetTerminal;
using port::Refusal;
using Kind = port::WriteRequest::Kind;

namespace {

constexpr port::ParameterId kRlFunction{180, 0};
constexpr std::uint32_t kSecondFunction = 3;                           // RT
constexpr std::uint8_t kStorageAlarm = 0xb0;                           // E.PE
constexpr std::int16_t kAbortDisableVoltage = 2, kAbortQuickStop = 3;  // 7.4

}  // namespace

void CanopenUnit::start(Instant now, std::uint8_t node, std::uint32_t bit_rate) {
  state_ = State{};
  state_.supplied = true;
  state_.bit_rate = bit_rate;
  state_.history = drive_.alarm_history();
  if (node != 0) slave_.start(now, node);
}

void CanopenUnit::stop() {
  static_assert(std::is_trivially_copyable_v<State>);  // so that a copy of it is a snapshot
  slave_.stop();
  queue_.clear();
  state_ = State{};
}

std::string_view CanopenUnit::led() const {
  if (!state_.supplied) return "off";
  // Unspecified: which failures are "irrecoverable": no valid address, and a controller that is bus-off.
  if (node() == 0 || state_.bus_off) return "red";
  switch (slave_.state()) {
    case NmtState::kOperational: return "green";
    case NmtState::kStopped: return "red flashing";
    default: return "green flashing";
  }
}

// 7.4: bus-off, too, is a lost connection to the network.
void CanopenUnit::set_bus_off(Instant now, bool bus_off) {
  const bool before = std::exchange(state_.bus_off, bus_off);
  if (!bus_off || before) return;
  react_to_abort();
  pump(now);
}

void CanopenUnit::handle_frame(Instant now, const CanFrame& frame) {
  slave_.handle_frame(now, frame);
  pump(now);
}

void CanopenUnit::handle_timeout(Instant now) {
  if (state_.alarm_shows_at && now >= *state_.alarm_shows_at) {
    state_.alarm_shows_at.reset();
    state_.alarm_shown = state_.alarm_seen;
    state_.history = drive_.alarm_history();
    send_emergency(emergency_code_of(state_.alarm_shown).error_code,
                   state_.alarm_shown == kStorageAlarm ? kStoringError : kSystemAlarm, state_.alarm_shown);
  }
  slave_.handle_timeout(now);
  pump(now);
}

std::optional<Instant> CanopenUnit::next_deadline() const {
  const auto of_slave = slave_.next_deadline();
  if (!state_.alarm_shows_at) return of_slave;
  return of_slave ? std::min(*of_slave, *state_.alarm_shows_at) : state_.alarm_shows_at;
}

void CanopenUnit::handle_drive_tick(Instant now) {
  pump(now);
  if (!state_.supplied) return;
  follow_alarm(now);
  report_storing();
  const bool was_ready = std::exchange(state_.inverter_ready, drive_.ready());
  if (was_ready && !state_.inverter_ready) state_.profile.on_restart();
  state_.profile.follow(state_.alarm_seen != 0, drive_.status().running);
  leave_network(now);
  slave_.handle_new_data(now);
}

void CanopenUnit::pump(Instant now) {
  while (const auto finished = queue_.advance(now, drive_)) on_finished(now, *finished);
}

void CanopenUnit::on_finished(Instant now, const FinishedWrite& write) {
  const WriteJob& job = write.job;
  const Kind kind = job.steps[0].kind;
  // A reset that took the mailbox with it was carried out.
  const bool carried_out = write.outcome || (write.lost && kind == Kind::kResetInverter);
  if (!carried_out) {
    if (job.enables) state_.profile.on_run_refused();
    if (job.target_before) state_.target_velocity = *job.target_before;
  }
  if (write.storage_failed) {
    state_.storing_failed = true;
  } else if (carried_out && kind == Kind::kParameter) {
    state_.storing_told = false;
  }
  if (job.origin == WriteOrigin::kSdo) {
    if (!carried_out) {
      slave_.complete_download(
          Unexpected(write.lost ? canopen::AbortCode::kGeneralError : abort_code_of(write.outcome.error())));
    } else if (write.storage_failed) {
      slave_.complete_download(Unexpected(canopen::AbortCode::kHardwareError));
    } else {
      slave_.complete_download({});
    }
    return;
  }
  if (carried_out) {
    auto& told = state_.refused[static_cast<std::size_t>(job.topic)];
    if (told && told->parameter == job.steps[0].parameter) told.reset();
  } else if (job.origin != WriteOrigin::kInternal) {
    report_refusal(job.topic, job.steps[0].parameter, write.outcome.error(), job.origin == WriteOrigin::kNmt);
  } else if (kind == Kind::kOperationMode) {
    state_.leave_next_at = now + kLeaveRetryInterval;
  }
}

void CanopenUnit::report_refusal(WriteTopic topic, port::ParameterId parameter, Refusal refusal, bool always) {
  const CommandError reason =
      command_error_of(refusal, {drive_.operation_mode(), drive_.status().running, drive_.start_signals()});
  auto& told = state_.refused[static_cast<std::size_t>(topic)];
  const RefusedTopic now{reason, parameter};
  if (!always && told == now) return;
  told = now;
  send_emergency(kGenericError, kCommandError, static_cast<std::uint8_t>(reason));
}

void CanopenUnit::send_emergency(std::uint16_t error_code, std::uint8_t system_error, std::uint8_t detail) {
  slave_.send_emergency({error_code, {system_error, detail, static_cast<std::uint8_t>(slave_.state()), 0, 0}});
}

std::uint8_t CanopenUnit::error_register() const {
  std::uint8_t bits = state_.alarm_shown == 0 ? 0 : emergency_code_of(state_.alarm_shown).error_register;
  if (state_.guarding_lost || state_.short_rpdos != 0) bits |= kCommunicationErrorBits;
  return bits;
}

// Alarm codes and the history with the new alarm are there 40 ms after the alarm (7.1.1).
void CanopenUnit::follow_alarm(Instant now) {
  const std::uint8_t alarm = drive_.active_alarm();
  if (alarm != state_.alarm_seen) {
    state_.alarm_seen = alarm;
    state_.alarm_shows_at.reset();
    if (alarm != 0) {
      state_.alarm_shows_at = now + kAlarmDelay;
    } else if (state_.alarm_shown != 0) {
      state_.alarm_shown = 0;
      send_emergency(kErrorReset, 0, 0);
    }
  }
  if (!state_.alarm_shows_at) state_.history = drive_.alarm_history();
}

// The inverter's storage alarm says so itself, unless another alarm hides it.
void CanopenUnit::report_storing() {
  if (!std::exchange(state_.storing_failed, false)) return;
  const bool told = std::exchange(state_.storing_told, true);
  if (told || state_.alarm_seen == kStorageAlarm) return;
  send_emergency(emergency_code_of(kStorageAlarm).error_code, kStoringError, 0);
}

void CanopenUnit::on_nmt_command(Instant now, NmtCommand command, NmtState before) {
  state_.refused = {};
  if (command == NmtCommand::kResetNode || command == NmtCommand::kResetCommunication) {
    state_.guarding_lost = false;
    state_.short_rpdos = 0;
  }
  const bool network = drive_.operation_mode() == port::OperationMode::kNetwork;
  if (command == NmtCommand::kStart) {
    state_.leaves_since.reset();
    if (network && !queue_.holds(WriteTopic::kMode)) return;
    WriteJob job{.origin = WriteOrigin::kNmt, .topic = WriteTopic::kMode};
    job.add({.kind = Kind::kOperationMode, .value = 1});
    if (!queue_.put(job)) report_refusal(WriteTopic::kMode, {}, Refusal::kBusy, true);
    return;
  }
  // 4.2: any other command takes the network mode away, and the motor must not go on unattended.
  if (before == NmtState::kOperational) react_to_abort();
  state_.leaves_since = now;
  state_.leave_next_at.reset();
  if (command == NmtCommand::kResetNode) {
    state_.profile = DriveProfile{};
    state_.target_velocity = 0;
    state_.runs_reverse = false;
    state_.abort_option = 0;
  }
}

void CanopenUnit::on_mode_of_other_master(Instant asked_at) {
  if (state_.leaves_since && asked_at >= *state_.leaves_since) state_.leaves_since.reset();
}

// At standstill with the start signals off; until then, and while the inverter starts up, it waits.
void CanopenUnit::leave_network(Instant now) {
  if (!state_.leaves_since || !drive_.ready() || queue_.holds(WriteTopic::kMode)) return;
  if (drive_.operation_mode() != port::OperationMode::kNetwork) {
    state_.leaves_since.reset();
    return;
  }
  if (drive_.status().running || drive_.start_signals().bits != 0) return;
  if (state_.leave_next_at && now < *state_.leave_next_at) return;
  state_.leave_next_at.reset();
  WriteJob job{.origin = WriteOrigin::kInternal, .topic = WriteTopic::kMode};
  job.add({.kind = Kind::kOperationMode, .value = 0});
  queue_.put(job);
}

void CanopenUnit::on_guarding(Instant /*now*/, bool lost) {
  state_.guarding_lost = lost;
  if (!lost) {
    send_emergency(kErrorReset, 0, 0);
    return;
  }
  send_emergency(kLifeGuardError, kLifeTimeExpired, 0);
  react_to_abort();
}

void CanopenUnit::on_pdo_fault(Instant /*now*/, PdoFault fault, unsigned pdo) {
  const auto bit = static_cast<std::uint8_t>(1u << pdo);
  switch (fault) {
    case PdoFault::kRpdoTooShort:
      state_.short_rpdos |= bit;
      send_emergency(kPdoLengthError, kReceivePdoError, 0);
      break;
    case PdoFault::kRpdoGoodAgain:
      state_.short_rpdos &= static_cast<std::uint8_t>(~bit);
      if (state_.short_rpdos == 0) send_emergency(kErrorReset, 0, 0);
      break;
    case PdoFault::kTpdoNotSampled: send_emergency(kProtocolError, kTransmitPdoError, 0); break;
  }
}

// 6007H: what becomes of a motor that the network commanded.
void CanopenUnit::react_to_abort() {
  if (drive_.operation_mode() != port::OperationMode::kNetwork) return;
  DriveAction action = DriveAction::kNone;
  if (state_.abort_option == kAbortDisableVoltage) {
    state_.profile.disable_voltage();
    action = DriveAction::kCoast;
  } else if (state_.abort_option == kAbortQuickStop) {
    state_.profile.quick_stop();
    action = DriveAction::kQuickStop;
  }
  if (action == DriveAction::kNone) return;
  WriteJob job = action_job(action);
  job.origin = WriteOrigin::kInternal;
  queue_.put_first(job);
}

// Frequency and direction of the velocity mode.
WriteJob CanopenUnit::run_job() const {
  WriteJob job{.topic = WriteTopic::kRun};
  const auto rpm = static_cast<std::uint32_t>(std::abs(int{state_.target_velocity}));
  job.add({.kind = Kind::kFrequency, .value = raw_frequency_of_rpm(rpm, poles_of(drive_))});
  port::WriteRequest command{.kind = Kind::kCommand};
  const NetTerminal direction = state_.runs_reverse ? NetTerminal::kStr : NetTerminal::kStf;
  if (!state_.profile.halted()) command.terminals.set(direction, true);
  job.add(command);
  return job;
}

WriteJob CanopenUnit::action_job(DriveAction action) const {
  if (action == DriveAction::kRun) return run_job();
  WriteJob job{.topic = WriteTopic::kRun};
  port::WriteRequest command{.kind = Kind::kCommand};
  switch (action) {
    case DriveAction::kCoast: command.terminals.set(NetTerminal::kMrs, true); break;
    case DriveAction::kQuickStop:
      // 7.12.2: the second function chooses the ramp, if terminal RL has it; else the normal one stops the motor.
      command.terminals.set(NetTerminal::kRl, drive_.read_parameter(kRlFunction).value_or(0u) == kSecondFunction);
      break;
    case DriveAction::kReset:
      job.topic = WriteTopic::kOther;
      command.kind = Kind::kResetInverter;
      break;
    default: break;
  }
  job.add(command);
  return job;
}

}  // namespace vinv::boards::oi_fr_e5nco
