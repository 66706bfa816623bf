// SDO abort codes. CiA DS-301 v4.0, 9.2.2.2.3.
#pragma once

#include <cstdint>

namespace vinv::canopen {

enum class AbortCode : std::uint32_t {
  kCommandSpecifier = 0x05040001,   // command specifier unknown or of a kind of transfer that the server does not have
  kWriteOnly = 0x06010001,          // read of a write-only object
  kReadOnly = 0x06010002,           // write to a read-only object
  kNoSuchObject = 0x06020000,       //
  kNotMappable = 0x06040041,        // the object cannot be mapped to the PDO
  kPdoLengthExceeded = 0x06040042,  // number and length of the mapped objects exceed the PDO
  kHardwareError = 0x06060000,      //
  kLengthMismatch = 0x06070010,     // length of the parameter does not match its type
  kNoSuchSubindex = 0x06090011,     //
  kValueRange = 0x06090030,         //
  kGeneralError = 0x08000000,       //
  kLocalControl = 0x08000021,       // not now: the application is under local control
  kDeviceState = 0x08000022,        // not now: the present device state
};

}  // namespace vinv::canopen
