#include "sim/rig/ethernet_ip_port.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::rig {

using ethernet_ip::Channel;

EthernetIpPort::EthernetIpPort(kernel::Scheduler& scheduler, ethernet_ip::Adapter& adapter, OnTraffic on_traffic)
    : scheduler_(scheduler),
      adapter_(adapter),
      on_traffic_(std::move(on_traffic)),
      tcp_tap_(scheduler),
      udp_tap_(scheduler) {}

EthernetIpPort::~EthernetIpPort() {
  if (event_ != 0) scheduler_.cancel(event_);
  if (sweep_ != 0) scheduler_.cancel(sweep_);
}

void EthernetIpPort::connect(std::unique_ptr<transports::UdpPort> udp, std::unique_ptr<transports::UdpPort> io,
                             Carrier carrier) {
  udp_ = udp_tap_.wrap(std::move(udp));
  io_ = udp_tap_.wrap(std::move(io));
  carrier_ = carrier;
  udp_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    if (!link_) return;
    adapter_.handle_udp(now, from, bytes);
    settle(now);
  });
  io_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    if (!link_) return;
    adapter_.handle_io(now, from, bytes);
    settle(now);
  });
}

void EthernetIpPort::accept(Instant now, std::unique_ptr<transports::ByteStream> stream, const Ipv4Endpoint& peer) {
  if (connections_.size() >= kMaxConnections) return stream->close();
  connections_.push_back(std::make_unique<Connection>());
  Connection& c = *connections_.back();
  c.peer = peer;
  c.stream = tcp_tap_.wrap(std::move(stream));
  listen(c);
  if (link_) open(now, c);
  settle(now);  // it may have taken the place of another one
}

void EthernetIpPort::listen(Connection& c) {
  c.stream->set_handlers(
      [this, &c](Instant at, ByteView bytes, bool) {
        if (c.closed) return;
        receive(at, c, bytes);
        settle(at);
      },
      [this, &c](Instant at, const std::string&) {
        if (c.closed) return;
        c.ended = true;
        if (link_) end(at, c);
        settle(at);
      });
}

void EthernetIpPort::open(Instant now, Connection& c) {
  const auto id = adapter_.handle_tcp_open(now, c.peer);
  if (id) {
    c.id = *id;
    return;
  }
  c.stream->close();
  retire(c);
}

void EthernetIpPort::receive(Instant now, Connection& c, ByteView bytes) {
  if (link_) return adapter_.handle_tcp(now, c.id, bytes);
  if (c.to_adapter.size() + bytes.size() > kMaxHeldBytes) {
    c.stream->close();
    return end(now, c);
  }
  c.to_adapter.insert(c.to_adapter.end(), bytes.begin(), bytes.end());
}

void EthernetIpPort::send(Instant now, Connection& c, ByteView bytes) {
  if (link_) return c.stream->send(now, bytes);
  if (c.to_peer.size() + bytes.size() > kMaxHeldBytes) {
    c.stream->close();
    return end(now, c);
  }
  c.to_peer.insert(c.to_peer.end(), bytes.begin(), bytes.end());
}

void EthernetIpPort::end(Instant now, Connection& c) {
  if (c.id != 0) adapter_.handle_tcp_closed(now, c.id);
  retire(c);
}

void EthernetIpPort::handle_broadcast(Instant now, const Ipv4Endpoint& from, ByteView bytes) {
  if (!link_) return;
  adapter_.handle_udp(now, from, bytes, ethernet_ip::Cast::kBroadcast);
  settle(now);
}

void EthernetIpPort::start(Instant now, const ethernet_ip::Adapter::Address& address) {
  stop(now);
  adapter_.start(address);
}

void EthernetIpPort::stop(Instant now) {
  adapter_.stop();
  for (const auto& c : connections_) {
    if (c->closed) continue;
    c->stream->close();
    retire(*c);
  }
  poll(now);
}

void EthernetIpPort::set_link(Instant now, bool up) {
  if (std::exchange(link_, up) == up || !up) return;
  catch_up(now);
  poll(now);
}

// The cable is back: TCP repeats what has not been acknowledged.
void EthernetIpPort::catch_up(Instant now) {
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    Connection& c = *connections_[i];
    if (c.closed) continue;
    if (c.id == 0) open(now, c);
    if (c.closed) continue;
    if (!c.to_peer.empty()) c.stream->send(now, std::exchange(c.to_peer, {}));
    if (!c.to_adapter.empty()) adapter_.handle_tcp(now, c.id, std::exchange(c.to_adapter, {}));
    if (c.ended && !c.closed) end(now, c);
  }
}

void EthernetIpPort::handle_new_data(Instant now) {
  adapter_.handle_new_data(now);
  poll(now);
}

void EthernetIpPort::settle(Instant now) {
  activity_ = true;
  if (on_traffic_) return on_traffic_(now);
  poll(now);
}

void EthernetIpPort::poll(Instant now) {
  while (const auto t = adapter_.poll_transmit(now)) {
    if (t->bytes.empty()) continue;  // for a connection that is gone
    activity_ = true;
    if (t->channel == Channel::kTcp) {
      if (Connection* c = find(t->connection)) send(now, *c, t->bytes);
    } else if (link_ && udp_ != nullptr) {
      (t->channel == Channel::kIo ? io_ : udp_)->send(now, t->to, t->bytes, t->dscp);
    }
  }
  while (const auto id = adapter_.poll_tcp_close()) {
    if (Connection* c = find(*id)) {
      c->stream->close();
      retire(*c);
    }
  }
  arm();
}

EthernetIpPort::Connection* EthernetIpPort::find(ethernet_ip::TcpId id) {
  // Mostly the one behind that of the last answer: who asks at the same time is served in turn.
  std::size_t at = last_found_ < connections_.size() ? last_found_ : 0;
  for (std::size_t tries = 0; tries < connections_.size(); ++tries) {
    Connection& c = *connections_[at];
    if (c.id == id && !c.closed) {
      last_found_ = at;
      return &c;
    }
    if (++at == connections_.size()) at = 0;
  }
  return nullptr;
}

void EthernetIpPort::retire(Connection& c) {
  c.closed = true;
  if (sweep_ != 0) return;
  // Not here: the call may come out of the stream itself.
  sweep_ = scheduler_.schedule(scheduler_.now(), kernel::Priority::kObserver, [this](Instant) {
    sweep_ = 0;
    std::erase_if(connections_, [](const auto& connection) { return connection->closed; });
  });
}

void EthernetIpPort::arm() {
  const auto next = adapter_.next_deadline();
  if (event_ != 0 && next && *next == armed_for_) return;
  if (event_ != 0) scheduler_.cancel(std::exchange(event_, 0));
  if (!next) return;
  armed_for_ = *next;
  event_ = scheduler_.schedule(std::max(*next, scheduler_.now()), kernel::Priority::kBoard,
                               [this](Instant now) { on_deadline(now); });
}

void EthernetIpPort::on_deadline(Instant now) {
  event_ = 0;
  activity_ = true;
  adapter_.handle_timeout(now);
  poll(now);
}

bool EthernetIpPort::is_outside() const {
  return carrier_ == Carrier::kOutside || std::any_of(connections_.begin(), connections_.end(), [](const auto& c) {
           return !c->closed && c->stream->end_number() == 0;
         });
}

void EthernetIpPort::drop() { connections_.clear(); }

void EthernetIpPort::archive(Archive& a, transports::MemoryStreams& streams) {
  // A connection that is closed waits only for being forgotten.
  VINV_MEMBERS(*this, scheduler, adapter, on_traffic, udp, io, carrier, connections, tcp_tap, udp_tap, link, activity,
               last_found, event, sweep, armed_for);
  a.io(adapter);
  VINV_FIELDS(a, EthernetIpPort, link, activity, armed_for);
  std::vector<Connection*> held;
  for (const auto& c : connections)
    if (!c->closed) held.push_back(c.get());
  const std::size_t count = a.count(held.size(), kMaxConnections);
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    if (a.loads()) held.push_back(connections.emplace_back(std::make_unique<Connection>()).get());
    VINV_MEMBERS(*held[i], id, peer, stream, to_adapter, to_peer, ended, closed);
    VINV_FIELDS(a, Connection, id, peer, to_adapter, to_peer, ended);
    streams.archive_end(a, stream);
    if (!a.loads()) continue;
    a.require(stream != nullptr, "a connection is none");
    if (a.failed()) break;
    stream = tcp_tap.wrap(std::move(stream));
    listen(*held[i]);
  }
  if (a.failed()) return;
  a.io(tcp_tap);
  a.io(udp_tap);
  a.must_match("UDP ports of an adapter", std::uint64_t{udp != nullptr});
  if (udp != nullptr && !a.failed()) {
    a.io(*udp);
    a.io(*io);
  }
  scheduler.archive_event(a, event, [this](Instant now) { on_deadline(now); });
}

}  // namespace vinv::rig
