// Extended status of the Connection Manager's refusals, with general status 0x01. CIP Vol 1, table 3-5.33.
#pragma once

#include <cstdint>

namespace vinv::ethernet_ip {

enum class ConnectionStatus : std::uint16_t {
  kDuplicateForwardOpen = 0x0100,
  kOwnershipConflict = 0x0106,
  kConnectionNotFound = 0x0107,
  kInvalidConnectionSize = 0x0109,  // with the largest one
  kRpiNotSupported = 0x0111,
  kRpiNotAcceptable = 0x0112,  // with what is, for both directions
  kOutOfConnections = 0x0113,
  kVendorOrProductCodeMismatch = 0x0114,
  kDeviceTypeMismatch = 0x0115,
  kRevisionMismatch = 0x0116,
  kInvalidApplicationPath = 0x0117,
  kNoOwnerToListenTo = 0x0119,
  kTargetOutOfConnections = 0x011a,
  kRpiBelowInhibitTime = 0x011b,
  kTransportClassNotSupported = 0x011c,
  kTriggerNotSupported = 0x011d,
  kDirectionNotSupported = 0x011e,
  kInvalidO2tType = 0x0123,
  kInvalidT2oType = 0x0124,
  kInvalidO2tRedundantOwner = 0x0125,
  kInvalidConfigurationSize = 0x0126,  // with the right one, as are the next two
  kInvalidO2tSize = 0x0127,
  kInvalidT2oSize = 0x0128,
  kInvalidConfigurationPath = 0x0129,
  kInvalidConsumingPath = 0x012a,
  kInvalidProducingPath = 0x012b,
  kInconsistentPaths = 0x012f,
  kTimeoutMultiplierNotAcceptable = 0x0133,
  // A further consumer of a multicast production asks for another one.
  kMismatchedT2oSize = 0x0134,
  kMismatchedT2oFixedVariable = 0x0135,
  kMismatchedT2oPriority = 0x0136,
  kMismatchedTransportClass = 0x0137,
  kMismatchedT2oTrigger = 0x0138,
  kMismatchedT2oInhibitTime = 0x0139,
  kParameterErrorInUnconnectedSend = 0x0205,
  kPortNotAvailable = 0x0311,
  kInvalidSegment = 0x0315,
};

}  // namespace vinv::ethernet_ip
