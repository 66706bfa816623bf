#include "option_boards/ethernet_ip/connection_manager.hpp"

#include <algorithm>

namespace vinv::ethernet_ip {
namespace {

constexpr std::uint16_t kEstablished = 3;  // Vol 1, table 3-4.3
enum class LastAction : std::uint8_t { kNoOwner = 0, kOwnerIsIdle = 1, kOwnerRuns = 2 };

void append_triad(Bytes& out, const ConnectionTriad& triad) {
  append_le16(out, triad.serial);
  append_le16(out, triad.vendor_id);
  append_le32(out, triad.originator_serial);
}

std::uint32_t microseconds(Duration d) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count());
}

}  // namespace

ConnectionManager::ConnectionManager(cip::Device& device, const ConnectionOptions& options, std::uint64_t seed)
    : device_(device), options_(options), state_(seed) {
  // The upper half of identifiers: packets for connections of the last start do not fit those of this one.
  state_.incarnation = static_cast<std::uint16_t>(state_.random.next() | 1);
}

cip::Handled ConnectionManager::handle(Instant now, const cip::Request& request, cip::Reply& reply) {
  const bool here = request.path.instance == 1 && !request.path.attribute && !request.path.member;
  switch (static_cast<ConnectionService>(request.service)) {
    case ConnectionService::kForwardOpen:
    case ConnectionService::kLargeForwardOpen:
    case ConnectionService::kForwardClose:
    case ConnectionService::kGetConnectionData:
    case ConnectionService::kSearchConnectionData:
    case ConnectionService::kGetConnectionOwner: break;
    default: reply.refuse(cip::GeneralStatus::kServiceNotSupported); return cip::Handled::kAnswered;
  }
  if (!here) {
    reply.refuse(request.path.instance > 1 ? cip::GeneralStatus::kObjectDoesNotExist
                                           : cip::GeneralStatus::kServiceNotSupported);
    return cip::Handled::kAnswered;
  }
  switch (static_cast<ConnectionService>(request.service)) {
    case ConnectionService::kForwardOpen: forward_open(now, request, false, reply); break;
    case ConnectionService::kLargeForwardOpen: forward_open(now, request, true, reply); break;
    case ConnectionService::kForwardClose: forward_close(now, request, reply); break;
    case ConnectionService::kGetConnectionData: get_connection_data(request, reply); break;
    case ConnectionService::kSearchConnectionData: search_connection_data(request, reply); break;
    default: get_connection_owner(request, reply); break;
  }
  return cip::Handled::kAnswered;
}

std::size_t ConnectionManager::count(bool explicit_ones) const {
  return static_cast<std::size_t>(std::count_if(
      state_.connections.begin(), state_.connections.end(),
      [&](const Connection& c) { return c.open && (c.transport == TransportClass::kClass3) == explicit_ones; }));
}

Connection* ConnectionManager::find(const ConnectionTriad& triad) {
  for (Connection& c : state_.connections)
    if (c.open && c.triad == triad) return &c;
  return nullptr;
}

std::size_t ConnectionManager::free_slot() {
  auto& all = state_.connections;
  const auto place = std::find_if(all.begin(), all.end(), [](const Connection& c) { return !c.open; });
  if (place != all.end()) return static_cast<std::size_t>(place - all.begin());
  if (all.size() == kMaxConnections) return kNone;
  all.emplace_back();
  return all.size() - 1;
}

// Slot and generation below, so that a packet finds its connection without a search.
std::uint32_t ConnectionManager::new_identifier(std::size_t slot) {
  state_.generation = static_cast<std::uint16_t>((state_.generation + 1) & 0x1ff);
  return std::uint32_t{state_.incarnation} << 16 | static_cast<std::uint32_t>(state_.generation << 7) |
         static_cast<std::uint32_t>(slot);
}

std::size_t ConnectionManager::slot_of(const Connection& connection) const {
  return static_cast<std::size_t>(&connection - state_.connections.data());
}

Connection* ConnectionManager::find_slot(std::size_t slot, std::uint32_t o2t_id) {
  if (slot >= state_.connections.size()) return nullptr;
  Connection& c = state_.connections[slot];
  return c.open && c.o2t_id == o2t_id ? &c : nullptr;
}

Connection* ConnectionManager::find_explicit(std::uint32_t o2t_id, TcpId tcp) {
  Connection* c = find_slot(o2t_id & (kMaxConnections - 1), o2t_id);
  return c != nullptr && c->transport == TransportClass::kClass3 && c->tcp == tcp ? c : nullptr;
}

void ConnectionManager::restart(Instant now, Connection& c) {
  c.expires_at = now + c.o2t_rpi * (std::int64_t{4} << c.timeout_multiplier);
}

void ConnectionManager::wake_by(Instant at) {
  if (!state_.expiry || at < *state_.expiry) state_.expiry = at;
}

void ConnectionManager::forward_close(Instant now, const cip::Request& request, cip::Reply& reply) {
  const auto close = parse_forward_close(request.data);
  if (!close) return reply.refuse(close.error());
  Connection* c = find(close->triad);
  append_triad(reply.data, close->triad);
  if (c == nullptr) {
    reply.status = {cip::GeneralStatus::kConnectionFailure,
                    static_cast<std::uint16_t>(ConnectionStatus::kConnectionNotFound)};
    reply.data.push_back(static_cast<std::uint8_t>(close->path.size() / 2));  // words of path that are left
  } else if (exchange_ != nullptr && exchange_->originator.address != c->originator) {
    // Over which session is all the same, but not from which host (Vol 2, 3-3.10).
    reply.status = cip::GeneralStatus::kPrivilegeViolation;
    reply.data.push_back(static_cast<std::uint8_t>(close->path.size() / 2));
  } else {
    reply.data.push_back(0);  // words of application data
    end(now, *c, cip::IoEvent::kClosed);
  }
  reply.data.push_back(0);
}

// Vol 1, 3-5.5.5.
void ConnectionManager::connection_data(const Connection* c, cip::Reply& reply) const {
  if (c == nullptr) return reply.refuse(cip::GeneralStatus::kPathDestinationUnknown);
  Bytes& out = reply.data;
  const bool is_io = c->transport != TransportClass::kClass3;
  append_le16(out, static_cast<std::uint16_t>(slot_of(*c) + 1));
  append_le16(out, kEstablished);
  append_le16(out, is_io ? state_.producers[c->producer].to.port : kEncapsulationPort);
  append_le16(out, is_io ? state_.address.io_port : kEncapsulationPort);
  append_triad(out, c->triad);
  for (const bool o2t : {true, false}) {
    const std::uint32_t id = o2t ? c->o2t_id : c->t2o_id;
    append_le32(out, id);  // the originator's and the target's are the same without a router between them
    append_le32(out, id);
    out.push_back(c->timeout_multiplier);
    out.insert(out.end(), 3, 0);
    append_le32(out, microseconds(o2t ? c->o2t_rpi : c->t2o_rpi));
    append_le32(out, microseconds(o2t ? c->o2t_rpi : c->t2o_api));
  }
}

void ConnectionManager::get_connection_data(const cip::Request& request, cip::Reply& reply) {
  if (request.data.size() != 2)
    return reply.refuse(request.data.size() < 2 ? cip::GeneralStatus::kNotEnoughData
                                                : cip::GeneralStatus::kTooMuchData);
  const std::size_t number = read_le16(request.data, 0);
  const bool exists = number != 0 && number <= state_.connections.size() && state_.connections[number - 1].open;
  connection_data(exists ? &state_.connections[number - 1] : nullptr, reply);
}

void ConnectionManager::search_connection_data(const cip::Request& request, cip::Reply& reply) {
  if (request.data.size() != 8)
    return reply.refuse(request.data.size() < 8 ? cip::GeneralStatus::kNotEnoughData
                                                : cip::GeneralStatus::kTooMuchData);
  connection_data(find({read_le16(request.data, 0), read_le16(request.data, 2), read_le32(request.data, 4)}), reply);
}

// Vol 1, 3-5.5.6: reserved byte, path size in words, path of the point that is owned.
void ConnectionManager::get_connection_owner(const cip::Request& request, cip::Reply& reply) {
  const ByteView data = request.data;
  if (data.size() < 2 || data.size() < 2 + 2 * std::size_t{data[1]})
    return reply.refuse(cip::GeneralStatus::kNotEnoughData);
  if (data.size() > 2 + 2 * std::size_t{data[1]}) return reply.refuse(cip::GeneralStatus::kTooMuchData);
  const auto path = parse_connection_path(data.subspan(2));
  if (!path || path->point_count == 0) return reply.refuse(cip::GeneralStatus::kPathSegmentError);
  // The consumed point: the only one, or the last but one.
  const std::uint32_t point = path->points[path->point_count == 1 ? 0 : path->point_count - 2];
  std::uint8_t connections = 0;
  const Connection* owner = nullptr;
  for (const Connection& c : state_.connections) {
    if (!c.open || c.transport == TransportClass::kClass3 || c.consumed_point != point) continue;
    ++connections;
    if (c.role == cip::IoRole::kExclusiveOwner) owner = &c;
  }
  if (connections == 0) {
    return reply.refuse(
        {cip::GeneralStatus::kConnectionFailure, static_cast<std::uint16_t>(ConnectionStatus::kConnectionNotFound)});
  }
  const auto action = owner == nullptr                     ? LastAction::kNoOwner
                      : owner->mode == cip::RunMode::kIdle ? LastAction::kOwnerIsIdle
                                                           : LastAction::kOwnerRuns;
  const std::uint8_t owners = owner != nullptr ? 1 : 0;
  reply.data.insert(reply.data.end(), {connections, owners, owners, static_cast<std::uint8_t>(action)});
  append_triad(reply.data, owner != nullptr ? owner->triad : ConnectionTriad{});
}

void ConnectionManager::end(Instant now, Connection& c, cip::IoEvent event) {
  const Connection gone = c;
  c = {};
  if (gone.transport == TransportClass::kClass3) {
    if (explicit_closed_) explicit_closed_(slot_of(c));
    return device_.on_explicit_connection(now, event);
  }
  Producer& producer = state_.producers[gone.producer];
  if (--producer.users == 0) producer = {};
  device_.io().on_connection(now, {gone.role, gone.consumed_point, gone.produced_point}, event);
  if (gone.role != cip::IoRole::kListenOnly && gone.t2o.type == ConnectionType::kMulticast)
    end_listeners(now, gone.produced_point);
}

// Listening is possible only while somebody else keeps the production up (Vol 1, 3-6.5.3).
void ConnectionManager::end_listeners(Instant now, std::uint32_t point) {
  const auto produces = [&](const Connection& c) {
    return c.open && c.transport != TransportClass::kClass3 && c.t2o.type == ConnectionType::kMulticast &&
           c.produced_point == point;
  };
  for (const Connection& c : state_.connections)
    if (produces(c) && c.role != cip::IoRole::kListenOnly) return;
  for (Connection& c : state_.connections)
    if (produces(c)) end(now, c, cip::IoEvent::kClosed);
}

void ConnectionManager::handle_tcp_closed(Instant now, TcpId tcp) {
  for (Connection& c : state_.connections)
    if (c.open && c.transport == TransportClass::kClass3 && c.tcp == tcp) end(now, c, cip::IoEvent::kClosed);
}

void ConnectionManager::close_all() {
  for (Connection& c : state_.connections) c = {};
  for (Producer& p : state_.producers) p = {};
  state_.expiry.reset();
}

std::optional<cip::RunMode> ConnectionManager::owner_mode() const {
  for (const Connection& c : state_.connections)
    if (c.open && c.transport != TransportClass::kClass3 && c.role == cip::IoRole::kExclusiveOwner && c.synchronized)
      return c.mode;
  return std::nullopt;
}

void ConnectionManager::handle_timeout(Instant now) {
  if (!state_.expiry || *state_.expiry > now) return;
  state_.expiry.reset();
  for (Connection& c : state_.connections)
    if (c.open && c.expires_at <= now) end(now, c, cip::IoEvent::kTimedOut);
  for (const Connection& c : state_.connections)
    if (c.open) wake_by(c.expires_at);
}

void archive(Archive& a, ConnectionManager& manager) {
  ConnectionManager::State& s = manager.state_;
  a.io(s);
  a.require(s.connections.size() <= ConnectionManager::kMaxConnections, "more connections than there may be");
  for (const Connection& c : s.connections) {
    if (!c.open) continue;
    a.require(c.timeout_multiplier <= 7 && c.consumed_size <= ConnectionManager::kMaxIoData,
              "a connection is not one that can be opened");
    a.require(c.transport == TransportClass::kClass3 ||
                  (c.producer < s.producers.size() && s.producers[c.producer].users != 0),
              "a connection sends nothing");
  }
  for (const Producer& p : s.producers)
    a.require(p.users == 0 || (p.data_size <= ConnectionManager::kMaxIoData && p.api > Duration{}),
              "a production is not one that can be");
}

}  // namespace vinv::ethernet_ip
