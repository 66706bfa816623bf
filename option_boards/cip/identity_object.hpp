// Bindings of objects that every device has: Identity 0x01, Message Router 0x02, Assembly 0x04. For hosts that are a
// cip::Device; which attributes a device has is its table.
#pragma once

#include <array>
#include <cstdint>
#include <span>

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

// "object_list", Message Router attribute 1: a count and the classes.
template <class Host>
GeneralStatus append_object_list(const Host& host, const Attribute&, Bytes& out) {
  const auto classes = host.router().classes();
  append_le16(out, static_cast<std::uint16_t>(classes.size()));
  for (const std::uint16_t id : classes) append_le16(out, id);
  return GeneralStatus::kSuccess;
}

}  // namespace vinv::cip
