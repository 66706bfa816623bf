// The three LEDs of the FR-A7NE. FR-A7NE manual, 1.2.
#pragma once

#include <string_view>

namespace vinv::boards::fr_a7ne {

struct LedSituation {
  bool supplied = false;
  bool self_test = false;     // the first time after power-on
  bool initializing = false;  // the inverter is not ready: start-up, or a reset
  bool minor_fault = false;   // an alarm of the inverter
  bool major_fault = false;   // of the option itself
  bool has_address = false;
  bool duplicate_address = false;
  bool connected = false;  // at least one connection
  bool timed_out = false;  // a connection that has not been opened again
  bool link = false;
  bool traffic = false;  // lately
};

// LED 1. Unspecified: which of several at once; here the worst.
constexpr std::string_view module_led(const LedSituation& s) {
  if (!s.supplied) return "off";
  if (s.major_fault) return "red";
  if (s.self_test) return "green and red flashing";
  if (s.minor_fault) return "red flashing";
  return s.initializing ? "green" : "green flashing";
}

// LED 2.
constexpr std::string_view network_led(const LedSituation& s) {
  if (!s.supplied) return "off";
  if (s.self_test) return "green and red flashing";
  if (s.duplicate_address) return "red";
  if (!s.has_address) return "off";
  if (s.timed_out) return "red flashing";
  return s.connected ? "green" : "green flashing";
}

// LED 3.
constexpr std::string_view link_led(const LedSituation& s) {
  if (!s.supplied || s.self_test || !s.link) return "off";
  return s.traffic ? "green flashing" : "green";
}

}  // namespace vinv::boards::fr_a7ne
