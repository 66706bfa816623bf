#include "sim/transports/udp_frame.hpp"

#include <algorithm>

namespace vinv::transports {
namespace {

constexpr std::uint8_t kProtocolUdp = 17;
constexpr std::size_t kEthernetBytes = 14;
constexpr std::size_t kIpBytes = 20;
constexpr std::size_t kUdpBytes = 8;

std::uint32_t sum16(ByteView bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += read_be16(bytes, i);
  if (bytes.size() % 2 != 0) sum += static_cast<std::uint32_t>(bytes.back()) << 8;
  return sum;
}

void put_checksum(Bytes& out, std::size_t at, std::uint32_t sum) {
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  const auto value = static_cast<std::uint16_t>(~sum);
  out[at] = static_cast<std::uint8_t>(value >> 8);
  out[at + 1] = static_cast<std::uint8_t>(value);
}

// Unicast: a locally administered address made of the IP address.
void append_mac(Bytes& out, std::uint32_t address) {
  if (address == 0xffffffff) {
    out.insert(out.end(), 6, 0xff);
  } else if (is_multicast(address)) {
    append_be16(out, 0x0100);
    append_be32(out, 0x5e000000 | (address & 0x7fffff));
  } else {
    append_be16(out, 0x0200);
    append_be32(out, address);
  }
}

}  // namespace

void make_udp_frame(Bytes& out, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView payload,
                    const UdpFrameOptions& options) {
  const std::size_t udp_length = kUdpBytes + payload.size();
  out.clear();
  append_mac(out, to.address);
  append_mac(out, from.address);
  append_be16(out, 0x0800);
  append_be16(out, static_cast<std::uint16_t>(0x4500 | options.dscp << 2));
  append_be16(out, static_cast<std::uint16_t>(kIpBytes + udp_length));
  append_be16(out, options.ip_id);
  append_be16(out, 0x4000);  // do not fragment
  append_be16(out, static_cast<std::uint16_t>((is_multicast(to.address) ? 1 : 64) << 8 | kProtocolUdp));
  append_be16(out, 0);  // checksum, below
  append_be32(out, from.address);
  append_be32(out, to.address);
  put_checksum(out, kEthernetBytes + 10, sum16(ByteView(out).subspan(kEthernetBytes), 0));
  append_be16(out, from.port);
  append_be16(out, to.port);
  append_be16(out, static_cast<std::uint16_t>(udp_length));
  append_be16(out, 0);
  out.insert(out.end(), payload.begin(), payload.end());
  // Over both addresses, protocol, length, and the datagram.
  const std::uint32_t pseudo = kProtocolUdp + static_cast<std::uint32_t>(udp_length);
  put_checksum(out, kEthernetBytes + kIpBytes + 6, sum16(ByteView(out).subspan(kEthernetBytes + 12), pseudo));
}

}  // namespace vinv::transports
