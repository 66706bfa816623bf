#include "sim/transports/tcp_conversation.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace vinv::transports {
namespace {

constexpr std::uint8_t kFin = 0x01;
constexpr std::uint8_t kSyn = 0x02;
constexpr std::uint8_t kPsh = 0x08;
constexpr std::uint8_t kAck = 0x10;
constexpr std::uint8_t kProtocolTcp = 6;
constexpr std::uint16_t kWindow = 65535;
constexpr std::uint8_t kTimeToLive = 64;
constexpr std::size_t kTcpHeaderBytes = 20;

std::uint32_t sum16(ByteView bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += read_be16(bytes, i);
  if (bytes.size() % 2 != 0) sum += static_cast<std::uint32_t>(bytes.back()) << 8;
  return sum;
}

std::uint16_t checksum(std::uint32_t sum) {
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

void put_be16(Bytes& bytes, std::size_t at, std::uint16_t value) {
  bytes[at] = static_cast<std::uint8_t>(value >> 8);
  bytes[at + 1] = static_cast<std::uint8_t>(value);
}

void append_address(Bytes& out, const IpEndpoint& end) {
  out.insert(out.end(), end.address.begin(), end.address.begin() + (end.is_v6 ? 16 : 4));
}

void map_to_v6(IpEndpoint& end) {
  if (end.is_v6) return;
  std::array<std::uint8_t, 16> mapped{};
  mapped[10] = mapped[11] = 0xff;
  std::copy_n(end.address.begin(), 4, mapped.begin() + 12);
  end.address = mapped;
  end.is_v6 = true;
}

// Locally administered addresses that say which end it is.
void append_mac(Bytes& out, TcpSide side) {
  const std::uint8_t last = side == TcpSide::kClient ? 1 : 2;
  for (const std::uint8_t b :
       {std::uint8_t{0x02}, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}, last}) {
    out.push_back(b);
  }
}

constexpr std::size_t index(TcpSide side) { return static_cast<std::size_t>(side); }
constexpr TcpSide other(TcpSide side) { return side == TcpSide::kClient ? TcpSide::kServer : TcpSide::kClient; }

}  // namespace

std::optional<IpEndpoint> parse_ip_endpoint(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  std::string host = text.substr(0, colon);
  IpEndpoint end;
  const char* const last = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, last, end.port);
  if (error != std::errc() || stop != last) return std::nullopt;
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
    host = host.substr(0, host.find('%'));  // the zone of a link-local address is not on the wire
    end.is_v6 = true;
  }
  if (::inet_pton(end.is_v6 ? AF_INET6 : AF_INET, host.c_str(), end.address.data()) != 1) return std::nullopt;
  return end;
}

TcpConversation::TcpConversation(IpEndpoint client, IpEndpoint server, std::uint32_t number, Emit emit,
                                 std::uint8_t server_dscp)
    : ends_{client, server}, emit_(std::move(emit)), dscp_{0, server_dscp} {
  if (client.is_v6 || server.is_v6) {
    for (IpEndpoint& end : ends_) map_to_v6(end);
  }
  next_sequence_ = {0x10000000u + number * 0x10001u, 0x80000000u + number * 0x10001u};
}

void TcpConversation::open() {
  segment(TcpSide::kClient, kSyn, {});
  segment(TcpSide::kServer, kSyn | kAck, {});
  segment(TcpSide::kClient, kAck, {});
}

void TcpConversation::data(TcpSide from, ByteView bytes) {
  if (bytes.empty()) return;
  while (!bytes.empty()) {
    const std::size_t size = std::min(bytes.size(), kMaxSegmentBytes);
    segment(from, size == bytes.size() ? kPsh | kAck : kAck, bytes.first(size));
    bytes = bytes.subspan(size);
  }
  segment(other(from), kAck, {});
}

void TcpConversation::close(TcpSide first) {
  segment(first, kFin | kAck, {});
  segment(other(first), kFin | kAck, {});
  segment(first, kAck, {});
}

void TcpConversation::segment(TcpSide from, std::uint8_t flags, ByteView payload) {
  const IpEndpoint& source = ends_[index(from)];
  const IpEndpoint& target = ends_[index(other(from))];
  const std::size_t tcp_bytes = kTcpHeaderBytes + payload.size();
  Bytes& f = frame_;
  f.clear();
  append_mac(f, other(from));
  append_mac(f, from);
  append_be16(f, source.is_v6 ? 0x86dd : 0x0800);

  const std::size_t ip_at = f.size();
  if (source.is_v6) {
    append_be32(f, 0x60000000u | static_cast<std::uint32_t>(dscp_[index(from)]) << 22);
    append_be16(f, static_cast<std::uint16_t>(tcp_bytes));
    f.push_back(kProtocolTcp);
    f.push_back(kTimeToLive);
  } else {
    append_be16(f, static_cast<std::uint16_t>(0x4500 | dscp_[index(from)] << 2));
    append_be16(f, static_cast<std::uint16_t>(20 + tcp_bytes));
    append_be16(f, next_ip_id_[index(from)]++);
    append_be16(f, 0x4000);  // do not fragment
    f.push_back(kTimeToLive);
    f.push_back(kProtocolTcp);
    append_be16(f, 0);  // checksum, below
  }
  append_address(f, source);
  append_address(f, target);
  if (!source.is_v6) put_be16(f, ip_at + 10, checksum(sum16(ByteView(f).subspan(ip_at), 0)));

  const std::size_t tcp_at = f.size();
  append_be16(f, source.port);
  append_be16(f, target.port);
  append_be32(f, next_sequence_[index(from)]);
  append_be32(f, (flags & kAck) != 0 ? next_sequence_[index(other(from))] : 0);
  f.push_back(kTcpHeaderBytes / 4 << 4);
  f.push_back(flags);
  append_be16(f, kWindow);
  append_be16(f, 0);  // checksum, below
  append_be16(f, 0);
  f.insert(f.end(), payload.begin(), payload.end());
  // Pseudo header: both addresses, protocol, length.
  const std::size_t addresses_at = source.is_v6 ? ip_at + 8 : ip_at + 12;
  std::uint32_t sum = kProtocolTcp + static_cast<std::uint32_t>(tcp_bytes);
  sum = sum16(ByteView(f).subspan(addresses_at, tcp_at - addresses_at), sum);
  put_be16(f, tcp_at + 16, checksum(sum16(ByteView(f).subspan(tcp_at), sum)));

  // SYN and FIN take a place in the sequence.
  next_sequence_[index(from)] += static_cast<std::uint32_t>(payload.size()) + ((flags & (kSyn | kFin)) != 0 ? 1 : 0);
  emit_(from, f);
}

}  // namespace vinv::transports
