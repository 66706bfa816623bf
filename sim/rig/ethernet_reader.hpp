// What a plant file says of a board on Ethernet: where it is reached, its surroundings, its slot.
#pragma once

#include <string>

#include "sim/rig/plant_file.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::rig {

// Keys of `board` that only a board on Ethernet has.
const std::vector<std::string_view>& ethernet_keys();

// map: of the board, nullptr if everything is default.
EthernetSpec read_ethernet(const YamlMap* map, const DriveSpec& drive, Problems& problems);

// Boards without an address get the lowest free ones of 127.0.0.2 and up; no two may have the same. What a DHCP server
// gives is that address, unless the file has another lease.
void assign_addresses(PlantFile& file, Problems& problems);

}  // namespace vinv::rig
