// The board's Modbus address map as a table: registers.csv. OI-FR-E5NCO manual, 8.7 and 11.3.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace vinv::boards::oi_fr_e5nco {

enum class Item : std::uint8_t {
  kNone,       // an address that the manual excludes
  kParameter,  // index: parameter number
  kAlarms,     // index: pair of the alarm history, 0 the newest
  kMonitor,    // index: monitor number
  kStatus,
  kCommand,
  kFrequency,
  kRpm,  // index when read: monitor number
  kAnalog,
  kClearAlarms,
  kReset,
  kNetworkMode,
  kConstant,
};

struct RegisterRow {
  std::uint16_t first = 0, last = 0, step = 2;  // addresses as they travel; items only at first + n * step
  bool readable = false, writable = false;
  Item item = Item::kNone;
  std::uint16_t index = 0;         // of the item at first; the next item has the next index
  std::uint16_t min = 0, max = 0;  // what may be written
  std::uint16_t constant = 0;

  bool contains(std::uint32_t address) const {
    return address >= first && address <= last && (address - first) % step == 0;
  }
  std::uint16_t index_at(std::uint32_t address) const {
    return static_cast<std::uint16_t>(index + (address - first) / step);
  }
};

class RegisterMap {
 public:
  // A table of this tree; a mistake in it ends the process.
  explicit RegisterMap(std::string_view csv);
  // nullptr: nothing to read (to write) at this address. Addresses past 65535 are allowed and hold nothing.
  const RegisterRow* find_readable(std::uint32_t address) const;
  const RegisterRow* find_writable(std::uint32_t address) const;
  const std::vector<RegisterRow>& rows() const { return rows_; }

 private:
  std::vector<RegisterRow> rows_;
};

// The board's map; one constant table for all boards of the process.
const RegisterMap& register_map();

}  // namespace vinv::boards::oi_fr_e5nco
