// `wire`: faults on the wires of a drive, in the words of the control socket and of scenarios. docs/control-socket.md
// is their reference.
#pragma once

#include "sim/rig/command_values.hpp"

namespace vinv::rig {

// Words of a command line at which an entry of `wire` begins.
Words wire_words();
// Returns the faults that last, by wire. Ends with Refuse.
Json wire_faults(Plant& plant, DriveUnit& drive, const Json& value);

// The faults of one bus.
Json faults_json(const CanLine& line);

}  // namespace vinv::rig
