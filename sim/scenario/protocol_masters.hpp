// The masters that `via:` may name: our protocol clients on the wires of the plant. A master has a station on each wire
// that its drives hang on, made when it is first spoken to.
#pragma once

#include <string_view>
#include <vector>

#include "sim/scenario/master.hpp"

namespace vinv::scenario {

// "modbus" (RTU on the drive's serial line), "modbus_tcp", "canopen" (command and speed by PDO), "canopen_sdo",
// "canopen_402" (DSP-402 velocity mode).
std::vector<MasterKind> protocol_masters();
// What they can be told; some of it is no command of the control socket: quick_stop, monitor, clear_alarms, silence.
const std::vector<std::string_view>& master_words();

}  // namespace vinv::scenario
