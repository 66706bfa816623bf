// One Modbus/TCP port: the drives behind it, by unit identifier, and the connections to it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "option_boards/modbus/tcp_session.hpp"
#include "option_boards/modbus/unit_table.hpp"
#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/rig/wire_tap.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::rig {

class TcpPort {
 public:
  // A further connection is closed at once.
  static constexpr std::size_t kMaxConnections = 256;

  explicit TcpPort(kernel::Scheduler& scheduler) : scheduler_(scheduler) {}
  // The unit outlives the port.
  void add(modbus::Unit& unit) { units_.add(unit); }
  void accept(Instant now, std::unique_ptr<transports::ByteStream> stream);
  // Sends the answers that have become due; after each tick of the drives.
  void poll(Instant now);
  std::size_t connections() const { return connections_.size(); }
  // Connections of clients outside the plant; a snapshot leaves them out.
  std::size_t outside() const;

  // Before a load: the sessions end while the units are still theirs.
  void drop();
  // Snapshots: after the units and the net of which the connections are. A load is for a port without any; it wraps
  // them anew by the tap, which is archived after it.
  void archive(Archive& a, transports::MemoryStreams& streams, WireTap& tap);

 private:
  struct Connection {
    Connection(std::unique_ptr<transports::ByteStream> s, modbus::ClientId number, modbus::UnitRouter& router)
        : stream(std::move(s)), client(number), session(number, router) {}
    std::unique_ptr<transports::ByteStream> stream;
    modbus::ClientId client;
    modbus::TcpSession session;
    bool closed = false;
  };

  void listen(Connection& connection);
  void drain(Instant now, Connection& connection);
  void retire(Connection& connection);

  kernel::Scheduler& scheduler_;
  modbus::UnitTable units_;
  std::vector<std::unique_ptr<Connection>> connections_;
  modbus::ClientId next_client_ = 0;
};

}  // namespace vinv::rig
