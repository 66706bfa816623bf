#include "sim/rig/ethernet_ip_port.hpp"

#include <algorithm>
#include <utility>

namespace vinv::rig {

using ethernet_ip::Channel;

EthernetIpPort::EthernetIpPort(kernel::Scheduler& scheduler, ethernet_ip::Adapter& adapter,
                               std::unique_ptr<transports::UdpPort> udp, std::unique_ptr<transports::UdpPort> io)
    : scheduler_(scheduler), adapter_(adapter), udp_(std::move(udp)), io_(std::move(io)) {
  udp_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    adapter_.handle_udp(now, from, bytes);
    poll(now);
  });
  io_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    adapter_.handle_io(now, from, bytes);
    poll(now);
  });
}

EthernetIpPort::~EthernetIpPort() {
  if (event_ != 0) scheduler_.cancel(event_);
  if (sweep_ != 0) scheduler_.cancel(sweep_);
}

void EthernetIpPort::accept(Instant now, std::unique_ptr<transports::ByteStream> stream, const Ipv4Endpoint& peer) {
  const auto id = adapter_.handle_tcp_open(now, peer);
  if (!id) return stream->close();
  connections_.push_back(std::make_unique<Connection>(Connection{*id, std::move(stream), false}));
  Connection& c = *connections_.back();
  c.stream->set_handlers(
      [this, &c](Instant at, ByteView bytes, bool) {
        if (c.closed) return;
        adapter_.handle_tcp(at, c.id, bytes);
        poll(at);
      },
      [this, &c](Instant at, const std::string&) {
        if (c.closed) return;
        adapter_.handle_tcp_closed(at, c.id);
        retire(c);
        poll(at);
      });
  poll(now);  // it may have taken the place of another one
}

void EthernetIpPort::handle_broadcast(Instant now, const Ipv4Endpoint& from, ByteView bytes) {
  adapter_.handle_udp(now, from, bytes, ethernet_ip::Cast::kBroadcast);
  poll(now);
}

void EthernetIpPort::handle_new_data(Instant now) {
  adapter_.handle_new_data(now);
  poll(now);
}

void EthernetIpPort::poll(Instant now) {
  while (const auto t = adapter_.poll_transmit(now)) {
    if (t->bytes.empty()) continue;  // for a connection that is gone
    if (t->channel == Channel::kIo) {
      io_->send(now, t->to, t->bytes, t->dscp);
    } else if (t->channel == Channel::kUdp) {
      udp_->send(now, t->to, t->bytes);
    } else if (Connection* c = find(t->connection)) {
      c->stream->send(now, t->bytes);
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
  const auto is_it = [&](const auto& c) { return c->id == id && !c->closed; };
  // Mostly the answer to a request of the connection that was found last.
  if (last_found_ < connections_.size() && is_it(connections_[last_found_])) return connections_[last_found_].get();
  const auto found = std::find_if(connections_.begin(), connections_.end(), is_it);
  if (found == connections_.end()) return nullptr;
  last_found_ = static_cast<std::size_t>(found - connections_.begin());
  return found->get();
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
  adapter_.handle_timeout(now);
  poll(now);
}

}  // namespace vinv::rig
