// What the inverter's refusals are called on Modbus. OI-FR-E5NCO manual, 8.8: 01 function, 02 address, 03 data,
// 04 not ready, 05 error in the writing, 06 overlap (another write in progress).
#pragma once

#include <array>
#include <utility>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/modbus/pdu.hpp"

namespace vinv::boards::oi_fr_e5nco {

// The manual's names for the codes.
inline constexpr auto kAddressNotCorrect = modbus::Exception::kIllegalDataAddress;
inline constexpr auto kDataNotCorrect = modbus::Exception::kIllegalDataValue;
inline constexpr auto kNotReady = modbus::Exception::kServerDeviceFailure;
inline constexpr auto kErrorInTheWriting = modbus::Exception::kAcknowledge;
inline constexpr auto kOverlap = modbus::Exception::kServerDeviceBusy;

inline constexpr std::array<std::pair<port::Refusal, modbus::Exception>, 12> kExceptionCodes{{
    {port::Refusal::kNoSuchItem, kAddressNotCorrect},
    {port::Refusal::kOutOfRange, kDataNotCorrect},
    {port::Refusal::kReadOnly, kErrorInTheWriting},
    {port::Refusal::kWriteOnly, kAddressNotCorrect},
    {port::Refusal::kRunning, kErrorInTheWriting},
    {port::Refusal::kWriteDisabled, kErrorInTheWriting},
    {port::Refusal::kWrongMode, kErrorInTheWriting},
    {port::Refusal::kModeChangeRefused, kErrorInTheWriting},
    {port::Refusal::kBusy, kOverlap},
    {port::Refusal::kNotReady, kNotReady},
    {port::Refusal::kFaulted, kErrorInTheWriting},
    {port::Refusal::kNotFaulted, kErrorInTheWriting},
}};

constexpr modbus::Exception exception_of(port::Refusal refusal) {
  for (const auto& [reason, code] : kExceptionCodes) {
    if (reason == refusal) return code;
  }
  return kErrorInTheWriting;
}

}  // namespace vinv::boards::oi_fr_e5nco
