// Makes an option board by the name that plant files use ("oi-fr-e5nco").
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/ethernet_settings.hpp"
#include "option_boards/boards/option_board.hpp"
#include "sim/base/result.hpp"

namespace vinv::boards {

struct BoardConfig {
  std::string type;
  unsigned node = 63;  // what the address switches are set to, on a board that has them
  // Of a board on Ethernet.
  std::uint32_t serial_number = 1;
  EthernetSurroundings ethernet;
  bool fast = false;  // answers as fast as the inverter decides, not as slowly as the real one
};

// What there is to say of a board in a plant file.
struct BoardTraits {
  unsigned first_node = 0, last_node = 0;  // 0: it has no address switches
  bool fieldbus = false;                   // wires that several boards share: a serial line, a CAN bus
  bool ethernet = false;                   // an IPv4 address of its own
  unsigned connectors = 0;                 // of the inverter, to choose from; 0: there is one
};

// The drive outlives the board. Refuses an unknown type or a node out of range with a sentence naming what is allowed.
Result<std::unique_ptr<OptionBoard>, std::string> make_board(const BoardConfig& config, port::DrivePort& drive);
std::vector<std::string_view> board_types();
// Families that a board type fits ("fr-e500"); empty if the type is unknown.
std::vector<std::string_view> board_families(std::string_view type);
BoardTraits board_traits(std::string_view type);

}  // namespace vinv::boards
