// Who a device is: what the Identity object, ListIdentity, the duplicate MAC ID check and electronic keys tell and ask.
// CIP Vol 1, 5-2; electronic key: C-1.4.2.4.1.
#pragma once

#include <cstdint>
#include <string_view>

#include "option_boards/cip/epath.hpp"

namespace vinv::cip {

struct Identity {
  std::uint16_t vendor_id = 0;
  std::uint16_t device_type = 0;
  std::uint16_t product_code = 0;
  std::uint8_t major_revision = 1;
  std::uint8_t minor_revision = 1;
  std::uint32_t serial_number = 0;
  std::string_view product_name;  // at most 32 characters; of static storage
};

// Attribute 8 and the State byte of ListIdentity.
enum class IdentityState : std::uint8_t {
  kNonexistent = 0,
  kSelfTesting = 1,
  kStandby = 2,
  kOperational = 3,
  kMajorRecoverableFault = 4,
  kMajorUnrecoverableFault = 5,
};

enum class KeyMatch : std::uint8_t { kMatches, kVendorOrProductCode, kDeviceType, kRevision };

// Zero in the key matches anything. Revision: the same major and, unless 0, the same minor; major 0: any. With the
// compatibility bit the same major, and a minor not before the named one, which cannot be 0. The extended status of a
// refusal (CIP Vol 1, 3-5.5): 0x0114 vendor or product code, 0x0115 device type, 0x0116 revision.
KeyMatch match_key(const ElectronicKey& key, const Identity& identity);

}  // namespace vinv::cip
