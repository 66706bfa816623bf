#include "option_boards/boards/oi_fr_e5nco/register_map.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/base/table_text.hpp"
#include "vinv_boards_data.hpp"

namespace vinv::boards::oi_fr_e5nco {
namespace {

enum Column : std::size_t { kFirst, kLast, kStep, kAccess, kItem, kIndex, kMin, kMax, kValue, kColumnsUsed };

constexpr std::array<std::pair<std::string_view, Item>, 13> kItemNames{{
    {"none", Item::kNone},
    {"parameter", Item::kParameter},
    {"alarms", Item::kAlarms},
    {"monitor", Item::kMonitor},
    {"status", Item::kStatus},
    {"command", Item::kCommand},
    {"frequency", Item::kFrequency},
    {"rpm", Item::kRpm},
    {"analog", Item::kAnalog},
    {"clear_alarms", Item::kClearAlarms},
    {"reset", Item::kReset},
    {"network_mode", Item::kNetworkMode},
    {"constant", Item::kConstant},
}};

RegisterRow parse_row(std::string_view line) {
  std::array<std::string_view, kColumnsUsed> field;
  for (auto& f : field) f = take_until(line, ',');
  const auto* const item = std::find_if(kItemNames.begin(), kItemNames.end(),
                                        [&](const auto& entry) { return entry.first == field[kItem]; });
  VINV_CHECK(item != kItemNames.end());
  VINV_CHECK(field[kAccess] == "R" || field[kAccess] == "W" || field[kAccess] == "RW" || field[kAccess] == "-");
  RegisterRow row;
  row.first = number_of_field<std::uint16_t>(field[kFirst], 0);
  row.last = number_of_field<std::uint16_t>(field[kLast], 0);
  row.step = number_of_field<std::uint16_t>(field[kStep], 0);
  row.readable = field[kAccess].find('R') != std::string_view::npos;
  row.writable = field[kAccess].find('W') != std::string_view::npos;
  row.item = item->second;
  row.index = number_of_field<std::uint16_t>(field[kIndex], 0);
  row.min = number_of_field<std::uint16_t>(field[kMin], 0);
  row.max = number_of_field<std::uint16_t>(field[kMax], 0);
  row.constant = number_of_field<std::uint16_t>(field[kValue], 0, 16);
  VINV_CHECK(row.step > 0 && row.first <= row.last);
  return row;
}

}  // namespace

RegisterMap::RegisterMap(std::string_view csv) {
  take_until(csv, '\n');
  while (!csv.empty()) rows_.push_back(parse_row(take_until(csv, '\n')));
}

const RegisterRow* RegisterMap::find_readable(std::uint32_t address) const {
  const auto row =
      std::find_if(rows_.begin(), rows_.end(), [&](const auto& r) { return r.readable && r.contains(address); });
  return row == rows_.end() ? nullptr : &*row;
}

const RegisterRow* RegisterMap::find_writable(std::uint32_t address) const {
  const auto row =
      std::find_if(rows_.begin(), rows_.end(), [&](const auto& r) { return r.writable && r.contains(address); });
  return row == rows_.end() ? nullptr : &*row;
}

const RegisterMap& register_map() {
  static const RegisterMap map(data::OI_FR_E5NCO_REGISTERS);
  return map;
}

}  // namespace vinv::boards::oi_fr_e5nco
