// Bindings of the Identity object, class 0x01. For hosts that are a cip::Device; which attributes a device has, and
// what its service Reset does, is the board's.
#pragma once

#include <cstdint>

#include "option_boards/cip/device.hpp"
#include "option_boards/cip/table_object.hpp"

namespace vinv::cip {

// "identity": argument is the attribute's number in the Identity object of the specification.
template <class Host>
Got get_identity(const Host& host, const Attribute& attribute) {
  const Identity& id = host.identity();
  switch (attribute.argument()) {
    case 1: return id.vendor_id;
    case 2: return id.device_type;
    case 3: return id.product_code;
    case 5: return host.identity_status();
    case 6: return id.serial_number;
    case 8: return static_cast<std::int64_t>(host.identity_state());
    default: return Unexpected(GeneralStatus::kAttributeNotSupported);
  }
}
template <class Host>
GeneralStatus append_identity(const Host& host, const Attribute& attribute, Bytes& out) {
  const Identity& id = host.identity();
  switch (attribute.argument()) {
    case 4:
      out.push_back(id.major_revision);
      out.push_back(id.minor_revision);
      return GeneralStatus::kSuccess;
    case 7: append_short_string(out, id.product_name); return GeneralStatus::kSuccess;
    default: return GeneralStatus::kAttributeNotSupported;
  }
}

}  // namespace vinv::cip
