// The values of one inverter's parameters: a RAM image that acts, an EEPROM image that survives a power cycle.
// The only place where raw values and physical values are converted. Copyable; the table must outlive it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motor_model/inverter/parameter_table.hpp"

namespace vinv::inverter {

enum class Storage : std::uint8_t { kRamOnly, kRamAndEeprom };
enum class ClearKind : std::uint8_t { kParameterClear, kAllClear };

class ParameterStore {
 public:
  ParameterStore(const ParameterTable& table, const ModelRow& model);

  const ParameterTable& table() const { return *table_; }

  // Physical value in RAM; 9999.0 and 8888.0 where the parameter is set to those. 0 for a number that does not exist.
  double value(unsigned number, unsigned sub) const;
  double value(unsigned number) const {
    const auto row = table_->whole(number);
    return row >= 0 ? physical_[static_cast<std::size_t>(row)] : 0;
  }
  std::int32_t integer(unsigned number) const { return static_cast<std::int32_t>(value(number)); }
  bool is_9999(unsigned number) const;
  std::int32_t raw(std::size_t row) const { return ram_[row]; }
  std::int32_t eeprom_raw(std::size_t row) const { return eeprom_[row]; }
  std::int32_t factory_raw(std::size_t row) const { return factory_[row]; }

  // Digits after the point that the row has now (E500: Pr.21 makes those of the ramp times two).
  int decimals(std::size_t row) const { return decimals_in(row, ram_); }
  int eeprom_decimals(std::size_t row, const std::vector<std::int32_t>& image) const { return decimals_in(row, image); }
  double physical(std::size_t row, std::int32_t raw) const;
  // Text of a raw value of this row, "9999" and "8888" included.
  std::string text(std::size_t row, std::int32_t raw) const;
  // Raw of a physical value; an error says what is allowed.
  Result<std::int32_t, std::string> from_physical(std::size_t row, double value) const;
  // "0 to 360 s in steps of 0.1, 9999"
  std::string allowed_text(std::size_t row) const;

  // Without access rules; the row must accept the value.
  void write(std::size_t row, std::int32_t raw, Storage storage);
  void set_factory(std::size_t row, std::int32_t raw);  // both images, too
  // Both images, by each row's clear rule; communication settings may be left alone where rows are marked as such.
  void clear(ClearKind kind, bool communication_too = true);
  void clear_to_factory();                              // EEPROM and RAM, every row: the contents are lost
  void load_ram_from_eeprom();                          // power-on and reset
  void set_eeprom(const std::vector<std::int32_t>& image);
  const std::vector<std::int32_t>& eeprom() const { return eeprom_; }

  // Grows with every change of the RAM image, so that derived values are made anew only then.
  std::uint32_t revision() const { return revision_; }

  // Both images and the factory values; a load refuses what the table does not accept.
  friend void archive(Archive& a, ParameterStore& store);

 private:
  int decimals_in(std::size_t row, const std::vector<std::int32_t>& image) const;
  void ram_changed();

  const ParameterTable* table_;
  std::vector<std::int32_t> factory_;
  std::vector<std::int32_t> ram_;
  std::vector<std::int32_t> eeprom_;
  std::vector<double> physical_;  // of the RAM image, row by row: control reads some dozens in each tick
  std::uint32_t revision_ = 1;
};

}  // namespace vinv::inverter
