// The alarms of a family (families/*/alarms.csv): name, data code, what trips it, retry and reset rule.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/drive/drive_core.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter {

enum class ResetRule : std::uint8_t {
  kAny,         // reset terminal, panel, network, power cycle
  kPowerCycle,  // power cycle only
};

struct AlarmRow {
  std::string name;                          // "E.OV3"
  std::string display;                       // on a panel of four digits: "E.OV3", "E.  3"
  std::uint8_t code = 0;                     // data code
  std::optional<drive::TripKind> trip_kind;  // empty: not a trip of the control core
  std::uint32_t retry_settings = 0;          // bit n: retried with retry selection n
  ResetRule reset = ResetRule::kAny;
  std::string cause;
  std::uint16_t emergency_code = 0;  // CANopen emergency error code; families with such an option
  std::uint8_t error_register = 0;   // CANopen object 1001H, the same
  std::string source;
  std::string confidence;

  bool retried_with(int selection) const {
    return selection >= 0 && selection < 32 && (retry_settings >> selection & 1u);
  }
};

class AlarmTable {
 public:
  static Result<AlarmTable, std::string> load(std::string_view csv);
  const std::vector<AlarmRow>& rows() const { return rows_; }
  std::optional<std::size_t> by_name(std::string_view name) const;
  std::optional<std::size_t> by_code(std::uint8_t code) const;
  std::optional<std::size_t> by_trip(drive::TripKind kind) const;

 private:
  std::vector<AlarmRow> rows_;  // without "none"
};

// Newest first; the oldest falls off.
void push_alarm(port::AlarmHistory& history, std::uint8_t code);

}  // namespace vinv::inverter
