// The object dictionary as a table: one CSV row per object or range of objects. CiA DS-301 v4.0, 9.5.
//
// Columns: first, last (hex index), sub_first, sub_last, type, access (RO WO RW), pdo (r: RPDO, t: TPDO, rt), item,
// argument, default, min, max; further columns (name, section, ...) are for people. Rows are in order of the first
// index; rows of one index have the same range. default: a number, $NODEID+number, or four characters.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace vinv::canopen {

enum class DataType : std::uint8_t { kInteger8, kInteger16, kUnsigned8, kUnsigned16, kUnsigned32, kVisibleString4 };

// Bytes; everything fits an expedited transfer.
constexpr unsigned size_of(DataType type) {
  switch (type) {
    case DataType::kInteger8:
    case DataType::kUnsigned8: return 1;
    case DataType::kInteger16:
    case DataType::kUnsigned16: return 2;
    default: return 4;
  }
}

struct ObjectRow {
  std::uint16_t first = 0, last = 0;
  std::uint8_t first_sub = 0, last_sub = 0;
  DataType type = DataType::kUnsigned8;
  bool readable = false, writable = false;
  bool in_rpdo = false, in_tpdo = false;
  std::uint8_t item = 0;       // position in the list of item names
  std::uint32_t argument = 0;  // what the item needs to know of the first index and sub-index
  bool default_adds_node = false;
  std::uint32_t raw_default = 0;  // as it travels, the first byte lowest
  std::int64_t min = 0, max = 0;  // what may be written

  bool contains(std::uint16_t index) const { return index >= first && index <= last; }
  bool contains(std::uint16_t index, std::uint8_t sub) const {
    return contains(index) && sub >= first_sub && sub <= last_sub;
  }
  // A value as it travels, with its sign.
  std::int64_t value_of(std::uint32_t raw) const;
};

// Items that the slave serves itself; an application's own items follow.
enum SlaveItem : std::uint8_t { kCommunication, kConstant, kErrorRegister, kFirstApplicationItem };
inline constexpr std::array<std::string_view, kFirstApplicationItem> kSlaveItemNames{"communication", "constant",
                                                                                     "error_register"};

class ObjectTable {
 public:
  // A table of this tree and the application's item names in the order of its own numbers, which start at
  // kFirstApplicationItem. A mistake in the table ends the process.
  ObjectTable(std::string_view csv, std::span<const std::string_view> application_items);
  // nullptr: no row has this index (this index and sub-index).
  const ObjectRow* find(std::uint16_t index) const;
  const ObjectRow* find(std::uint16_t index, std::uint8_t sub) const;
  const std::vector<ObjectRow>& rows() const { return rows_; }

 private:
  std::vector<ObjectRow> rows_;
};

}  // namespace vinv::canopen
