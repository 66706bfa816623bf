// What a drive engineer tells a master to do, whatever the protocol: a word, the drive's address, a value.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"

namespace vinv::masters {

enum class Word : std::uint8_t {
  kEnterNetwork,  // the network gets the command right
  kLeaveNetwork,
  kRunForward,
  kRunReverse,
  kStop,  // ramp down
  kQuickStop,
  kReferenceHz,
  kReferenceRpm,
  kReset,        // of the inverter; done when it is ready again
  kFaultReset,   // after an alarm; done when the inverter is ready again
  kClearAlarms,  // the alarm history
  kWriteParameter,
  kReadParameter,
  kMonitor,
};
VINV_ENUM_RANGE(Word, kEnterNetwork, kMonitor);
inline constexpr std::size_t kWords = 14;
std::string_view name_of(Word word);  // "enter network", "run forward"

struct Order {
  std::uint8_t node = 1;  // Modbus unit, CANopen node
  Word word = Word::kStop;
  double value = 0;             // kReferenceHz, kReferenceRpm (0 or more); kWriteParameter: physical
  std::uint16_t parameter = 0;  // its number
  std::uint8_t sub = 0;         // of Pr.902-905: 1 frequency, 2 analog value
  double increment = 1;         // of the parameter: its physical value is the raw word times this
  std::string monitor;          // kMonitor: a name of the profile, "output_frequency"
  VINV_ARCHIVE(Order, node, word, value, parameter, sub, increment, monitor);
};

struct Reading {
  double value = 0;
  std::string unit;  // "Hz"; empty: none
  VINV_ARCHIVE(Reading, value, unit);
};
// What came of an order; the error is a sentence without full stop that has the protocol's own code.
using Outcome = Result<Reading, std::string>;

}  // namespace vinv::masters
