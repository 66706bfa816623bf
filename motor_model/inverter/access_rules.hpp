// Who may write which parameter when. The rules are data of the row and of the situation; which parameter holds the
// write disable setting is the personality's. FR-E500: Pr.77, typical for the family; network: OI-FR-E5NCO manual 8.7.
#pragma once

#include <cstdint>
#include <optional>

#include "motor_model/inverter/parameter_table.hpp"
#include "motor_model/port/drive_port.hpp"

namespace vinv::inverter {

enum class Writer : std::uint8_t { kPanel, kNetwork };

enum class WriteDisable : std::uint8_t {
  kStopped,  // 0: only while stopped, but for rows that say otherwise
  kLocked,   // 1: only rows that stay writable when locked
  kAlways,   // 2: while running too, but for rows that say otherwise; in every operation mode
};

struct AccessSituation {
  Writer writer = Writer::kPanel;
  port::OperationMode mode = port::OperationMode::kExternal;
  WriteDisable disable = WriteDisable::kStopped;
  bool running = false;
  bool in_user_group = true;  // panel only: the row is in a group that may be seen
};

// Empty: may be written (the value is checked apart).
std::optional<port::Refusal> write_refusal(const ParameterRow& row, const AccessSituation& situation);

// Parameter clear and all clear: stopped, not locked, and the mode as for a write.
std::optional<port::Refusal> clear_refusal(const AccessSituation& situation);

}  // namespace vinv::inverter
