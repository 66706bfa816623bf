// What the inverter's refusals are called on CANopen: SDO abort codes and the reasons in byte 4 of an EMCY.
// OI-FR-E5NCO manual, 6.1 and 6.3.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/canopen/abort_code.hpp"
#include "sim/base/archive.hpp"

namespace vinv::boards::oi_fr_e5nco {

inline constexpr std::array<std::pair<port::Refusal, canopen::AbortCode>, 12> kAbortCodes{{
    {port::Refusal::kNoSuchItem, canopen::AbortCode::kNoSuchObject},
    {port::Refusal::kOutOfRange, canopen::AbortCode::kValueRange},
    {port::Refusal::kReadOnly, canopen::AbortCode::kReadOnly},
    {port::Refusal::kWriteOnly, canopen::AbortCode::kWriteOnly},
    {port::Refusal::kRunning, canopen::AbortCode::kDeviceState},
    {port::Refusal::kWriteDisabled, canopen::AbortCode::kDeviceState},
    // Somebody else has the command: terminals or panel.
    {port::Refusal::kWrongMode, canopen::AbortCode::kLocalControl},
    {port::Refusal::kModeChangeRefused, canopen::AbortCode::kDeviceState},
    {port::Refusal::kBusy, canopen::AbortCode::kDeviceState},
    {port::Refusal::kNotReady, canopen::AbortCode::kDeviceState},
    {port::Refusal::kFaulted, canopen::AbortCode::kDeviceState},
    {port::Refusal::kNotFaulted, canopen::AbortCode::kDeviceState},
}};

constexpr canopen::AbortCode abort_code_of(port::Refusal refusal) {
  for (const auto& [reason, code] : kAbortCodes) {
    if (reason == refusal) return code;
  }
  return canopen::AbortCode::kGeneralError;
}

// Byte 3 of an EMCY, decimal in the manual.
inline constexpr std::uint8_t kSystemAlarm = 0;  // an alarm of the inverter, its data code is in byte 4
inline constexpr std::uint8_t kCommandError = 21;
inline constexpr std::uint8_t kLifeTimeExpired = 31;
inline constexpr std::uint8_t kReceivePdoError = 42;
inline constexpr std::uint8_t kTransmitPdoError = 44;
inline constexpr std::uint8_t kStoringError = 62;

// Byte 4 for a command error, hexadecimal in the manual.
enum class CommandError : std::uint8_t {
  kOutsideRange = 0x11,
  kExternalOperation = 0x12,
  kOperational = 0x13,
  kReadOnly = 0x14,
  kNoParameter = 0x16,
  kDataUsage = 0x19,
  kNowOperating = 0x21,
  kStf = 0x22,
  kStr = 0x23,
  kOperatingModeSet = 0x24,
};
VINV_ENUM_RANGE(CommandError, kOutsideRange, kOperatingModeSet);

// The situation in which a write was refused.
struct RefusedIn {
  port::OperationMode mode = port::OperationMode::kExternal;
  bool running = false;
  port::NetTerminals start_signals;
};

// Unspecified: the manual names the reasons and nothing more. "Operational" (13H) is taken for operation by the panel,
// beside external operation (12H), which also stands for a command right that lies with the terminals (Pr.338, 339).
constexpr CommandError command_error_of(port::Refusal refusal, const RefusedIn& in) {
  switch (refusal) {
    case port::Refusal::kNoSuchItem: return CommandError::kNoParameter;
    case port::Refusal::kOutOfRange: return CommandError::kOutsideRange;
    case port::Refusal::kReadOnly:
    case port::Refusal::kWriteDisabled: return CommandError::kReadOnly;
    case port::Refusal::kRunning: return CommandError::kNowOperating;
    case port::Refusal::kWrongMode:
      return in.mode == port::OperationMode::kExternal || in.mode == port::OperationMode::kNetwork
                 ? CommandError::kExternalOperation
                 : CommandError::kOperational;
    case port::Refusal::kModeChangeRefused:
      if (in.running) return CommandError::kOperatingModeSet;
      if (in.start_signals.has(port::NetTerminal::kStf)) return CommandError::kStf;
      if (in.start_signals.has(port::NetTerminal::kStr)) return CommandError::kStr;
      return CommandError::kOperatingModeSet;
    default: return CommandError::kDataUsage;
  }
}

}  // namespace vinv::boards::oi_fr_e5nco
