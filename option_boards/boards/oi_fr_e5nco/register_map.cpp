#include "option_boards/boards/oi_fr_e5nco/register_map.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "sim/base/check.hpp"
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

std::string_view take_until(std::string_view& text, char delimiter) {
  const std::size_t end = std::min(text.find(delimiter), text.size());
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return taken;
}

// An empty field is 0.
std::uint16_t number(std::string_view field, int base = 10) {
  std::uint16_t value = 0;
  if (field.empty()) return value;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value, base);
  VINV_CHECK(error == std::errc{} && end == field.data() + field.size());
  return value;
}

RegisterRow parse_row(std::string_view line) {
  std::array<std::string_view, kColumnsUsed> field;
  for (auto& f : field) f = take_until(line, ',');
  const auto* const item = std::find_if(kItemNames.begin(), kItemNames.end(),
                                        [&](const auto& entry) { return entry.first == field[kItem]; });
  VINV_CHECK(item != kItemNames.end());
  VINV_CHECK(field[kAccess] == "R" || field[kAccess] == "W" || field[kAccess] == "RW" || field[kAccess] == "-");
  RegisterRow row;
  row.first = number(field[kFirst]);
  row.last = number(field[kLast]);
  row.step = number(field[kStep]);
  row.readable = field[kAccess].find('R') != std::string_view::npos;
  row.writable = field[kAccess].find('W') != std::string_view::npos;
  row.item = item->second;
  row.index = number(field[kIndex]);
  row.min = number(field[kMin]);
  row.max = number(field[kMax]);
  row.constant = number(field[kValue], 16);
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
