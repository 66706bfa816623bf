// The error counters of one CAN node and the state that follows from them. ISO 11898-1:2015, 12.1 (fault confinement);
// the letters are those of its list of rules.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::transports {

enum class CanState : std::uint8_t {
  kErrorActive,
  kErrorWarning,  // still error active; a counter has reached 96
  kErrorPassive,
  kBusOff,
  kOffline,  // switched off, interface down, no connection
};
VINV_ENUM_RANGE(CanState, kErrorActive, kOffline);
constexpr const char* text(CanState state) {
  switch (state) {
    case CanState::kErrorActive: return "error active";
    case CanState::kErrorWarning: return "error warning";
    case CanState::kErrorPassive: return "error passive";
    case CanState::kBusOff: return "bus off";
    case CanState::kOffline: return "offline";
  }
  return "?";
}

struct CanErrorCounters {
  static constexpr int kWarningLevel = 96;
  static constexpr int kPassiveLevel = 128;
  static constexpr int kBusOffLevel = 256;
  // What a receiver returns to from error passive: the standard allows 119 to 127.
  static constexpr int kRecAfterPassive = 127;
  static constexpr int kRecMax = 255;  // more has no meaning

  int tec = 0;
  int rec = 0;
  friend constexpr bool operator==(const CanErrorCounters&, const CanErrorCounters&) = default;

  constexpr bool is_bus_off() const { return tec >= kBusOffLevel; }
  constexpr bool is_passive() const { return tec >= kPassiveLevel || rec >= kPassiveLevel; }
  constexpr CanState state() const {
    if (is_bus_off()) return CanState::kBusOff;
    if (is_passive()) return CanState::kErrorPassive;
    return tec >= kWarningLevel || rec >= kWarningLevel ? CanState::kErrorWarning : CanState::kErrorActive;
  }

  constexpr void on_transmitted() { tec = std::max(tec - 1, 0); }  // g)
  constexpr void on_received() {                                   // h)
    if (rec >= kPassiveLevel)
      rec = kRecAfterPassive;
    else if (rec > 0)
      --rec;
  }
  constexpr void on_transmit_error() { tec = std::min(tec + 8, kBusOffLevel); }  // c)
  // c), exception 1: a passive transmitter that nobody acknowledges and that sees no dominant bit in its passive error
  // flag stays as it is. So a node alone on its bus never goes bus off.
  constexpr void on_no_acknowledge() {
    if (!is_passive()) on_transmit_error();
  }
  constexpr void on_receive_error() { rec = std::min(rec + 1, kRecMax); }        // a)
  constexpr void on_dominant_after_flag() { rec = std::min(rec + 8, kRecMax); }  // b)
  VINV_ARCHIVE(CanErrorCounters, tec, rec);
};

}  // namespace vinv::transports
