// General status codes of CIP services. CIP Vol 1, appendix B; FR-A7NE manual, appendix "Error Code List".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::cip {

enum class GeneralStatus : std::uint8_t {
  kSuccess = 0x00,
  kConnectionFailure = 0x01,  // with an extended status
  kResourceUnavailable = 0x02,
  kInvalidParameterValue = 0x03,
  kPathSegmentError = 0x04,
  kPathDestinationUnknown = 0x05,
  kPartialTransfer = 0x06,
  kConnectionLost = 0x07,
  kServiceNotSupported = 0x08,
  kInvalidAttributeValue = 0x09,
  kAttributeListError = 0x0A,
  kAlreadyInRequestedMode = 0x0B,
  kObjectStateConflict = 0x0C,
  kObjectAlreadyExists = 0x0D,
  kAttributeNotSettable = 0x0E,
  kPrivilegeViolation = 0x0F,
  kDeviceStateConflict = 0x10,
  kReplyDataTooLarge = 0x11,
  kFragmentationOfPrimitive = 0x12,
  kNotEnoughData = 0x13,
  kAttributeNotSupported = 0x14,
  kTooMuchData = 0x15,
  kObjectDoesNotExist = 0x16,
  kNoStoredAttributeData = 0x18,
  kStoreOperationFailure = 0x19,
  kRoutingRequestTooLarge = 0x1A,
  kRoutingResponseTooLarge = 0x1B,
  kMissingAttributeListEntry = 0x1C,
  kInvalidAttributeValueList = 0x1D,
  kEmbeddedServiceError = 0x1E,
  kVendorSpecificError = 0x1F,
  kInvalidParameter = 0x20,
  kWriteOnceValue = 0x21,
  kInvalidReplyReceived = 0x22,
  kKeyFailureInPath = 0x25,
  kPathSizeInvalid = 0x26,
  kUnexpectedAttributeInList = 0x27,
  kInvalidMemberId = 0x28,
  kMemberNotSettable = 0x29,
  kGroup2OnlyGeneralFailure = 0x2A,
  kAttributeNotGettable = 0x2C,
};
VINV_ENUM_RANGE(GeneralStatus, kSuccess, kAttributeNotGettable);

struct Status {
  static constexpr std::size_t kMaxExtended = 6;  // of Forward_Open's 0x0112

  GeneralStatus general = GeneralStatus::kSuccess;
  std::uint8_t extended_count = 0;
  std::array<std::uint16_t, kMaxExtended> extended{};

  constexpr Status() = default;
  constexpr Status(GeneralStatus code) : general(code) {}
  constexpr Status(GeneralStatus code, std::uint16_t word) : general(code), extended_count(1), extended{word} {}
  constexpr Status(GeneralStatus code, std::uint16_t word, std::uint16_t second)
      : general(code), extended_count(2), extended{word, second} {}
  constexpr bool ok() const { return general == GeneralStatus::kSuccess; }
  friend constexpr bool operator==(const Status&, const Status&) = default;
  friend void archive(Archive& a, Status& status) {
    VINV_MEMBERS(status, general, extended_count, extended);
    VINV_FIELDS(a, Status, general, extended_count, extended);
    a.require(extended_count <= kMaxExtended, "a status has more words than it can");
  }
};

}  // namespace vinv::cip
