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
  const bool fits = key.compatible ? key.major_revision == identity.major_revision && key.minor_revision != 0 &&
                                         key.minor_revision <= identity.minor_revision
                                   : key.major_revision == 0 || (key.major_revision == identity.major_revision &&
                                                                 !differs(key.minor_revision, identity.minor_revision));
  return fits ? KeyMatch::kMatches : KeyMatch::kRevision;
}

}  // namespace vinv::cip
