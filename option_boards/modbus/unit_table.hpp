// Which unit a Modbus/TCP unit identifier means: several drives behind one port.
// MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 4.4.1.2 (use of the unit identifier).
#pragma once

#include <cstdint>
#include <vector>

#include "option_boards/modbus/unit.hpp"
#include "sim/base/archive.hpp"

namespace vinv::modbus {

class UnitRouter {
 public:
  virtual ~UnitRouter() = default;
  // nullptr: nobody answers under this identifier.
  virtual Unit* route(std::uint8_t unit_id) = 0;
  // Snapshots: one of its units, or nullptr.
  virtual void archive_unit(Archive& a, Unit*& unit) = 0;
};

// Units by their present address. 0 and 255 mean "the device at this IP address": the unit itself where exactly one is
// served, nobody where the port is a gateway to several. If two units have the same address the first added answers.
class UnitTable final : public UnitRouter {
 public:
  // The unit outlives the table.
  void add(Unit& unit) { units_.push_back(&unit); }
  Unit* route(std::uint8_t unit_id) override;
  void archive_unit(Archive& a, Unit*& unit) override;

 private:
  std::vector<Unit*> units_;
};

}  // namespace vinv::modbus
