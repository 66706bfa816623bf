// The parameters of a family (families/*/parameters.csv): number, range, increment, default, access, and what each does
// here. Values are whole numbers of the increment ("raw"); 8888 and 9999 travel as 65520 and 65535 where a row has
// them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/inverter/model_table.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter {

inline constexpr std::int32_t kRaw9999 = 65535;
inline constexpr std::int32_t kRaw8888 = 65520;

enum class ParameterKind : std::uint8_t {
  kOrdinary,
  kCommand,       // a write does something, a read shows a result; not stored
  kManufacturer,  // reads 0, cannot be written
};
enum class ClearRule : std::uint8_t { kCleared, kAllClearOnly, kNever };

struct RawRange {
  std::int32_t low = 0;
  std::int32_t high = 0;
};

// Another increment while parameter `number` has raw value `value` (E500: the times with Pr.21 = 1).
struct FineIncrement {
  std::uint16_t number = 0;
  std::int32_t value = 0;
  int decimals = 0;
};

struct ParameterRow {
  port::ParameterId id;
  std::string label;  // "Pr.7", "Pr.902.1"
  std::string alias;  // the panel's own name where it has one (A700: "C2"), or empty
  std::string name;
  std::string unit;  // "-" where there is none
  int decimals = 0;  // increment = 10^-decimals
  std::int32_t raw_minimum = 0;
  std::int32_t raw_maximum = 0;
  std::vector<RawRange> allowed;  // empty: the whole range
  bool has_8888 = false;
  bool has_9999 = false;
  std::optional<FineIncrement> fine;
  std::int32_t raw_default = 0;          // of the family's reference model
  std::string model_default;             // rule that gives another default per model, or empty
  bool write_while_running = false;      // write disable 0
  bool write_while_running_free = true;  // write disable 2
  bool write_when_locked = false;        // write disable 1
  bool panel_any_mode = false;           // from the panel in every operation mode
  bool read_only = false;
  bool network_read_only = false;
  bool communication = false;  // kept by the clears that leave communication settings alone
  bool ram_only = false;       // never goes into the EEPROM
  ParameterKind kind = ParameterKind::kOrdinary;
  ClearRule clear = ClearRule::kCleared;
  bool acts = true;
  std::string special_text;
  std::string allowed_text;
  std::string source;
  std::string confidence;
  std::string notes;
  std::string effect;

  // The value itself, without access rules.
  bool accepts(std::int64_t raw) const;
  bool stored() const { return kind == ParameterKind::kOrdinary; }
};

class ParameterTable {
 public:
  // Error: line, column and reason.
  static Result<ParameterTable, std::string> load(std::string_view csv);
  // Other increments and ranges for some models: rows pr, increment, min, max, allowed. Defaults keep their value.
  Result<void, std::string> take_ranges(std::string_view csv);

  const std::vector<ParameterRow>& rows() const { return rows_; }
  // Position in rows(); empty if there is no such parameter.
  std::optional<std::size_t> index(port::ParameterId id) const;
  // Row of a number without sub-index; -1: none.
  std::int16_t whole(unsigned number) const { return number < kNumbers ? places_[number][0] : kNone; }
  // By "Pr.7", "7", "Pr.902.1" or an alias.
  std::optional<std::size_t> index(std::string_view label) const;
  // True for a number that exists, whatever the sub-index.
  bool has_number(std::uint32_t number) const;
  // Defaults of one model in raw, in the order of rows().
  std::vector<std::int32_t> defaults(const ModelRow& model) const;

 private:
  static constexpr std::size_t kNumbers = 1000;
  std::vector<ParameterRow> rows_;
  static constexpr std::int16_t kNone = -1;
  std::array<std::array<std::int16_t, 3>, kNumbers> places_{};  // row by number and sub-index
};

// Decimal text of a raw value and back; exact. Refuses more decimals than the increment has.
std::string raw_to_text(std::int64_t raw, int decimals);
std::optional<std::int64_t> text_to_raw(std::string_view text, int decimals);

}  // namespace vinv::inverter
