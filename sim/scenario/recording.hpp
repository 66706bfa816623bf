// What a run leaves behind: signals over time, states over time, and what went over the wires. Values only; times are
// virtual. Reports, CSV and captures are written from this.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::scenario {

// A number over time. All columns of a recording share its times.
struct SignalColumn {
  std::string drive;
  std::string name;
  std::string unit;  // "Hz", "degC"; "-": none
  std::vector<double> values;
};

// A word over time: mode, alarm, a terminal, a status bit. Exact: one entry for each change, the first at the start.
struct StateTrace {
  struct Change {
    Instant at;
    std::string value;  // "on", "off", "NET", "E.OV3"; alarm: "none"
    VINV_ARCHIVE(Change, at, value);
  };
  std::string drive;
  std::string name;
  std::vector<Change> changes;
  std::uint64_t lost = 0;  // changes beyond kMaxChanges
  VINV_ARCHIVE(StateTrace, drive, name, changes, lost);
};
inline constexpr std::size_t kMaxChanges = 100'000;

// One frame or piece of bytes on a wire.
struct WireRecord {
  enum class Kind : std::uint8_t { kCanFrame, kCanError, kSerial, kTcp, kUdp };
  friend VINV_ENUM_RANGE(Kind, kCanFrame, kUdp);
  Instant at;
  Kind kind = Kind::kSerial;
  std::string network;   // as the plant file names it
  std::string sender;    // "master", or the name of a drive
  std::uint32_t id = 0;  // CAN identifier, with the flags of SocketCAN
  Bytes bytes;
  std::uint32_t connection = 0;  // TCP: tells the connections of a network apart
  VINV_ARCHIVE(WireRecord, at, kind, network, sender, id, bytes, connection);
};

struct Recording {
  std::vector<Instant> times;  // ascending; the distance is larger where nothing happens
  std::vector<SignalColumn> columns;
  std::vector<StateTrace> states;
  std::vector<WireRecord> wire;
  Duration finest{};               // distance of samples around a trip
  Duration coarsest{};             // distance elsewhere
  std::uint64_t windows = 0;       // spans kept with every sample
  std::uint64_t windows_lost = 0;  // beyond the limit of windows; their samples are as coarse as the rest

  const SignalColumn* find(const std::string& drive, const std::string& name) const {
    for (const SignalColumn& c : columns)
      if (c.drive == drive && c.name == name) return &c;
    return nullptr;
  }
};

}  // namespace vinv::scenario
