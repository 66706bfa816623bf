// What the inverter's refusals are called on EtherNet/IP. FR-A7NE manual, appendix "Error Code List".
//
// Unspecified: the manual lists the codes and not which refusal is which. A value: 0x09; never writable: 0x0E; not in
// this mode, not while running, locked by Pr.77 or busy: 0x0C (6.2.2 names it for busy); during reset or because of an
// alarm: 0x10.
#pragma once

#include <array>
#include <utility>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/cip/status.hpp"

namespace vinv::boards::fr_a7ne {

inline constexpr std::array<std::pair<port::Refusal, cip::GeneralStatus>, 12> kGeneralStatuses{{
    {port::Refusal::kNoSuchItem, cip::GeneralStatus::kAttributeNotSupported},
    {port::Refusal::kOutOfRange, cip::GeneralStatus::kInvalidAttributeValue},
    {port::Refusal::kReadOnly, cip::GeneralStatus::kAttributeNotSettable},
    {port::Refusal::kWriteOnly, cip::GeneralStatus::kAttributeNotSupported},
    {port::Refusal::kRunning, cip::GeneralStatus::kObjectStateConflict},
    {port::Refusal::kWriteDisabled, cip::GeneralStatus::kObjectStateConflict},
    {port::Refusal::kWrongMode, cip::GeneralStatus::kObjectStateConflict},
    {port::Refusal::kModeChangeRefused, cip::GeneralStatus::kObjectStateConflict},
    {port::Refusal::kBusy, cip::GeneralStatus::kObjectStateConflict},
    {port::Refusal::kNotReady, cip::GeneralStatus::kDeviceStateConflict},
    {port::Refusal::kFaulted, cip::GeneralStatus::kDeviceStateConflict},
    {port::Refusal::kNotFaulted, cip::GeneralStatus::kDeviceStateConflict},
}};

constexpr cip::GeneralStatus status_of(port::Refusal refusal) {
  for (const auto& [reason, status] : kGeneralStatuses) {
    if (reason == refusal) return status;
  }
  return cip::GeneralStatus::kVendorSpecificError;
}

}  // namespace vinv::boards::fr_a7ne
