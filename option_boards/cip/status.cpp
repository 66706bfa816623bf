#include "option_boards/cip/status.hpp"

namespace vinv::cip {

std::string_view name_of(GeneralStatus status) {
  switch (status) {
    case GeneralStatus::kSuccess: return "Success";
    case GeneralStatus::kConnectionFailure: return "Connection failure";
    case GeneralStatus::kResourceUnavailable: return "Resource unavailable";
    case GeneralStatus::kInvalidParameterValue: return "Invalid parameter value";
    case GeneralStatus::kPathSegmentError: return "Path segment error";
    case GeneralStatus::kPathDestinationUnknown: return "Path destination unknown";
    case GeneralStatus::kPartialTransfer: return "Partial transfer";
    case GeneralStatus::kConnectionLost: return "Connection lost";
    case GeneralStatus::kServiceNotSupported: return "Service not supported";
    case GeneralStatus::kInvalidAttributeValue: return "Invalid attribute value";
    case GeneralStatus::kAttributeListError: return "Attribute list error";
    case GeneralStatus::kAlreadyInRequestedMode: return "Already in requested mode/state";
    case GeneralStatus::kObjectStateConflict: return "Object state conflict";
    case GeneralStatus::kObjectAlreadyExists: return "Object already exists";
    case GeneralStatus::kAttributeNotSettable: return "Attribute not settable";
    case GeneralStatus::kPrivilegeViolation: return "Privilege violation";
    case GeneralStatus::kDeviceStateConflict: return "Device state conflict";
    case GeneralStatus::kReplyDataTooLarge: return "Reply data too large";
    case GeneralStatus::kFragmentationOfPrimitive: return "Fragmentation of a primitive value";
    case GeneralStatus::kNotEnoughData: return "Not enough data";
    case GeneralStatus::kAttributeNotSupported: return "Attribute not supported";
    case GeneralStatus::kTooMuchData: return "Too much data";
    case GeneralStatus::kObjectDoesNotExist: return "Object does not exist";
    case GeneralStatus::kNoStoredAttributeData: return "No stored attribute data";
    case GeneralStatus::kStoreOperationFailure: return "Store operation failure";
    case GeneralStatus::kRoutingRequestTooLarge: return "Routing failure, request packet too large";
    case GeneralStatus::kRoutingResponseTooLarge: return "Routing failure, response packet too large";
    case GeneralStatus::kMissingAttributeListEntry: return "Missing attribute list entry data";
    case GeneralStatus::kInvalidAttributeValueList: return "Invalid attribute value list";
    case GeneralStatus::kEmbeddedServiceError: return "Embedded service error";
    case GeneralStatus::kVendorSpecificError: return "Vendor specific error";
    case GeneralStatus::kInvalidParameter: return "Invalid parameter";
    case GeneralStatus::kWriteOnceValue: return "Write-once value or medium already written";
    case GeneralStatus::kInvalidReplyReceived: return "Invalid reply received";
    case GeneralStatus::kKeyFailureInPath: return "Key failure in path";
    case GeneralStatus::kPathSizeInvalid: return "Path size invalid";
    case GeneralStatus::kUnexpectedAttributeInList: return "Unexpected attribute in list";
    case GeneralStatus::kInvalidMemberId: return "Invalid member ID";
    case GeneralStatus::kMemberNotSettable: return "Member not settable";
    case GeneralStatus::kGroup2OnlyGeneralFailure: return "Group 2 only server general failure";
    case GeneralStatus::kAttributeNotGettable: return "Attribute not gettable";
  }
  return {};
}

}  // namespace vinv::cip
