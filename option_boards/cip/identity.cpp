#include "option_boards/cip/identity.hpp"

namespace vinv::cip {
namespace {

bool differs(unsigned asked, unsigned is) { return asked != 0 && asked != is; }

}  // namespace

KeyMatch match_key(const ElectronicKey& key, const Identity& identity) {
  if (differs(key.vendor_id, identity.vendor_id) || differs(key.product_code, identity.product_code)) {
    return KeyMatch::kVendorOrProductCode;
  }
  if (differs(key.device_type, identity.device_type)) return KeyMatch::kDeviceType;
  if (differs(key.major_revision, identity.major_revision)) return KeyMatch::kRevision;
  if (key.compatible ? key.minor_revision > identity.minor_revision
                     : differs(key.minor_revision, identity.minor_revision)) {
    return KeyMatch::kRevision;
  }
  return KeyMatch::kMatches;
}

}  // namespace vinv::cip
