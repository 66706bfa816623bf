// Who has which address: boards without a node get a free one, and two boards of one wire may not share one.
#pragma once

#include "sim/rig/plant_file.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::rig {

// Boards without a node get the lowest free ones in order. A first-start value of the parameter that overrides the
// switches counts as the node does.
void assign_nodes(PlantFile& file, Problems& problems);

}  // namespace vinv::rig
