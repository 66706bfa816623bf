#include "option_boards/boards/make_board.hpp"

#include <algorithm>
#include <array>

#include "option_boards/boards/fr_a7ne/board.hpp"
#include "option_boards/boards/oi_fr_e5nco/board.hpp"

namespace vinv::boards {
namespace {

struct BoardType {
  std::string_view name;
  std::vector<std::string_view> families;
  BoardTraits traits;
  std::unique_ptr<OptionBoard> (*make)(const BoardConfig& config, port::DrivePort& drive);
};

std::unique_ptr<OptionBoard> make_oi_fr_e5nco(const BoardConfig& config, port::DrivePort& drive) {
  const oi_fr_e5nco::AddressSwitches switches{static_cast<std::uint8_t>(config.node / 10),
                                              static_cast<std::uint8_t>(config.node % 10)};
  return std::make_unique<oi_fr_e5nco::Board>(drive, switches);
}

std::unique_ptr<OptionBoard> make_fr_a7ne(const BoardConfig& config, port::DrivePort& drive) {
  fr_a7ne::CipUnitConfig unit;
  unit.serial_number = config.serial_number;
  unit.ethernet = config.ethernet;
  unit.timing = config.fast ? fr_a7ne::Timing::fast() : fr_a7ne::Timing::real();
  return std::make_unique<fr_a7ne::Board>(drive, unit);
}

const std::vector<BoardType>& types() {
  static const std::vector<BoardType> kTypes{
      {oi_fr_e5nco::kType, {"fr-e500"}, {.first_node = 1, .last_node = 99, .fieldbus = true}, make_oi_fr_e5nco},
      {fr_a7ne::kType, {"fr-a700"}, {.ethernet = true, .connectors = 3}, make_fr_a7ne}};
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
  const unsigned first = type->traits.first_node, last = type->traits.last_node;
  if (last != 0 && (config.node < first || config.node > last)) {
    return Unexpected("node " + std::to_string(config.node) + " of board " + config.type +
                      " is out of range; allowed: " + std::to_string(first) + " to " + std::to_string(last));
  }
  return type->make(config, drive);
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

BoardTraits board_traits(std::string_view type) {
  const BoardType* found = find_type(type);
  return found == nullptr ? BoardTraits{} : found->traits;
}

}  // namespace vinv::boards
