// Four-bit code of an alarm at terminals SU, IPF, OL and FU (Pr.76). Typical for the family.
#pragma once

#include <cstdint>

namespace vinv::inverter::a700 {

// By the data code (FR-A7NE manual 7.6); 0: no alarm. Bit 3 is SU, 2 IPF, 1 OL, 0 FU.
constexpr unsigned alarm_code(std::uint8_t data_code) {
  switch (data_code) {
    case 0x00: return 0x0;
    case 0x10: return 0x1;  // OC1
    case 0x11: return 0x2;
    case 0x12: return 0x3;
    case 0x20:
    case 0x21:
    case 0x22: return 0x4;  // OV1 to OV3
    case 0x31: return 0x5;  // THM
    case 0x30: return 0x6;  // THT
    case 0x50: return 0x7;  // IPF
    case 0x51: return 0x8;  // UVT
    case 0x40: return 0x9;  // FIN
    case 0x70: return 0xA;  // BE
    case 0x80: return 0xB;  // GF
    case 0x90: return 0xC;  // OHT
    case 0x60: return 0xD;  // OLT
    case 0xA0:
    case 0xA3: return 0xE;  // OPT, OP3
    default: return 0xF;
  }
}

}  // namespace vinv::inverter::a700
