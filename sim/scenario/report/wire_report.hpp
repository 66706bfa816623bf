// What went over the wires, as the captures that other tools read. Simulated zero is 1970-01-01, so that a file says
// nothing of when it was made.
#pragma once

#include <string>

#include "sim/base/bytes.hpp"
#include "sim/scenario/recording.hpp"

namespace vinv::scenario {

// CAN as `candump -l` writes it, each network under its name; empty if there was no CAN.
std::string candump_log(const Recording& recording);

// pcapng with an interface for each network: CAN as LINKTYPE_CAN_SOCKETCAN, serial lines as RTAC serial, TCP as the
// Ethernet frames of one connection from the master to each network. A network that is named by an address
// ("127.0.0.1:1502") has it, others have 192.0.2.254:502. Empty if nothing went over a wire.
Bytes wire_pcapng(const Recording& recording);

}  // namespace vinv::scenario
