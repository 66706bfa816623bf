#include "option_boards/boards/make_board.hpp"

#include <algorithm>
#include <array>

#include "option_boards/boards/oi_fr_e5nco/board.hpp"

namespace vinv::boards {
namespace {

struct BoardType {
  std::string_view name;
  std::vector<std::string_view> families;
  unsigned first_node, last_node;
  std::unique_ptr<OptionBoard> (*make)(unsigned node, port::DrivePort& drive);
};

std::unique_ptr<OptionBoard> make_oi_fr_e5nco(unsigned node, port::DrivePort& drive) {
  const oi_fr_e5nco::AddressSwitches switches{static_cast<std::uint8_t>(node / 10),
                                              static_cast<std::uint8_t>(node % 10)};
  return std::make_unique<oi_fr_e5nco::Board>(drive, switches);
}

const std::vector<BoardType>& types() {
  static const std::vector<BoardType> kTypes{{oi_fr_e5nco::kType, {"fr-e500"}, 1, 99, make_oi_fr_e5nco}};
  return kTypes;
}

const BoardType* find_type(std::string_view name) {
  const auto type = std::find_if(types().begin(), types().end(), [&](const auto& t) { return t.name == name; });
  return type == types().end() ? nullptr : &*type;
}

}  // namespace

Result<std::unique_ptr<OptionBoard>, std::string> make_board(const BoardConfig& config, port::DrivePort& drive) {
  const BoardType* type = find_type(config.type);
  if (type == nullptr) {
    std::string allowed;
    for (const std::string_view name : board_types()) allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    return Unexpected("unknown board type \"" + config.type + "\"; allowed: " + allowed);
  }
  if (config.node < type->first_node || config.node > type->last_node) {
    return Unexpected("node " + std::to_string(config.node) + " of board " + config.type +
                      " is out of range; allowed: " + std::to_string(type->first_node) + " to " +
                      std::to_string(type->last_node));
  }
  return type->make(config.node, drive);
}

std::vector<std::string_view> board_types() {
  std::vector<std::string_view> names;
  for (const BoardType& type : types()) names.push_back(type.name);
  return names;
}

std::vector<std::string_view> board_families(std::string_view type) {
  const BoardType* found = find_type(type);
  return found == nullptr ? std::vector<std::string_view>{} : found->families;
}

}  // namespace vinv::boards
