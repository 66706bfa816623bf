// CRC of RTU frames. MODBUS over Serial Line V1.02, 6.2.2: polynomial A001H (reflected 8005H), initial value FFFFH.
#pragma once

#include <cstdint>

#include "sim/base/bytes.hpp"

namespace vinv::modbus {

// Travels low byte first behind the bytes it covers.
std::uint16_t crc16(ByteView bytes);

}  // namespace vinv::modbus
