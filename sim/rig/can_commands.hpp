// The CAN part of the command set: what a bus and a drive's controller on it are like, and faults on it.
#pragma once

#include "sim/rig/command_values.hpp"

namespace vinv::rig {

// Words of a command line at which an entry of `wire` begins.
Words wire_words();
// `wire`; returns the faults that last. Ends with Refuse.
Json wire_faults(Plant& plant, DriveUnit& drive, const Json& value);

// The drive's controller and its bus; the drive is on one.
Json can_json(Plant& plant, const DriveUnit& drive);
// Every CAN bus that has boards.
Json buses_json(Plant& plant);

}  // namespace vinv::rig
