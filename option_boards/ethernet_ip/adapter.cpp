#include "option_boards/ethernet_ip/adapter.hpp"

#include <algorithm>
#include <utility>

#include "option_boards/cip/unconnected_send.hpp"

namespace vinv::ethernet_ip {
namespace {

constexpr std::size_t kReplyHeader = 4;       // service, reserved, general status, size of the extended status
constexpr std::size_t kUnconnectedRoom = 40;  // of an encapsulated message for everything but the service data
constexpr std::size_t kSequenceCount = 2;

bool is_connection_manager(const cip::Request& request) {
  return request.path == cip::ObjectPath{kConnectionManagerClass, 1, std::nullopt, std::nullopt};
}

}  // namespace

Adapter::Adapter(cip::Device& device, const AdapterOptions& options)
    : device_(device),
      encapsulation_(*this, options.encapsulation, options.seed),
      connections_(device, options.connections, options.seed ^ 0x2222) {
  connections_.on_explicit_closed([this](std::size_t slot) { forget_explicit(slot); });
  device_.router().add(kConnectionManagerClass, connections_);
}

void Adapter::start(const Address& address) {
  stop();
  address_ = address;
  connections_.set_address(address);
  started_ = true;
}

void Adapter::stop() {
  started_ = false;
  for (const Waiting& w : waiting_) device_.router().forget(w.ticket);
  waiting_.clear();
  connections_.close_all();
  encapsulation_.close_all();
}

std::optional<TcpId> Adapter::handle_tcp_open(Instant now, const Ipv4Endpoint& peer) {
  if (!started_) return std::nullopt;
  return encapsulation_.handle_tcp_open(now, peer);
}

void Adapter::handle_tcp(Instant now, TcpId connection, ByteView bytes) {
  encapsulation_.handle_tcp(now, connection, bytes);
}

void Adapter::handle_tcp_closed(Instant now, TcpId connection) { encapsulation_.handle_tcp_closed(now, connection); }

void Adapter::handle_udp(Instant now, const Ipv4Endpoint& from, ByteView datagram, Cast cast) {
  if (started_) encapsulation_.handle_udp(now, from, datagram, cast);
}

void Adapter::handle_io(Instant now, const Ipv4Endpoint& from, ByteView datagram) {
  if (started_) connections_.handle_io(now, from, datagram);
}

void Adapter::handle_timeout(Instant now) {
  encapsulation_.handle_timeout(now);
  connections_.handle_timeout(now);
}

std::optional<Instant> Adapter::next_deadline() const {
  const auto a = encapsulation_.next_deadline();
  const auto b = connections_.next_deadline();
  if (!a || !b) return a ? a : b;
  return std::min(*a, *b);
}

std::optional<Transmit> Adapter::poll_transmit(Instant now) {
  if (!waiting_.empty()) drain_replies();
  // Answers first: the Forward_Open's before the first packet of its production.
  if (auto transmit = encapsulation_.poll_transmit()) return transmit;
  return connections_.poll_transmit(now);
}

ListedIdentity Adapter::listed_identity() const {
  const cip::Identity& i = device_.identity();
  return {{address_.address, kEncapsulationPort},
          i.vendor_id,
          i.device_type,
          i.product_code,
          i.major_revision,
          i.minor_revision,
          device_.identity_status(),
          i.serial_number,
          i.product_name,
          static_cast<std::uint8_t>(device_.identity_state())};
}

// Unconnected_Send to this device itself stands for the request in it. Vol 1, 3-5.5.4. False: message_ is its refusal.
bool Adapter::unwrap(ByteView& message) {
  if (message.empty() || message[0] != cip::kUnconnectedSend) return true;
  const auto outer = cip::parse_request(message);
  if (outer.service != cip::kUnconnectedSend || !outer.request || !is_connection_manager(*outer.request)) return true;
  const auto send = cip::parse_unconnected_send(outer.request->data);
  if (!send || send->message.empty()) {
    reply_.refuse({cip::GeneralStatus::kConnectionFailure,
                   static_cast<std::uint16_t>(ConnectionStatus::kParameterErrorInUnconnectedSend)});
    reply_.data.resize(2);  // no path is left
  } else if (cip::route_ends_here(*send, reply_)) {
    message = send->message;
    return true;
  }
  cip::append_reply(message_, cip::kUnconnectedSend, reply_);
  return false;
}

std::optional<cip::Ticket> Adapter::dispatch(Instant now, ByteView message, std::size_t reply_limit,
                                             ConnectionManager::Exchange& exchange) {
  message_.clear();
  reply_.clear();
  if (!unwrap(message)) return std::nullopt;
  auto parsed = cip::parse_request(message);
  if (!parsed.request) {
    reply_.refuse(parsed.request.error());
    cip::append_reply(message_, parsed.service, reply_);
    return std::nullopt;
  }
  parsed.request->origin = exchange.tcp;
  parsed.request->reply_limit = reply_limit;
  connections_.set_exchange(&exchange);
  const auto ticket = device_.router().handle(now, *parsed.request, reply_);
  connections_.set_exchange(nullptr);
  if (!ticket) cip::append_reply(message_, parsed.service, reply_);
  return ticket;
}

void Adapter::on_unconnected(Instant now, const ReplyTo& from, const Ipv4Endpoint& peer, const CommonPacket& packet) {
  ConnectionManager::Exchange exchange;
  exchange.originator = peer;
  exchange.tcp = from.connection;
  exchange.t2o_asked = packet.t2o_sockaddr;
  const auto ticket = dispatch(now, packet.data, kMaxEncapsulatedData - kUnconnectedRoom, exchange);
  if (ticket) {
    waiting_.push_back({*ticket, from});
    return;
  }
  encapsulation_.send_unconnected(from, message_, exchange.o2t_answer, exchange.t2o_answer);
}

void Adapter::on_connected(Instant now, const ReplyTo& from, const CommonPacket& packet) {
  Connection* c = connections_.find_explicit(packet.connection_id, from.connection);
  // A packet for no connection, or larger than agreed, is passed over: there is no answer that could carry the refusal.
  if (c == nullptr || packet.data.size() < kSequenceCount || packet.data.size() > c->o2t.size) return;
  const std::uint16_t sequence = read_le16(packet.data, 0);
  connections_.restart(now, *c);
  // The same count again: the answer got lost, so it is sent again (Vol 1, 3-4.4.6).
  if (c->last_request == sequence) {
    if (!c->last_reply.empty()) encapsulation_.send_connected(from, c->t2o_id, sequence, c->last_reply);
    return;
  }
  const std::size_t slot = connections_.slot_of(*c);
  const std::uint32_t o2t_id = c->o2t_id;
  forget_explicit(slot);  // whoever asks anew waits no longer
  c->last_request = sequence;
  c->last_reply.clear();
  ConnectionManager::Exchange exchange;
  if (const auto peer = encapsulation_.peer(from.connection)) exchange.originator = *peer;
  exchange.tcp = from.connection;
  const std::size_t limit = c->t2o.size - kSequenceCount - kReplyHeader;
  const auto ticket = dispatch(now, packet.data.subspan(kSequenceCount), limit, exchange);
  Waiting waiting{ticket.value_or(0), from, true, slot, o2t_id, sequence};
  if (ticket) {
    waiting_.push_back(waiting);
  } else {
    finish(waiting);
  }
}

void Adapter::finish(const Waiting& w) {
  if (!w.connected) return encapsulation_.send_unconnected(w.to, message_, std::nullopt, std::nullopt);
  Connection* c = connections_.find_slot(static_cast<std::size_t>(w.slot), w.o2t_id);
  // The request may have closed its own connection.
  if (c == nullptr || c->last_request != w.sequence) return;
  c->last_reply = message_;
  encapsulation_.send_connected(w.to, c->t2o_id, w.sequence, message_);
}

void Adapter::drain_replies() {
  while (const auto done = device_.router().poll_reply()) {
    const auto w = std::find_if(waiting_.begin(), waiting_.end(),
                                [&](const Waiting& waiting) { return waiting.ticket == done->ticket; });
    if (w == waiting_.end()) continue;
    message_.clear();
    cip::append_reply(message_, done->service, done->reply);
    finish(*w);
    waiting_.erase(w);
  }
}

void Adapter::forget_explicit(std::size_t slot) {
  std::erase_if(waiting_, [&](const Waiting& w) {
    if (!w.connected || w.slot != slot) return false;
    device_.router().forget(w.ticket);
    return true;
  });
}

void Adapter::on_tcp_closed(Instant now, TcpId connection) {
  std::erase_if(waiting_, [&](const Waiting& w) {
    if (w.to.connection != connection) return false;
    device_.router().forget(w.ticket);
    return true;
  });
  connections_.handle_tcp_closed(now, connection);
}

}  // namespace vinv::ethernet_ip
