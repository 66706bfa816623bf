// Forward_Open: every reason to refuse one, and what an accepted one sets up. CIP Vol 1, 3-5.5.2; Vol 2, 3-3.
#include <algorithm>

#include "option_boards/ethernet_ip/connection_manager.hpp"
#include "option_boards/ethernet_ip/multicast_address.hpp"

namespace vinv::ethernet_ip {
namespace {

constexpr std::uint16_t kAssemblyClass = 0x04;
constexpr std::size_t kSequenceCount = 2;
constexpr std::size_t kRunIdleHeader = 4;
constexpr std::size_t kLeastExplicit = 8;  // sequence count, and a reply without data but with an extended status

cip::Status refusal(ConnectionStatus why) {
  return {cip::GeneralStatus::kConnectionFailure, static_cast<std::uint16_t>(why)};
}
cip::Status refusal(ConnectionStatus why, std::size_t right) {
  return {cip::GeneralStatus::kConnectionFailure, static_cast<std::uint16_t>(why), static_cast<std::uint16_t>(right)};
}

std::optional<cip::Status> check_key(const ConnectionPath& path, const cip::Identity& identity) {
  if (!path.key) return std::nullopt;
  switch (cip::match_key(*path.key, identity)) {
    case cip::KeyMatch::kMatches: return std::nullopt;
    case cip::KeyMatch::kVendorOrProductCode: return refusal(ConnectionStatus::kVendorOrProductCodeMismatch);
    case cip::KeyMatch::kDeviceType: return refusal(ConnectionStatus::kDeviceTypeMismatch);
    case cip::KeyMatch::kRevision: return refusal(ConnectionStatus::kRevisionMismatch);
  }
  return std::nullopt;
}

std::uint32_t microseconds(Duration d) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count());
}

// How a direction's interval is judged, in 0x0112 (Vol 1, table 3-5.33).
enum class RpiJudgement : std::uint8_t { kAcceptable = 0, kLeast = 2, kMost = 3 };
struct JudgedRpi {
  RpiJudgement judgement = RpiJudgement::kAcceptable;
  Duration rpi{};  // the one asked for, or the nearest that is acceptable
};
JudgedRpi judge(Duration asked, Duration least, Duration most) {
  if (asked < least) return {RpiJudgement::kLeast, least};
  if (asked > most) return {RpiJudgement::kMost, most};
  return {RpiJudgement::kAcceptable, asked};
}

// Empty: both are acceptable. Otherwise two bytes with the judgements of O->T and T->O, then the intervals in us.
std::optional<cip::Status> refusal_of(const JudgedRpi& o2t, const JudgedRpi& t2o) {
  if (o2t.judgement == RpiJudgement::kAcceptable && t2o.judgement == RpiJudgement::kAcceptable) return std::nullopt;
  cip::Status status = refusal(ConnectionStatus::kRpiNotAcceptable);
  const auto append = [&](std::uint32_t word) {
    status.extended[status.extended_count++] = static_cast<std::uint16_t>(word);
  };
  append(static_cast<std::uint32_t>(o2t.judgement) | static_cast<std::uint32_t>(t2o.judgement) << 8);
  for (const Duration rpi : {o2t.rpi, t2o.rpi}) {
    append(microseconds(rpi) & 0xffff);
    append(microseconds(rpi) >> 16);
  }
  return status;
}

// What the answer to a refused open has (3-5.5.2): the triad and how much of the path was left.
void refuse_open(const ForwardOpen& open, const cip::Status& why, cip::Reply& reply) {
  reply.refuse(why);
  append_le16(reply.data, open.triad.serial);
  append_le16(reply.data, open.triad.vendor_id);
  append_le32(reply.data, open.triad.originator_serial);
  reply.data.push_back(0);
  reply.data.push_back(0);
}

void answer_open(const ForwardOpen& open, std::uint32_t o2t_id, std::uint32_t t2o_id, Duration t2o_api,
                 cip::Reply& reply) {
  append_le32(reply.data, o2t_id);
  append_le32(reply.data, t2o_id);
  append_le16(reply.data, open.triad.serial);
  append_le16(reply.data, open.triad.vendor_id);
  append_le32(reply.data, open.triad.originator_serial);
  append_le32(reply.data, microseconds(open.o2t_rpi));
  append_le32(reply.data, microseconds(t2o_api));
  reply.data.push_back(0);  // words of application data
  reply.data.push_back(0);
}

// Which of the formats that a direction may have gives the size asked for; if none does, right is the size to ask for:
// the usual one, with a header from the originator and without one from the target.
std::optional<RealTimeFormat> match_format(const NetworkParameters& asked, std::size_t data, bool counted, bool header,
                                           bool modeless, bool usual_is_header, std::size_t& right) {
  const std::size_t bare = data + (counted ? kSequenceCount : 0);
  const bool heartbeat = data == 0;  // nothing that could run or be idle
  right = header && !heartbeat && (usual_is_header || !modeless) ? bare + kRunIdleHeader : bare;
  const auto fits = [&](std::size_t size) { return asked.variable ? asked.size >= size : asked.size == size; };
  if (header && !heartbeat && fits(bare + kRunIdleHeader)) return RealTimeFormat::kHeader32;
  if ((modeless || heartbeat) && fits(bare)) return RealTimeFormat::kModeless;
  return std::nullopt;
}

}  // namespace

void ConnectionManager::forward_open(Instant now, const cip::Request& request, bool large, cip::Reply& reply) {
  const auto open = parse_forward_open(request.data, large);
  if (!open) return reply.refuse(open.error());
  const auto path = parse_connection_path(open->path);
  if (!path) return refuse_open(*open, refusal(path.error()), reply);
  if (const auto wrong = check_key(*path, device_.identity())) return refuse_open(*open, *wrong, reply);
  if (open->is_null()) return null_forward_open(now, *open, *path, reply);
  if (find(open->triad) != nullptr) return refuse_open(*open, refusal(ConnectionStatus::kDuplicateForwardOpen), reply);
  if (open->timeout_multiplier > 7)
    return refuse_open(*open, refusal(ConnectionStatus::kTimeoutMultiplierNotAcceptable), reply);
  // A server's trigger means nothing (Vol 1, 3-4.4.3).
  const bool explicit_one = open->transport_class() == 3;
  if (!explicit_one && open->trigger() > 2)
    return refuse_open(*open, refusal(ConnectionStatus::kTriggerNotSupported), reply);
  if (open->o2t.redundant_owner || open->t2o.redundant_owner)
    return refuse_open(*open, refusal(ConnectionStatus::kInvalidO2tRedundantOwner), reply);

  Connection c;
  c.open = true;
  c.triad = open->triad;
  c.trigger = explicit_one ? Trigger::kCyclic : static_cast<Trigger>(open->trigger());
  c.originator = exchange_ != nullptr ? exchange_->originator.address : 0;
  c.tcp = exchange_ != nullptr ? exchange_->tcp : 0;
  c.t2o_id = open->t2o_id;
  c.o2t = open->o2t;
  c.t2o = open->t2o;
  c.o2t_rpi = open->o2t_rpi;
  c.t2o_rpi = open->t2o_rpi;
  c.timeout_multiplier = open->timeout_multiplier;
  Refusal refused;
  switch (open->transport_class()) {
    case 0:
    case 1:
      c.transport = static_cast<TransportClass>(open->transport_class());
      refused = open_io(now, *open, *path, c);
      break;
    case 3:
      c.transport = TransportClass::kClass3;
      refused = open_explicit(now, *open, *path, c);
      break;
    default: refused = refusal(ConnectionStatus::kTransportClassNotSupported);
  }
  if (refused) return refuse_open(*open, *refused, reply);
  accept(now, *open, std::move(c), reply);
}

// A null open neither makes nor ends a connection (Vol 1, 3-5.5.2.3): it asks whether the device and the points are
// there, and brings configuration data.
void ConnectionManager::null_forward_open(Instant now, const ForwardOpen& open, const ConnectionPath& path,
                                          cip::Reply& reply) {
  const Connection* same = find(open.triad);
  Connection wanted;
  const bool has_configuration_point = path.point_count == 1 || path.point_count == 3;
  if (path.point_count != 0 && path.class_id != kAssemblyClass)
    return refuse_open(open, refusal(ConnectionStatus::kInvalidApplicationPath), reply);
  if (path.point_count >= 2) {
    const cip::IoPoints& io = device_.io();
    if (!io.consumed_size(path.points[path.point_count - 2]))
      return refuse_open(open, refusal(ConnectionStatus::kInvalidConsumingPath), reply);
    if (!io.produced_size(path.points[path.point_count - 1]))
      return refuse_open(open, refusal(ConnectionStatus::kInvalidProducingPath), reply);
  }
  if (has_configuration_point) {
    wanted.triad = open.triad;
    wanted.configuration_point = path.points[0];
    if (const auto refused = check_configuration(path, wanted)) return refuse_open(open, *refused, reply);
    if (!path.configuration.empty()) {
      const cip::Status done = device_.io().configure(now, wanted.configuration_point, path.configuration);
      if (!done.ok()) return refuse_open(open, done, reply);
    }
  } else if (!path.configuration.empty()) {
    return refuse_open(open, refusal(ConnectionStatus::kInvalidConfigurationPath), reply);
  }
  if (same != nullptr) return answer_open(open, same->o2t_id, same->t2o_id, same->t2o_api, reply);
  answer_open(open, open.o2t_id, open.t2o_id, open.t2o_rpi, reply);
}

ConnectionManager::Refusal ConnectionManager::open_explicit(Instant /*now*/, const ForwardOpen& open,
                                                            const ConnectionPath& path, Connection& c) {
  if (!open.is_server()) return refusal(ConnectionStatus::kDirectionNotSupported);
  if (open.o2t.type != ConnectionType::kPointToPoint) return refusal(ConnectionStatus::kInvalidO2tType);
  if (open.t2o.type != ConnectionType::kPointToPoint) return refusal(ConnectionStatus::kInvalidT2oType);
  if (path.class_id != kMessageRouterClass || path.point_count != 1 || path.points[0] != 1 ||
      !path.configuration.empty())
    return refusal(ConnectionStatus::kInvalidApplicationPath);
  if (open.o2t_rpi == Duration{} || open.t2o_rpi == Duration{}) return refusal(ConnectionStatus::kRpiNotSupported);
  const std::size_t largest = options_.largest_explicit;
  for (const std::uint16_t size : {open.o2t.size, open.t2o.size})
    if (size < kLeastExplicit || size > largest) return refusal(ConnectionStatus::kInvalidConnectionSize, largest);
  if (explicit_connections() >= options_.explicit_connections) return refusal(ConnectionStatus::kOutOfConnections);
  c.t2o_api = open.t2o_rpi;
  return std::nullopt;
}

ConnectionManager::Refusal ConnectionManager::check_points(const ForwardOpen& /*open*/, const ConnectionPath& path,
                                                           Connection& c) const {
  const cip::IoPoints& io = device_.io();
  if (path.class_id != kAssemblyClass) return refusal(ConnectionStatus::kInvalidApplicationPath);
  if (path.point_count < 2) return refusal(ConnectionStatus::kInvalidSegment);
  const bool configured = path.point_count == 3;
  c.configuration_point = configured ? path.points[0] : 0;
  c.consumed_point = path.points[path.point_count - 2];
  c.produced_point = path.points[path.point_count - 1];
  if (io.is_heartbeat(c.consumed_point, cip::IoRole::kInputOnly)) {
    c.role = cip::IoRole::kInputOnly;
  } else if (io.is_heartbeat(c.consumed_point, cip::IoRole::kListenOnly)) {
    c.role = cip::IoRole::kListenOnly;
  } else {
    c.role = cip::IoRole::kExclusiveOwner;
  }
  if (!configured && !path.configuration.empty()) return refusal(ConnectionStatus::kInvalidConfigurationPath);
  if (configured)
    if (const auto refused = check_configuration(path, c)) return refused;
  if (!io.consumed_size(c.consumed_point)) return refusal(ConnectionStatus::kInvalidConsumingPath);
  if (!io.produced_size(c.produced_point)) return refusal(ConnectionStatus::kInvalidProducingPath);
  if (!io.goes_with(c.consumed_point, c.produced_point)) return refusal(ConnectionStatus::kInconsistentPaths);
  return std::nullopt;
}

ConnectionManager::Refusal ConnectionManager::check_configuration(const ConnectionPath& path,
                                                                  const Connection& c) const {
  const auto size = device_.io().configuration_size(c.configuration_point);
  if (!size) return refusal(ConnectionStatus::kInvalidConfigurationPath);
  if (path.configuration.empty()) return std::nullopt;
  const std::size_t words = (*size + 1) / 2;
  if (path.configuration.size() != 2 * words) return refusal(ConnectionStatus::kInvalidConfigurationSize, words);
  // One configuration for all that use the point.
  for (const Connection& other : state_.connections) {
    if (other.open && other.triad != c.triad && other.configuration_point == c.configuration_point &&
        !other.configuration.empty() &&
        !std::equal(other.configuration.begin(), other.configuration.end(), path.configuration.begin(),
                    path.configuration.end()))
      return refusal(ConnectionStatus::kOwnershipConflict);
  }
  return std::nullopt;
}

ConnectionManager::Refusal ConnectionManager::check_owner(const Connection& c) const {
  if (c.role == cip::IoRole::kExclusiveOwner) {
    std::size_t owners = 0;
    for (const Connection& other : state_.connections) {
      if (!other.open || other.transport == TransportClass::kClass3 || other.role != c.role) continue;
      if (other.consumed_point == c.consumed_point || ++owners >= options_.exclusive_owners)
        return refusal(ConnectionStatus::kOwnershipConflict);
    }
  }
  if (c.role == cip::IoRole::kListenOnly) {
    const bool somebody = std::any_of(state_.connections.begin(), state_.connections.end(), [&](const Connection& o) {
      return o.open && o.transport != TransportClass::kClass3 && o.role != cip::IoRole::kListenOnly &&
             o.t2o.type == ConnectionType::kMulticast && o.produced_point == c.produced_point;
    });
    if (!somebody) return refusal(ConnectionStatus::kNoOwnerToListenTo);
    if (c.t2o.type != ConnectionType::kMulticast) return refusal(ConnectionStatus::kInvalidT2oType);
  }
  return std::nullopt;
}

ConnectionManager::Refusal ConnectionManager::check_sizes(const ForwardOpen& open, Connection& c,
                                                          RealTimeFormat& t2o_format) const {
  const bool counted = c.transport == TransportClass::kClass1;
  const std::size_t consumed = device_.io().consumed_size(c.consumed_point).value_or(0);
  const std::size_t produced = device_.io().produced_size(c.produced_point).value_or(0);
  std::size_t right = 0;
  const auto o2t = match_format(open.o2t, consumed, counted, options_.o2t_header, options_.o2t_modeless, true, right);
  if (!o2t || consumed > kMaxIoData) return refusal(ConnectionStatus::kInvalidO2tSize, right);
  const auto t2o = match_format(open.t2o, produced, counted, options_.t2o_header, options_.t2o_modeless, false, right);
  if (!t2o || produced > kMaxIoData) return refusal(ConnectionStatus::kInvalidT2oSize, right);
  c.consumed_size = consumed;
  c.o2t_format = *o2t;
  // With both formats possible in a variable size, a device's own data has no header.
  t2o_format = *t2o;
  if (open.t2o.variable && options_.t2o_modeless) t2o_format = RealTimeFormat::kModeless;
  return std::nullopt;
}

ConnectionManager::Refusal ConnectionManager::check_join(const Producer& shared, const Producer& wanted,
                                                         Duration o2t_rpi) const {
  if (shared.transport != wanted.transport) return refusal(ConnectionStatus::kMismatchedTransportClass);
  if (shared.trigger != wanted.trigger) return refusal(ConnectionStatus::kMismatchedT2oTrigger);
  if (shared.parameters.size != wanted.parameters.size || shared.format != wanted.format)
    return refusal(ConnectionStatus::kMismatchedT2oSize);
  if (shared.parameters.variable != wanted.parameters.variable)
    return refusal(ConnectionStatus::kMismatchedT2oFixedVariable);
  if (shared.parameters.priority != wanted.parameters.priority)
    return refusal(ConnectionStatus::kMismatchedT2oPriority);
  if (shared.inhibit_time != wanted.inhibit_time && shared.trigger != Trigger::kCyclic)
    return refusal(ConnectionStatus::kMismatchedT2oInhibitTime);
  // It gets what is produced already; not more often.
  return refusal_of({RpiJudgement::kAcceptable, o2t_rpi}, judge(wanted.api, shared.api, options_.longest_rpi));
}

ConnectionManager::Refusal ConnectionManager::open_io(Instant now, const ForwardOpen& open, const ConnectionPath& path,
                                                      Connection& c) {
  if (open.o2t.type != ConnectionType::kPointToPoint) return refusal(ConnectionStatus::kInvalidO2tType);
  if (open.t2o.type != ConnectionType::kPointToPoint && open.t2o.type != ConnectionType::kMulticast)
    return refusal(ConnectionStatus::kInvalidT2oType);
  if (const auto refused = check_points(open, path, c)) return refused;
  RealTimeFormat t2o_format{};
  if (const auto refused = check_sizes(open, c, t2o_format)) return refused;
  const auto judged = [&](Duration rpi) { return judge(rpi, options_.shortest_rpi, options_.longest_rpi); };
  if (const auto refused = refusal_of(judged(open.o2t_rpi), judged(open.t2o_rpi))) return refused;
  if (path.inhibit_time && *path.inhibit_time > open.t2o_rpi) return refusal(ConnectionStatus::kRpiBelowInhibitTime);
  if (const auto refused = check_owner(c)) return refused;

  Producer wanted;
  wanted.users = 1;
  wanted.point = c.produced_point;
  wanted.data_size = device_.io().produced_size(c.produced_point).value_or(0);
  wanted.parameters = open.t2o;
  wanted.format = t2o_format;
  wanted.transport = c.transport;
  wanted.trigger = c.trigger;
  wanted.api = open.t2o_rpi;
  // Unspecified: without a segment a quarter of the interval, as other stacks have it.
  wanted.inhibit_time = path.inhibit_time.value_or(open.t2o_rpi / 4);
  wanted.multicast = open.t2o.type == ConnectionType::kMulticast;
  const std::size_t shared = wanted.multicast ? find_multicast(c.produced_point) : kNone;
  if (shared != kNone)
    if (const auto refused = check_join(state_.producers[shared], wanted, open.o2t_rpi)) return refused;
  if (io_connections() >= options_.io_connections) return refusal(ConnectionStatus::kOutOfConnections);
  if (wanted.multicast && shared == kNone && free_group() == kMulticastGroups)
    return refusal(ConnectionStatus::kTargetOutOfConnections);

  if (!path.configuration.empty()) {
    const cip::Status done = device_.io().configure(now, c.configuration_point, path.configuration);
    if (!done.ok()) return done;
    c.configuration.assign(path.configuration.begin(), path.configuration.end());
  }

  // Nothing can fail any more.
  if (shared != kNone) {
    ++state_.producers[shared].users;
    c.producer = shared;
    c.t2o_id = state_.producers[shared].connection_id;
  } else {
    if (wanted.multicast) {
      const std::uint32_t mask =
          state_.address.netmask != 0 ? state_.address.netmask : mask_by_class(state_.address.address);
      wanted.to = {first_multicast_address(state_.address.address, mask) + free_group(), kIoPort};
    } else {
      // Deviation: the address in the item is not looked at, so that nobody can have packets sent to a third party.
      const auto& asked = exchange_ != nullptr ? exchange_->t2o_asked : std::nullopt;
      wanted.to = {c.originator, asked && asked->port != 0 ? asked->port : kIoPort};
    }
    wanted.connection_id = open.t2o_id;
    wanted.next_at = now;  // with the answer
    wanted.version = device_.io().produced_version(c.produced_point);
    wanted.fresh = wanted.trigger != Trigger::kCyclic;
    c.producer = new_producer();
    state_.producers[c.producer] = wanted;
  }
  c.t2o_api = state_.producers[c.producer].api;
  return std::nullopt;
}

std::size_t ConnectionManager::find_multicast(std::uint32_t point) const {
  for (std::size_t i = 0; i < state_.producers.size(); ++i) {
    const Producer& p = state_.producers[i];
    if (p.users != 0 && p.multicast && p.point == point) return i;
  }
  return kNone;
}

std::size_t ConnectionManager::new_producer() {
  const auto free =
      std::find_if(state_.producers.begin(), state_.producers.end(), [](const Producer& p) { return p.users == 0; });
  if (free != state_.producers.end()) return static_cast<std::size_t>(free - state_.producers.begin());
  state_.producers.emplace_back();
  return state_.producers.size() - 1;
}

std::uint32_t ConnectionManager::free_group() const {
  std::uint32_t used = 0;
  for (const Producer& p : state_.producers)
    if (p.users != 0 && p.multicast) used |= 1u << (p.to.address % kMulticastGroups);
  std::uint32_t group = 0;
  while (group < kMulticastGroups && (used >> group & 1) != 0) ++group;
  return group;
}

void ConnectionManager::accept(Instant now, const ForwardOpen& open, Connection&& connection, cip::Reply& reply) {
  const std::size_t slot = free_slot();
  const bool is_io = connection.transport != TransportClass::kClass3;
  if (slot == kNone) {
    if (is_io && --state_.producers[connection.producer].users == 0) state_.producers[connection.producer] = {};
    return refuse_open(open, refusal(ConnectionStatus::kOutOfConnections), reply);
  }
  Connection& c = state_.connections[slot];
  c = std::move(connection);
  c.o2t_id = new_identifier(slot);
  if (is_io) {
    Producer& producer = state_.producers[c.producer];
    if (producer.multicast) {
      // The producer names a multicast; the first consumer's identifier serves as well as any.
      if (producer.users == 1) producer.connection_id = c.o2t_id ^ 0x80000000u;
      c.t2o_id = producer.connection_id;
    }
    if (exchange_ != nullptr) {
      if (state_.address.io_port != kIoPort) exchange_->o2t_answer = Ipv4Endpoint{0, state_.address.io_port};
      if (producer.multicast) exchange_->t2o_answer = producer.to;
    }
  }
  const Duration timeout = c.o2t_rpi * (std::int64_t{4} << c.timeout_multiplier);
  c.expires_at = now + std::max<Duration>(timeout, kLeastFirstTimeout);
  wake_by(c.expires_at);
  answer_open(open, c.o2t_id, c.t2o_id, c.t2o_api, reply);
  if (!is_io) return device_.on_explicit_connection(now, cip::IoEvent::kOpened);
  device_.io().on_connection(now, {c.role, c.consumed_point, c.produced_point}, cip::IoEvent::kOpened);
}

}  // namespace vinv::ethernet_ip
