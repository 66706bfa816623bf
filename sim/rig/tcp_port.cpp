#include "sim/rig/tcp_port.hpp"

#include <algorithm>
#include <utility>

namespace vinv::rig {

void TcpPort::accept(Instant, std::unique_ptr<transports::ByteStream> stream) {
  if (connections_.size() >= kMaxConnections) {
    stream->close();
    return;
  }

  connections_.push_back(std::make_unique<Connection>(std::move(stream), next_client_++, units_));
  Connection& c = *connections_.back();
  c.stream->set_handlers(
      [this, &c](Instant at, ByteView bytes, bool) {
        if (c.closed) return;
        c.session.handle_bytes(at, bytes);
        drain(at, c);
      },
      [this, &c](Instant, const std::string&) { retire(c); });
}

void TcpPort::poll(Instant now) {
  for (const auto& c : connections_)
    if (!c->closed && c->session.awaiting_answer()) drain(now, *c);
}

void TcpPort::drain(Instant now, Connection& c) {
  while (!c.closed) {
    const auto adu = c.session.poll_transmit(now);
    if (!adu) break;
    c.stream->send(now, *adu);
  }
  if (!c.closed && c.session.close_requested()) {
    c.stream->close();
    retire(c);
  }
}

void TcpPort::retire(Connection& c) {
  if (c.closed) return;
  c.closed = true;
  c.session.handle_closed();
  // Not here: the call may come out of the stream itself.
  scheduler_.schedule(scheduler_.now(), kernel::Priority::kObserver, [this](Instant) {
    std::erase_if(connections_, [](const auto& connection) { return connection->closed; });
  });
}

}  // namespace vinv::rig
