#include "option_boards/canopen/object_table.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/base/table_text.hpp"

namespace vinv::canopen {
namespace {

enum Column : std::size_t {
  kFirst,
  kLast,
  kSubFirst,
  kSubLast,
  kType,
  kAccess,
  kPdo,
  kItem,
  kArgument,
  kDefault,
  kMin,
  kMax,
  kColumnsUsed
};

struct TypeName {
  std::string_view name;
  DataType type;
  std::int64_t min, max;
};
constexpr std::array<TypeName, 6> kTypes{{
    {"INTEGER8", DataType::kInteger8, -0x80, 0x7f},
    {"INTEGER16", DataType::kInteger16, -0x8000, 0x7fff},
    {"UNSIGNED8", DataType::kUnsigned8, 0, 0xff},
    {"UNSIGNED16", DataType::kUnsigned16, 0, 0xffff},
    {"UNSIGNED32", DataType::kUnsigned32, 0, 0xffffffff},
    {"VISIBLE_STRING", DataType::kVisibleString4, 0, 0xffffffff},
}};

std::uint32_t raw_text(std::string_view text) {
  VINV_CHECK(text.size() == size_of(DataType::kVisibleString4));
  std::uint32_t raw = 0;
  for (std::size_t i = text.size(); i-- > 0;) raw = raw << 8 | static_cast<std::uint8_t>(text[i]);
  return raw;
}

std::uint8_t item_number(std::string_view name, std::span<const std::string_view> application_items) {
  const auto own = std::find(kSlaveItemNames.begin(), kSlaveItemNames.end(), name);
  if (own != kSlaveItemNames.end()) return static_cast<std::uint8_t>(own - kSlaveItemNames.begin());
  const auto found = std::find(application_items.begin(), application_items.end(), name);
  VINV_CHECK(found != application_items.end());
  return static_cast<std::uint8_t>(kFirstApplicationItem + (found - application_items.begin()));
}

ObjectRow parse_row(std::string_view line, std::span<const std::string_view> application_items) {
  std::array<std::string_view, kColumnsUsed> field;
  for (auto& f : field) f = take_until(line, ',');
  const auto type = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.name == field[kType]; });
  VINV_CHECK(type != kTypes.end());
  VINV_CHECK(field[kAccess] == "RO" || field[kAccess] == "WO" || field[kAccess] == "RW");
  VINV_CHECK(field[kPdo].find_first_not_of("rt") == std::string_view::npos);
  ObjectRow row;
  row.first = number_of_field<std::uint16_t>(field[kFirst], 0, 16);
  row.last = number_of_field(field[kLast], row.first, 16);
  row.first_sub = number_of_field<std::uint8_t>(field[kSubFirst], 0);
  row.last_sub = number_of_field(field[kSubLast], row.first_sub);
  row.type = type->type;
  row.readable = field[kAccess] != "WO";
  row.writable = field[kAccess] != "RO";
  row.in_rpdo = field[kPdo].find('r') != std::string_view::npos;
  row.in_tpdo = field[kPdo].find('t') != std::string_view::npos;
  row.item = item_number(field[kItem], application_items);
  row.argument = number_of_field<std::uint32_t>(field[kArgument], 0);
  row.min = number_of_field(field[kMin], type->min);
  row.max = number_of_field(field[kMax], type->max);
  constexpr std::string_view kNodePrefix = "$NODEID+";
  std::string_view text = field[kDefault];
  if (text.starts_with(kNodePrefix)) {
    row.default_adds_node = true;
    text.remove_prefix(kNodePrefix.size());
  }
  row.raw_default = row.type == DataType::kVisibleString4 ? raw_text(text) : number_of_field<std::uint32_t>(text, 0);
  VINV_CHECK(row.first <= row.last && row.first_sub <= row.last_sub);
  return row;
}

}  // namespace

std::int64_t ObjectRow::value_of(std::uint32_t raw) const {
  switch (type) {
    case DataType::kInteger8: return static_cast<std::int8_t>(raw);
    case DataType::kInteger16: return static_cast<std::int16_t>(raw);
    default: return raw;
  }
}

ObjectTable::ObjectTable(std::string_view csv, std::span<const std::string_view> application_items) {
  take_until(csv, '\n');
  while (!csv.empty()) {
    rows_.push_back(parse_row(take_until(csv, '\n'), application_items));
    if (rows_.size() == 1) continue;
    const ObjectRow& before = rows_[rows_.size() - 2];
    const ObjectRow& row = rows_.back();
    const bool next_object = row.first > before.last;
    const bool same_object = row.first == before.first && row.last == before.last && row.first_sub > before.last_sub;
    VINV_CHECK(next_object || same_object);
  }
}

const ObjectRow* ObjectTable::find(std::uint16_t index) const {
  const auto after = std::upper_bound(rows_.begin(), rows_.end(), index,
                                      [](std::uint16_t i, const ObjectRow& row) { return i < row.first; });
  if (after == rows_.begin() || !std::prev(after)->contains(index)) return nullptr;
  return &*std::prev(after);
}

const ObjectRow* ObjectTable::find(std::uint16_t index, std::uint8_t sub) const {
  const ObjectRow* row = find(index);
  while (row != nullptr && !row->contains(index, sub)) {
    // The rows of one index lie side by side, the last one was found.
    row = row == rows_.data() || !(row - 1)->contains(index) ? nullptr : row - 1;
  }
  return row;
}

}  // namespace vinv::canopen
