// What a connection engine sees of a device's I/O: connection points (assembly instances), their sizes and their data.
// CIP Vol 1, 5-5 (Assembly), 3-4 and 3-5 (connections). Takes no memory per message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "option_boards/cip/status.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::cip {

enum class RunMode : std::uint8_t { kRun, kIdle };

// kExclusiveOwner: gives the output data. The others only listen.
enum class IoRole : std::uint8_t { kExclusiveOwner, kInputOnly, kListenOnly };

enum class IoEvent : std::uint8_t {
  kOpened,
  kClosed,    // by the originator or by the engine, in order
  kTimedOut,  // the originator's data stayed away
};

struct IoConnection {
  IoRole role = IoRole::kExclusiveOwner;
  std::uint32_t consumed_point = 0;  // instance that takes the originator's data; a heartbeat point if it has none
  std::uint32_t produced_point = 0;
};

class IoPoints {
 public:
  virtual ~IoPoints() = default;

  // Bytes of data, without sequence count and run/idle header. Empty: no such point in this direction, or not one that
  // the device serves at present. 0: a point without data (heartbeat; configuration that takes nothing).
  virtual std::optional<std::size_t> consumed_size(std::uint32_t point) const = 0;
  virtual std::optional<std::size_t> produced_size(std::uint32_t point) const = 0;
  virtual std::optional<std::size_t> configuration_size(std::uint32_t point) const = 0;
  // Points that take no data and keep a connection open: for input only and listen only.
  virtual bool is_heartbeat(std::uint32_t point, IoRole role) const = 0;
  // Whether two connections with these points go together (FR-A7NE manual, 7.2: 20 with 70, 21 with 71 ...).
  virtual bool goes_with(std::uint32_t consumed_point, std::uint32_t produced_point) const = 0;
  // Configuration data of a connection that is about to open; an error refuses the connection.
  virtual Status configure(Instant now, std::uint32_t point, ByteView data) = 0;

  // data has consumed_size bytes. kIdle: the originator's program does not run; its data is not to be acted on.
  virtual void consume(Instant now, std::uint32_t point, ByteView data, RunMode mode) = 0;
  // out has produced_size bytes.
  virtual void produce(Instant now, std::uint32_t point, std::span<std::uint8_t> out) = 0;
  // Changes whenever the data that produce would give may have changed: for change-of-state production.
  virtual std::uint32_t produced_version(std::uint32_t point) const = 0;

  virtual void on_connection(Instant now, const IoConnection& connection, IoEvent event) = 0;
};

}  // namespace vinv::cip
