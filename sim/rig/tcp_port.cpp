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
  listen(*connections_.back());
}

void TcpPort::listen(Connection& c) {
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

void TcpPort::drop() { connections_.clear(); }

std::size_t TcpPort::outside() const {
  return static_cast<std::size_t>(std::count_if(connections_.begin(), connections_.end(), [](const auto& c) {
    return !c->closed && c->stream->end_number() == 0;
  }));
}

void TcpPort::archive(Archive& a, transports::MemoryStreams& streams, WireTap& tap) {
  // One that is closed waits only for being forgotten.
  VINV_MEMBERS(*this, scheduler, units, connections, next_client);
  std::vector<Connection*> held;
  for (const auto& c : connections)
    if (!c->closed && c->stream->end_number() != 0) held.push_back(c.get());
  VINV_FIELDS(a, TcpPort, next_client);
  const std::size_t count = a.count(held.size(), kMaxConnections);
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    modbus::ClientId client = a.loads() ? 0 : held[i]->client;
    a.io(client);
    if (!a.loads()) {
      streams.archive_end(a, held[i]->stream);
      a.io(held[i]->session);
      continue;
    }
    std::unique_ptr<transports::ByteStream> stream;
    streams.archive_end(a, stream);
    a.require(stream != nullptr && client < next_client, "a connection is none");
    if (a.failed()) break;
    connections.push_back(std::make_unique<Connection>(tap.wrap(std::move(stream)), client, units));
    listen(*connections.back());
    a.io(connections.back()->session);
  }
}

}  // namespace vinv::rig
