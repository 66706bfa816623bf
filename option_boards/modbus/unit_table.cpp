#include "option_boards/modbus/unit_table.hpp"

#include <algorithm>

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

void UnitTable::archive_unit(Archive& a, Unit*& unit) {
  auto index = static_cast<std::uint64_t>(std::find(units_.begin(), units_.end(), unit) - units_.begin());
  a.io(index);
  a.require(index <= units_.size(), "a Modbus unit that there is not");
  if (a.loads() && !a.failed()) unit = index < units_.size() ? units_[index] : nullptr;
}

}  // namespace vinv::modbus
