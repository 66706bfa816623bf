// The EEPROM of one inverter as text: a versioned header with family and model, one line per stored parameter,
// counters, user groups, the alarm history, and a CRC-32 over everything before it in the last line. Strict: what
// parse() accepts is what emit() wrote, so a changed byte never passes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/inverter/alarm_table.hpp"
#include "motor_model/inverter/parameter_store.hpp"
#include "motor_model/inverter/user_groups.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter {

// What the EEPROM holds besides parameters.
struct EepromRecord {
  std::int32_t panel_frequency = 0;    // 0.01 Hz, set at the panel
  std::int32_t remote_frequency = 0;   // 0.01 Hz, of remote setting
  std::int64_t operating_seconds = 0;  // with the output on
  std::int32_t retry_count = 0;        // successful retries
  std::array<UserGroup, 2> groups{};
  port::AlarmHistory alarms{};
  static constexpr std::size_t kMostCounters = 32;
  std::array<std::int64_t, kMostCounters> counters{};  // what the family counts besides, by its own names
  friend bool operator==(const EepromRecord&, const EepromRecord&) = default;
  VINV_ARCHIVE(EepromRecord, panel_frequency, remote_frequency, operating_seconds, retry_count, groups, alarms,
               counters);
};

struct EepromContents {
  std::vector<std::int32_t> parameters;  // raw, in the order of the table's rows
  EepromRecord record;
};

struct EepromIdentity {
  std::string_view family;
  std::string_view model;
  std::span<const std::string_view> counters{};  // names of EepromRecord::counters
};

inline constexpr int kEepromVersion = 1;

std::string emit_eeprom(const EepromIdentity& identity, const ParameterStore& store, const AlarmTable& alarms,
                        const EepromRecord& record);

// Error: "line 12: Pr.7: takes 0.0 to 3600.0 s in steps of 0.1". The store gives table and factory values only.
Result<EepromContents, std::string> parse_eeprom(std::string_view text, const EepromIdentity& identity,
                                                 const ParameterStore& store, const AlarmTable& alarms);

std::uint32_t crc32(std::string_view bytes);  // IEEE 802.3, reflected

}  // namespace vinv::inverter
