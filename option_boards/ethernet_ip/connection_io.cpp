// I/O packets in and out. CIP Vol 2, 3-4.1 (packet), 3-4.2 (order); Vol 1, 3-4.4 (triggers), 3-6.1 (real-time formats).
#include <algorithm>
#include <span>

#include "option_boards/ethernet_ip/connection_manager.hpp"

namespace vinv::ethernet_ip {
namespace {

constexpr std::uint32_t kRunBit = 1;

// Writes little-endian words into memory that is there.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> out) : out_(out) {}
  void word(std::uint32_t value) {
    out_[at_++] = static_cast<std::uint8_t>(value);
    out_[at_++] = static_cast<std::uint8_t>(value >> 8);
  }
  void item(ItemType type, std::size_t length) {
    word(static_cast<std::uint16_t>(type));
    word(static_cast<std::uint32_t>(length));
  }
  void double_word(std::uint32_t value) {
    word(value & 0xffff);
    word(value >> 16);
  }
  std::span<std::uint8_t> next(std::size_t size) {
    at_ += size;
    return out_.subspan(at_ - size, size);
  }
  std::size_t size() const { return at_; }

 private:
  std::span<std::uint8_t> out_;
  std::size_t at_ = 0;
};

bool is_later(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) > 0; }
bool is_later(std::uint16_t a, std::uint16_t b) { return static_cast<std::int16_t>(a - b) > 0; }

}  // namespace

void ConnectionManager::handle_io(Instant now, const Ipv4Endpoint& from, ByteView datagram) {
  const auto packet = parse_common_packet(datagram);
  if (!packet || packet->address == ItemType::kNullAddress) return;
  Connection* c = find_slot(packet->connection_id & (kMaxConnections - 1), packet->connection_id);
  if (c == nullptr || c->transport == TransportClass::kClass3 || c->originator != from.address) return;
  ByteView data = packet->data;
  const std::size_t empty = c->transport == TransportClass::kClass1 ? 2 : 0;
  if (data.size() > c->o2t.size || (!c->o2t.variable && data.size() != c->o2t.size && data.size() != empty)) return;
  const bool first = !c->synchronized;
  if (c->transport == TransportClass::kClass1) {
    if (packet->address != ItemType::kSequencedAddress || data.size() < 2) return;
    // A packet that was overtaken on its way is not news in any sense (Vol 2, 3-4.2).
    if (!first && !is_later(packet->sequence, c->last_sequence)) return;
    c->last_sequence = packet->sequence;
    const std::uint16_t count = read_le16(data, 0);
    data = data.subspan(2);
    const bool is_news = first || is_later(count, c->last_count);
    if (is_news) c->last_count = count;
    c->synchronized = true;
    restart(now, *c);
    if (first) wake_by(c->expires_at);
    // The same data once more: keeps the connection up.
    if (!is_news) return;
  } else {
    c->synchronized = true;
    restart(now, *c);
    if (first) wake_by(c->expires_at);
  }
  consume(now, *c, data);
}

void ConnectionManager::consume(Instant now, Connection& c, ByteView data) {
  if (c.role != cip::IoRole::kExclusiveOwner) return;
  if (device_.io().consumed_size(c.consumed_point) != c.consumed_size) return;  // not served any more
  cip::RunMode mode = cip::RunMode::kRun;
  if (c.o2t_format == RealTimeFormat::kHeader32) {
    if (data.size() < 4) return;
    mode = (read_le32(data, 0) & kRunBit) != 0 ? cip::RunMode::kRun : cip::RunMode::kIdle;
    data = data.subspan(4);
  } else if (data.empty() && c.consumed_size != 0) {
    // Modeless: nothing in the packet means idle, and what stands for its data is not acted on.
    c.mode = cip::RunMode::kIdle;
    static constexpr std::array<std::uint8_t, kMaxIoData> kNothing{};
    device_.io().consume(now, c.consumed_point, ByteView(kNothing).first(c.consumed_size), c.mode);
    return;
  }
  if (data.size() != c.consumed_size) return;
  c.mode = mode;
  device_.io().consume(now, c.consumed_point, data, mode);
}

void ConnectionManager::handle_new_data(Instant /*now*/) {
  for (Producer& p : state_.producers) {
    if (p.users == 0 || p.trigger != Trigger::kChangeOfState) continue;
    const std::uint32_t version = device_.io().produced_version(p.point);
    if (version == p.version) continue;
    p.version = version;
    p.fresh = true;
  }
}

void ConnectionManager::trigger(Instant /*now*/, std::uint32_t point) {
  for (Producer& p : state_.producers)
    if (p.users != 0 && p.trigger == Trigger::kApplication && p.point == point) p.fresh = true;
}

std::optional<Instant> ConnectionManager::next_deadline() const {
  std::optional<Instant> next = state_.expiry;
  for (const Producer& p : state_.producers) {
    if (p.users == 0) continue;
    const Instant at = p.fresh ? std::min(p.next_at, p.inhibited_until) : p.next_at;
    if (!next || at < *next) next = at;
  }
  return next;
}

bool ConnectionManager::is_due(const Producer& p, Instant now) const {
  return p.users != 0 && (p.next_at <= now || (p.fresh && p.inhibited_until <= now));
}

std::optional<Transmit> ConnectionManager::poll_transmit(Instant now) {
  for (Producer& p : state_.producers)
    if (is_due(p, now)) return emit(now, p);
  return std::nullopt;
}

Transmit ConnectionManager::emit(Instant now, Producer& p) {
  if (p.trigger == Trigger::kCyclic) {
    p.next_at += p.api;
    if (now - p.next_at > p.api * kMaxLateIntervals) p.next_at = now + p.api;
    ++p.count;
  } else {
    p.next_at = now + p.api;
    p.inhibited_until = now + p.inhibit_time;
    // What is sent only because the interval is over has the old count: no news (Vol 1, 3-4.4.3).
    if (p.fresh) ++p.count;
    p.fresh = false;
  }
  const bool counted = p.transport == TransportClass::kClass1;
  const bool header = p.format == RealTimeFormat::kHeader32;
  Writer out(packet_);
  out.word(2);
  if (counted) {
    out.item(ItemType::kSequencedAddress, 8);
    out.double_word(p.connection_id);
    out.double_word(++p.sequence);
  } else {
    out.item(ItemType::kConnectedAddress, 4);
    out.double_word(p.connection_id);
  }
  out.item(ItemType::kConnectedData, (counted ? 2 : 0) + (header ? 4 : 0) + p.data_size);
  if (counted) out.word(p.count);
  if (header) out.double_word(kRunBit);
  if (p.data_size != 0) {
    const auto data = out.next(p.data_size);
    if (device_.io().produced_size(p.point) == p.data_size) {
      device_.io().produce(now, p.point, data);
    } else {
      std::fill(data.begin(), data.end(), std::uint8_t{0});  // a point that the device does not serve any more
    }
  }
  return {Channel::kIo, 0, p.to, options_.dscp[static_cast<std::size_t>(p.parameters.priority)],
          ByteView(packet_).first(out.size())};
}

}  // namespace vinv::ethernet_ip
