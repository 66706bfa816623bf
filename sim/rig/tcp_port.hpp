// One Modbus/TCP port: the drives behind it, by unit identifier, and the connections to it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "option_boards/modbus/tcp_session.hpp"
#include "option_boards/modbus/unit_table.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/check.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"

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
  // Snapshots: of a port without connections only the number of the next one is left.
  friend void archive(Archive& a, TcpPort& port) {
    VINV_MEMBERS(port, scheduler, units, connections, next_client);
    VINV_CHECK(connections.empty());
    a.io(next_client);
  }

 private:
  struct Connection {
    Connection(std::unique_ptr<transports::ByteStream> s, modbus::ClientId client, modbus::UnitRouter& router)
        : stream(std::move(s)), session(client, router) {}
    std::unique_ptr<transports::ByteStream> stream;
    modbus::TcpSession session;
    bool closed = false;
  };

  void drain(Instant now, Connection& connection);
  void retire(Connection& connection);

  kernel::Scheduler& scheduler_;
  modbus::UnitTable units_;
  std::vector<std::unique_ptr<Connection>> connections_;
  modbus::ClientId next_client_ = 0;
};

}  // namespace vinv::rig
