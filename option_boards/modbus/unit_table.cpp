#include "option_boards/modbus/unit_table.hpp"

namespace vinv::modbus {

Unit* UnitTable::route(std::uint8_t unit_id) {
  if (unit_id == 0 || unit_id == 255) {
    const bool alone = units_.size() == 1 && units_.front()->address() != 0;
    return alone ? units_.front() : nullptr;
  }
  for (Unit* unit : units_) {
    if (unit->address() == unit_id) return unit;
  }
  return nullptr;
}

}  // namespace vinv::modbus
