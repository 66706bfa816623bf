#include "option_boards/ethernet_ip/encapsulation_server.hpp"

#include <algorithm>

namespace vinv::ethernet_ip {
namespace {

constexpr std::size_t kRegisterSessionData = 4;  // version, options
constexpr std::size_t kSendDataPrefix = 4 + 2;   // interface handle, time-out
constexpr std::uint32_t kCipInterface = 0;
constexpr std::uint16_t kTcpCapability = 0x0020;  // CIP encapsulated over TCP
constexpr std::uint16_t kUdpCapability = 0x0100;  // transport class 0 and 1 over UDP
constexpr std::string_view kServiceName = "Communications";
constexpr std::size_t kServiceNameLength = 16;

bool is(const EncapsulationHeader& header, Command command) {
  return header.command == static_cast<std::uint16_t>(command);
}
bool is_list(const EncapsulationHeader& header) {
  return is(header, Command::kListServices) || is(header, Command::kListIdentity) ||
         is(header, Command::kListInterfaces);
}

// A message is passed over in silence if it is no request: 2-3.5 (status), 2-3.7 (options).
bool is_ignored(const EncapsulationHeader& header) { return header.status != 0 || header.options != 0; }

void patch_length(Bytes& out, std::size_t start) {
  const std::size_t length = out.size() - start - kEncapsulationHeader;
  out[start + 2] = static_cast<std::uint8_t>(length);
  out[start + 3] = static_cast<std::uint8_t>(length >> 8);
}

void append_list_services(Bytes& out) {
  append_le16(out, 1);
  append_item_header(out, ItemType::kListServicesResponse, 4 + kServiceNameLength);
  append_le16(out, kProtocolVersion);
  append_le16(out, kTcpCapability | kUdpCapability);
  out.insert(out.end(), kServiceName.begin(), kServiceName.end());
  out.insert(out.end(), kServiceNameLength - kServiceName.size(), 0);
}

void append_list_identity(Bytes& out, const ListedIdentity& identity) {
  const std::string_view name = identity.product_name.substr(0, 255);
  append_le16(out, 1);
  append_item_header(out, ItemType::kListIdentityResponse, 2 + kSockaddrLength + 14 + 1 + name.size() + 1);
  append_le16(out, kProtocolVersion);
  append_sockaddr(out, identity.address);
  append_le16(out, identity.vendor_id);
  append_le16(out, identity.device_type);
  append_le16(out, identity.product_code);
  out.push_back(identity.major_revision);
  out.push_back(identity.minor_revision);
  append_le16(out, identity.status);
  append_le32(out, identity.serial_number);
  out.push_back(static_cast<std::uint8_t>(name.size()));
  out.insert(out.end(), name.begin(), name.end());
  out.push_back(identity.state);
}

}  // namespace

EncapsulationServer::Connection* EncapsulationServer::find(TcpId connection) {
  if (connection == 0) return nullptr;
  auto& all = state_.connections;
  // A message asks for its connection several times; after it comes mostly that of the next one.
  std::size_t at = last_found_ < all.size() ? last_found_ : 0;
  for (std::size_t tries = 0; tries < all.size(); ++tries) {
    if (all[at].id == connection) return &all[last_found_ = at];
    if (++at == all.size()) at = 0;
  }
  return nullptr;
}

std::optional<Instant> EncapsulationServer::deadline_of(const Connection& c) const {
  std::optional<Instant> at = c.stream.deadline();
  const auto earlier = [&](Instant other) { at = at ? std::min(*at, other) : other; };
  if (c.session == 0) {
    earlier(c.opened_at + limits_.registration_timeout);
  } else if (limits_.inactivity_timeout != Duration{}) {
    earlier(c.last_message_at + limits_.inactivity_timeout);
  }
  return at;
}

void EncapsulationServer::wake_by(std::optional<Instant> at) {
  if (at && (!state_.deadline || *at < *state_.deadline)) state_.deadline = at;
}

std::optional<TcpId> EncapsulationServer::handle_tcp_open(Instant now, const Ipv4Endpoint& peer) {
  auto& all = state_.connections;
  auto place = std::find_if(all.begin(), all.end(), [](const Connection& c) { return c.id == 0; });
  if (place == all.end() && all.size() < limits_.tcp_connections) place = all.emplace(all.end());
  if (place == all.end()) {
    for (auto c = all.begin(); c != all.end(); ++c)
      if (c->session == 0 && (place == all.end() || c->opened_at < place->opened_at)) place = c;
    if (place == all.end()) return std::nullopt;
    close(now, *place);
  }
  if (++state_.opened == 0) ++state_.opened;
  *place = {};
  place->id = state_.opened;
  place->peer = peer;
  place->opened_at = place->last_message_at = now;
  wake_by(deadline_of(*place));
  return place->id;
}

void EncapsulationServer::handle_tcp(Instant now, TcpId connection, ByteView bytes) {
  while (Connection* c = find(connection)) {
    const auto message = c->stream.take(now, bytes);
    if (!message) {
      wake_by(c->stream.deadline());
      return;
    }
    c->last_message_at = now;
    handle_message(now, *c, *message);
  }
}

void EncapsulationServer::handle_tcp_closed(Instant now, TcpId connection) {
  Connection* c = find(connection);
  if (c == nullptr) return;
  c->id = c->session = 0;
  state_.out.drop_connection(connection);
  user_.on_tcp_closed(now, connection);
}

void EncapsulationServer::close(Instant now, Connection& connection) {
  const TcpId id = connection.id;
  // No more: a message of this connection may be under way through our caller.
  connection.id = connection.session = 0;
  state_.to_close.push_back(id);
  user_.on_tcp_closed(now, id);
}

std::optional<TcpId> EncapsulationServer::poll_close() {
  if (state_.to_close.empty()) return std::nullopt;
  const TcpId id = state_.to_close.front();
  state_.to_close.erase(state_.to_close.begin());
  return id;
}

void EncapsulationServer::close_all() {
  for (Connection& c : state_.connections) {
    if (c.id != 0) state_.to_close.push_back(c.id);
    c.id = c.session = 0;
  }
  state_.delayed.clear();
  state_.deadline.reset();
}

void EncapsulationServer::handle_message(Instant now, Connection& c, const EncapsulationMessage& message) {
  const EncapsulationHeader& header = message.header;
  if (is_ignored(header)) return;
  if (message.oversized) return answer(c, header, EncapsulationStatus::kInvalidLength);
  switch (static_cast<Command>(header.command)) {
    case Command::kNop: return;
    case Command::kListServices:
    case Command::kListIdentity:
    case Command::kListInterfaces:
      if (header.length != 0) return answer(c, header, EncapsulationStatus::kInvalidLength);
      return answer_list(Channel::kTcp, c.id, c.peer, header);
    case Command::kRegisterSession: return register_session(c, message);
    case Command::kUnRegisterSession:
      if (header.length != 0) return answer(c, header, EncapsulationStatus::kInvalidLength);
      if (c.session == 0 || header.session != c.session) return answer(c, header, EncapsulationStatus::kInvalidSession);
      return close(now, c);
    case Command::kSendRRData: {
      const auto status = send_rr_data(now, c, message);
      if (status != EncapsulationStatus::kSuccess) answer(c, header, status);
      return;
    }
    case Command::kSendUnitData: {
      const auto status = send_unit_data(now, c, message);
      if (status != EncapsulationStatus::kSuccess) answer(c, header, status);
      return;
    }
  }
  answer(c, header, EncapsulationStatus::kInvalidCommand);
}

void EncapsulationServer::register_session(Connection& c, const EncapsulationMessage& message) {
  EncapsulationHeader header = message.header;
  if (header.length != kRegisterSessionData) return answer(c, header, EncapsulationStatus::kInvalidLength);
  // 2-4.4: whatever was asked for, the answer names the version that is served, without options.
  Bytes data;
  append_le16(data, kProtocolVersion);
  append_le16(data, 0);
  auto status = EncapsulationStatus::kSuccess;
  if (read_le16(message.data, 0) != kProtocolVersion || read_le16(message.data, 2) != 0) {
    status = EncapsulationStatus::kUnsupportedRevision;
  } else if (c.session != 0) {
    status = EncapsulationStatus::kInvalidCommand;  // one session per connection; it stays
  } else if (sessions() >= limits_.sessions) {
    status = EncapsulationStatus::kInsufficientMemory;
  } else {
    // Not to be guessed from another one, and never 0. The connection's number keeps it unique.
    c.session = static_cast<std::uint32_t>(state_.random.next() << 16) | (c.id & 0xffff);
    if (c.session == 0) c.session = 0x10000;
    wake_by(deadline_of(c));
  }
  header.session = c.session;
  answer(c, header, status, data);
}

EncapsulationStatus EncapsulationServer::send_rr_data(Instant now, Connection& c, const EncapsulationMessage& message) {
  if (c.session == 0 || message.header.session != c.session) return EncapsulationStatus::kInvalidSession;
  if (message.data.size() < kSendDataPrefix) return EncapsulationStatus::kInvalidLength;
  const auto packet = parse_common_packet(message.data.subspan(kSendDataPrefix));
  if (read_le32(message.data, 0) != kCipInterface || !packet || packet->address != ItemType::kNullAddress)
    return EncapsulationStatus::kIncorrectData;
  user_.on_unconnected(now, {c.id, c.session, message.header.context}, c.peer, *packet);
  return EncapsulationStatus::kSuccess;
}

EncapsulationStatus EncapsulationServer::send_unit_data(Instant now, Connection& c,
                                                        const EncapsulationMessage& message) {
  if (c.session == 0 || message.header.session != c.session) return EncapsulationStatus::kInvalidSession;
  if (message.data.size() < kSendDataPrefix) return EncapsulationStatus::kInvalidLength;
  const auto packet = parse_common_packet(message.data.subspan(kSendDataPrefix));
  if (read_le32(message.data, 0) != kCipInterface || !packet || packet->address != ItemType::kConnectedAddress)
    return EncapsulationStatus::kIncorrectData;
  user_.on_connected(now, {c.id, c.session, message.header.context}, *packet);
  return EncapsulationStatus::kSuccess;
}

void EncapsulationServer::answer(const Connection& c, const EncapsulationHeader& request, EncapsulationStatus status,
                                 ByteView data) {
  EncapsulationHeader header = request;
  header.length = static_cast<std::uint16_t>(data.size());
  header.status = static_cast<std::uint32_t>(status);
  Bytes& out = state_.out.begin();
  append_header(out, header);
  out.insert(out.end(), data.begin(), data.end());
  state_.out.end(Channel::kTcp, c.id, c.peer);
}

void EncapsulationServer::answer_list(Channel channel, TcpId connection, const Ipv4Endpoint& to,
                                      const EncapsulationHeader& request) {
  Bytes& out = state_.out.begin();
  const std::size_t start = state_.out.start();
  append_header(out, request);
  if (is(request, Command::kListServices)) {
    append_list_services(out);
  } else if (is(request, Command::kListIdentity)) {
    append_list_identity(out, user_.listed_identity());
  } else {
    append_le16(out, 0);  // no interface but CIP
  }
  patch_length(out, start);
  state_.out.end(channel, connection, to);
}

void EncapsulationServer::handle_udp(Instant now, const Ipv4Endpoint& from, ByteView datagram, Cast cast) {
  const auto header = parse_header(datagram);
  // A datagram is one message; there is nobody to tell what is wrong with a broken one.
  if (!header || is_ignored(*header) || datagram.size() != kEncapsulationHeader + header->length) return;
  if (is(*header, Command::kNop)) return;
  if (is_list(*header) && header->length == 0) {
    if (cast == Cast::kUnicast) return answer_list(Channel::kUdp, 0, from, *header);
    if (state_.delayed.size() >= kMaxDelayedAnswers) return;
    // 2-4.2.2: so that not all devices answer at once. The longest delay is in the sender context, in ms.
    const Duration asked = std::chrono::milliseconds(read_le16(header->context, 0));
    const Duration longest = asked == Duration{} ? kDefaultMaxDelay : std::max(asked, kLeastMaxDelay);
    const auto delay =
        Duration(static_cast<std::int64_t>(state_.random.below(static_cast<std::uint64_t>(longest.count()))));
    state_.delayed.push_back({now + delay, from, header->command, header->context});
    return wake_by(now + delay);
  }
  if (cast == Cast::kBroadcast) return;
  EncapsulationHeader refusal = *header;
  refusal.length = 0;
  refusal.status = static_cast<std::uint32_t>(is_list(*header) ? EncapsulationStatus::kInvalidLength
                                                               : EncapsulationStatus::kInvalidCommand);
  append_header(state_.out.begin(), refusal);
  state_.out.end(Channel::kUdp, 0, from);
}

void EncapsulationServer::handle_timeout(Instant now) {
  if (!state_.deadline || *state_.deadline > now) return;
  state_.deadline.reset();
  for (std::size_t i = 0; i < state_.delayed.size();) {
    const DelayedAnswer answer = state_.delayed[i];
    if (answer.at > now) {
      wake_by(answer.at);
      ++i;
      continue;
    }
    state_.delayed.erase(state_.delayed.begin() + static_cast<std::ptrdiff_t>(i));
    EncapsulationHeader request;
    request.command = answer.command;
    request.context = answer.context;
    answer_list(Channel::kUdp, 0, answer.to, request);
  }
  for (Connection& c : state_.connections) {
    if (c.id == 0) continue;
    const auto at = deadline_of(c);
    if (at && *at <= now) {
      close(now, c);
    } else {
      wake_by(at);
    }
  }
}

void EncapsulationServer::send_unconnected(const ReplyTo& to, ByteView message,
                                           const std::optional<Ipv4Endpoint>& o2t_sockaddr,
                                           const std::optional<Ipv4Endpoint>& t2o_sockaddr) {
  const Connection* c = find(to.connection);
  if (c == nullptr || c->session != to.session) return;
  Bytes& out = state_.out.begin();
  const std::size_t start = state_.out.start();
  append_header(out, {static_cast<std::uint16_t>(Command::kSendRRData), 0, to.session, 0, to.context, 0});
  const auto items = static_cast<std::uint8_t>(2 + (o2t_sockaddr ? 1 : 0) + (t2o_sockaddr ? 1 : 0));
  // Interface handle and time-out; count; null address.
  const std::array<std::uint8_t, 12> prefix{0, 0, 0, 0, 0, 0, items, 0, 0, 0, 0, 0};
  out.insert(out.end(), prefix.begin(), prefix.end());
  append_item_header(out, ItemType::kUnconnectedData, message.size());
  out.insert(out.end(), message.begin(), message.end());
  if (o2t_sockaddr) {
    append_item_header(out, ItemType::kSockaddrO2t, kSockaddrLength);
    append_sockaddr(out, *o2t_sockaddr);
  }
  if (t2o_sockaddr) {
    append_item_header(out, ItemType::kSockaddrT2o, kSockaddrLength);
    append_sockaddr(out, *t2o_sockaddr);
  }
  patch_length(out, start);
  state_.out.end(Channel::kTcp, to.connection, c->peer);
}

void EncapsulationServer::send_connected(const ReplyTo& to, std::uint32_t connection_id, std::uint16_t sequence,
                                         ByteView message) {
  const Connection* c = find(to.connection);
  if (c == nullptr || c->session != to.session) return;
  Bytes& out = state_.out.begin();
  const std::size_t start = state_.out.start();
  append_header(out, {static_cast<std::uint16_t>(Command::kSendUnitData), 0, to.session, 0, to.context, 0});
  append_le32(out, kCipInterface);
  append_le16(out, 0);
  append_le16(out, 2);
  append_item_header(out, ItemType::kConnectedAddress, 4);
  append_le32(out, connection_id);
  append_item_header(out, ItemType::kConnectedData, 2 + message.size());
  append_le16(out, sequence);
  out.insert(out.end(), message.begin(), message.end());
  patch_length(out, start);
  state_.out.end(Channel::kTcp, to.connection, c->peer);
}

std::optional<Ipv4Endpoint> EncapsulationServer::peer(TcpId connection) const {
  for (const Connection& c : state_.connections)
    if (c.id == connection && connection != 0) return c.peer;
  return std::nullopt;
}

std::size_t EncapsulationServer::connections() const {
  return static_cast<std::size_t>(std::count_if(state_.connections.begin(), state_.connections.end(),
                                                [](const Connection& c) { return c.id != 0; }));
}

std::size_t EncapsulationServer::sessions() const {
  return static_cast<std::size_t>(std::count_if(state_.connections.begin(), state_.connections.end(),
                                                [](const Connection& c) { return c.session != 0; }));
}

}  // namespace vinv::ethernet_ip
