// Error code and error register of each alarm: emergency_codes.csv. OI-FR-E5NCO manual, 7.1 and 7.3.
#pragma once

#include <cstdint>

namespace vinv::boards::oi_fr_e5nco {

struct EmergencyCode {
  std::uint16_t error_code = 0;
  std::uint8_t error_register = 0;
};

inline constexpr std::uint16_t kErrorReset = 0x0000;
inline constexpr std::uint16_t kGenericError = 0x1000;
// Not in the manual's table; as DS-301 v4.0, 9.2.5.1 has them.
inline constexpr std::uint16_t kProtocolError = 0x8200;
inline constexpr std::uint16_t kPdoLengthError = 0x8210;
inline constexpr std::uint16_t kLifeGuardError = 0x8130;
inline constexpr std::uint8_t kCommunicationErrorBits = 0x11;  // generic and communication

// By the inverter's data code; alarms that the table does not have are generic errors.
EmergencyCode emergency_code_of(std::uint8_t data_code);

}  // namespace vinv::boards::oi_fr_e5nco
