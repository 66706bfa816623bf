// Network management: states and commands of a slave, COB-IDs of the predefined connection set.
// CiA DS-301 v4.0, 9.2.6 and 9.3.3.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::canopen {

// As guarding reports them; kOff is no state of the document: no supply, no node address.
enum class NmtState : std::uint8_t {
  kOff = 0xff,
  kInitialising = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127
};
VINV_ENUM_RANGE(NmtState, kInitialising, kOff);

enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

inline constexpr std::uint8_t kLastNode = 127;

inline constexpr std::uint32_t kNmtCobId = 0x000;
inline constexpr std::uint32_t kSdoAnswerCobId = 0x580;   // + node
inline constexpr std::uint32_t kSdoRequestCobId = 0x600;  // + node
inline constexpr std::uint32_t kGuardCobId = 0x700;       // + node

// COB-IDs that no SYNC, EMCY or PDO may have.
constexpr bool is_restricted(std::uint32_t cob_id) {
  return cob_id <= 1 || (cob_id >= 0x101 && cob_id <= 0x180) || (cob_id >= 0x581 && cob_id <= 0x5ff) ||
         (cob_id >= 0x601 && cob_id <= 0x67f) || cob_id == 0x6e0 || cob_id >= 0x701;
}

}  // namespace vinv::canopen
