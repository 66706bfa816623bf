// The CAN part of the command set: what a bus and a drive's controller on it are like.
#pragma once

#include "sim/rig/command_values.hpp"

namespace vinv::rig {

// The drive's controller and its bus; the drive is on one.
Json can_json(Plant& plant, const DriveUnit& drive);
// Every CAN bus that has boards.
Json buses_json(Plant& plant);

}  // namespace vinv::rig
