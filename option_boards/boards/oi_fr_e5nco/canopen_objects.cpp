// Reads and writes of the board's objects. OI-FR-E5NCO manual, 6.2 and 7.
#include <algorithm>
#include <array>

#include "option_boards/boards/oi_fr_e5nco/canopen_unit.hpp"
#include "option_boards/boards/oi_fr_e5nco/words.hpp"
#include "vinv_boards_data.hpp"

namespace vinv::boards::oi_fr_e5nco {

using canopen::AbortCode;
using canopen::ObjectRow;
using canopen::Origin;
using canopen::WriteResult;
using port::Refusal;
using Kind = port::WriteRequest::Kind;

namespace {

// In the order of ObjectItem.
constexpr std::array<std::string_view, 19> kItemNames{"status_register",
                                                      "restore",
                                                      "monitor",
                                                      "clear_alarms",
                                                      "reset",
                                                      "parameter",
                                                      "alarms",
                                                      "command",
                                                      "speed_hz",
                                                      "speed_rpm",
                                                      "speed_analog",
                                                      "abort_option",
                                                      "controlword",
                                                      "statusword",
                                                      "target_velocity",
                                                      "velocity",
                                                      "frequency_parameter",
                                                      "delta_time",
                                                      "mode_of_operation"};

constexpr std::uint32_t kRaw9999 = 0xffff;
constexpr std::uint32_t kLoadSignature = 0x64616f6c;  // "load", the first character lowest
constexpr std::uint32_t kRestoresOnCommand = 1;
constexpr std::uint16_t kTimeIncrements = 21, kSecondRampTime = 44, kSecondDecelerationTime = 45;

port::ParameterId parameter_of(const ObjectRow& row, std::uint16_t index, std::uint8_t sub) {
  return {static_cast<std::uint16_t>(row.argument + (index - row.first)), sub};
}

}  // namespace

const canopen::ObjectTable& object_table() {
  static const canopen::ObjectTable table(data::OI_FR_E5NCO_OBJECTS, kItemNames);
  return table;
}

bool CanopenUnit::exists(const ObjectRow& row, std::uint16_t index) const {
  if (row.item != kParameter) return true;
  const auto value = drive_.read_parameter(parameter_of(row, index, row.first_sub));
  return value || value.error() != Refusal::kNoSuchItem;
}

// By output direction.
std::int16_t CanopenUnit::velocity_rpm() const {
  constexpr std::uint16_t kMostRpm = 0x7fff;
  const std::uint16_t rpm = rpm_of_raw_frequency(drive_.read_monitor(1).value_or(std::uint16_t{0}), poles_of(drive_));
  const auto magnitude = static_cast<std::int16_t>(std::min(rpm, kMostRpm));
  return drive_.status().reverse ? static_cast<std::int16_t>(-magnitude) : magnitude;
}

Result<std::uint32_t, AbortCode> CanopenUnit::read_parameter(port::ParameterId id) const {
  const auto value = drive_.read_parameter(id);
  if (!value) return Unexpected(abort_code_of(value.error()));
  return *value;
}

// Pr.21: ramp times in 0.1 s or 0.01 s.
std::uint32_t CanopenUnit::increments_per_second() const {
  return drive_.read_parameter({kTimeIncrements, 0}).value_or(0u) == 1 ? 100 : 10;
}

Result<std::uint32_t, AbortCode> CanopenUnit::read_delta_time(std::uint16_t number) const {
  auto raw = read_parameter({number, 0});
  if (raw && number == kSecondDecelerationTime && *raw == kRaw9999) raw = read_parameter({kSecondRampTime, 0});
  if (!raw) return raw;
  return std::min(*raw / increments_per_second(), kMaxWord);
}

Result<std::uint32_t, AbortCode> CanopenUnit::read(const ObjectRow& row, std::uint16_t index, std::uint8_t sub) const {
  // The board's own.
  switch (row.item) {
    case kRestore: return kRestoresOnCommand;
    case kAbortOption: return static_cast<std::uint16_t>(state_.abort_option);
    case kControlword: return state_.profile.controlword();
    case kTargetVelocity: return static_cast<std::uint16_t>(state_.target_velocity);
    case kStatusword: {
      const port::Status status = drive_.status();
      return state_.profile.statusword({.alarm = status.alarm,
                                        .ready = drive_.ready(),
                                        .network_mode = drive_.operation_mode() == port::OperationMode::kNetwork,
                                        .running = status.running,
                                        .up_to_frequency = status.up_to_frequency,
                                        .overload = status.overload});
    }
    default: break;
  }
  if (!drive_.ready()) return Unexpected(abort_code_of(Refusal::kNotReady));
  switch (row.item) {
    case kStatusRegister:
    case kCommand: return raw_status(drive_.status());
    case kAlarms: return raw_alarm_pair(state_.history, static_cast<std::size_t>(index - row.first));
    case kMonitor: {
      const auto value = drive_.read_monitor(row.argument);
      if (!value) return Unexpected(abort_code_of(value.error()));
      return *value;
    }
    case kSpeedHz:
    case kSpeedRpm: {
      const auto value = drive_.read_monitor(1);
      if (!value) return Unexpected(abort_code_of(value.error()));
      return row.item == kSpeedHz ? *value : rpm_of_raw_frequency(*value, poles_of(drive_));
    }
    case kVelocity: return static_cast<std::uint16_t>(velocity_rpm());
    case kParameter: {
      const auto value = read_parameter(parameter_of(row, index, sub));
      // The object is one word; a value that needs more cannot be shown.
      if (value && *value > kMaxWord) return Unexpected(AbortCode::kGeneralError);
      return value;
    }
    case kFrequencyParameter: {
      const auto value = read_parameter({static_cast<std::uint16_t>(row.argument), 0});
      if (!value) return value;
      return nearest_rpm_of_raw_frequency(*value, poles_of(drive_));
    }
    case kDeltaTime: return read_delta_time(static_cast<std::uint16_t>(row.argument));
    default: return Unexpected(AbortCode::kWriteOnly);
  }
}

std::optional<WriteResult> CanopenUnit::write(Instant /*now*/, Origin origin, const ObjectRow& row, std::uint16_t index,
                                              std::uint8_t sub, std::uint32_t raw) {
  const std::int64_t value = row.value_of(raw);
  // SDO values have been checked against the range.
  if (value < row.min || value > row.max) return refuse(origin, WriteTopic::kAnalog, {}, Refusal::kOutOfRange);
  switch (row.item) {
    case kRestore:
      // DS-301, 1011H: another signature is refused with a code 0800002xH.
      if (raw != kLoadSignature) return WriteResult(Unexpected(AbortCode::kDeviceState));
      return write_word(origin, WriteTopic::kOther, {.kind = Kind::kRestoreDefaults, .value = 0});
    case kClearAlarms: return write_word(origin, WriteTopic::kOther, {.kind = Kind::kClearAlarmHistory});
    case kResetInverter: return write_word(origin, WriteTopic::kOther, {.kind = Kind::kResetInverter});
    case kParameter: return write_parameter(origin, parameter_of(row, index, sub), raw);
    case kCommand:
      return write_word(origin, WriteTopic::kRun,
                        {.kind = Kind::kCommand, .terminals = terminals_of_command(static_cast<std::uint16_t>(raw))});
    case kSpeedHz: return write_word(origin, WriteTopic::kFrequency, {.kind = Kind::kFrequency, .value = raw});
    case kSpeedRpm:
      return write_word(origin, WriteTopic::kFrequency,
                        {.kind = Kind::kFrequency, .value = raw_frequency_of_rpm(raw, poles_of(drive_))});
    case kSpeedAnalog: return write_word(origin, WriteTopic::kAnalog, {.kind = Kind::kAnalogReference, .value = raw});
    case kAbortOption:
      if (value == 1) return WriteResult(Unexpected(AbortCode::kValueRange));
      state_.abort_option = static_cast<std::int16_t>(value);
      return WriteResult{};
    case kControlword: return write_controlword(origin, static_cast<std::uint16_t>(raw));
    case kTargetVelocity: return write_target_velocity(origin, static_cast<std::int16_t>(value));
    case kFrequencyParameter:
      return write_parameter(origin, {static_cast<std::uint16_t>(row.argument), 0},
                             raw_frequency_of_rpm(raw, poles_of(drive_)));
    case kDeltaTime:
      return write_parameter(origin, {static_cast<std::uint16_t>(row.argument), 0}, raw * increments_per_second());
    case kModeOfOperation: return WriteResult{};
    default: return WriteResult(Unexpected(AbortCode::kReadOnly));
  }
}

std::optional<WriteResult> CanopenUnit::write_word(Origin origin, WriteTopic topic, const port::WriteRequest& request) {
  // Frequencies are words in the dual-port RAM.
  if (request.value > kMaxWord) return refuse(origin, topic, {}, Refusal::kOutOfRange);
  WriteJob job{.topic = topic};
  job.add(request);
  return submit(origin, job);
}

std::optional<WriteResult> CanopenUnit::write_parameter(Origin origin, port::ParameterId id, std::uint64_t value) {
  if (value > kMaxWord) return refuse(origin, WriteTopic::kParameter, id, Refusal::kOutOfRange);
  WriteJob job{.topic = WriteTopic::kParameter};
  job.add({.kind = Kind::kParameter, .parameter = id, .value = static_cast<std::uint32_t>(value)});
  return submit(origin, job);
}

std::optional<WriteResult> CanopenUnit::write_controlword(Origin origin, std::uint16_t word) {
  const bool was_enabled = state_.profile.state() == DriveState::kOperationEnabled;
  const DriveAction action = state_.profile.handle_controlword(word);
  if (action == DriveAction::kNone) return WriteResult{};
  WriteJob job = action_job(action);
  job.enables = action == DriveAction::kRun && !was_enabled;
  auto result = submit(origin, job);
  if (job.enables && result && !*result) state_.profile.on_run_refused();
  return result;
}

std::optional<WriteResult> CanopenUnit::write_target_velocity(Origin origin, std::int16_t rpm) {
  const std::int16_t before = state_.target_velocity;
  state_.target_velocity = rpm;
  if (rpm != 0) state_.runs_reverse = rpm < 0;
  if (state_.profile.state() != DriveState::kOperationEnabled) return WriteResult{};
  WriteJob job = run_job();
  job.target_before = before;
  auto result = submit(origin, job);
  if (result && !*result) state_.target_velocity = before;
  return result;
}

std::optional<WriteResult> CanopenUnit::submit(Origin origin, WriteJob job) {
  const WriteTopic topic = job.topic;
  const port::ParameterId parameter = job.steps[0].parameter;
  // After an NMT start the mode request waits for the inverter, and what follows it waits too.
  if (!drive_.ready() && !queue_.holds(WriteTopic::kMode)) return refuse(origin, topic, parameter, Refusal::kNotReady);
  job.origin = origin == Origin::kSdo ? WriteOrigin::kSdo : WriteOrigin::kPdo;
  if (!queue_.put(job)) return refuse(origin, topic, parameter, Refusal::kBusy);
  if (origin == Origin::kSdo) return std::nullopt;
  return WriteResult{};
}

std::optional<WriteResult> CanopenUnit::refuse(Origin origin, WriteTopic topic, port::ParameterId parameter,
                                               Refusal refusal) {
  if (origin == Origin::kPdo) report_refusal(topic, parameter, refusal, false);
  return WriteResult(Unexpected(abort_code_of(refusal)));
}

}  // namespace vinv::boards::oi_fr_e5nco
