// Makes an option board by the name that plant files use ("oi-fr-e5nco").
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/option_board.hpp"
#include "sim/base/result.hpp"

namespace vinv::boards {

struct BoardConfig {
  std::string type;
  unsigned node = 63;  // what the address switches are set to
};

// The drive outlives the board. Refuses an unknown type or a node out of range with a sentence naming what is allowed.
Result<std::unique_ptr<OptionBoard>, std::string> make_board(const BoardConfig& config, port::DrivePort& drive);
std::vector<std::string_view> board_types();
// Families that a board type fits ("fr-e500"); empty if the type is unknown.
std::vector<std::string_view> board_families(std::string_view type);

}  // namespace vinv::boards
