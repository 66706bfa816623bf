// Makes the Ethernet frames that a TCP connection would have put on a wire, from what its ends sent: handshake, data,
// acknowledgements, FIN. For recordings of streams whose real frames cannot be seen without privileges. Sans-I/O.
// RFC 9293 (TCP), RFC 791 (IPv4), RFC 8200 (IPv6), RFC 1071 (checksum).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sim/base/bytes.hpp"

namespace vinv::transports {

struct IpEndpoint {
  bool is_v6 = false;
  std::array<std::uint8_t, 16> address{};  // IPv4: the first four bytes
  std::uint16_t port = 0;
};

// "127.0.0.1:502", "[::1]:502", as ByteStream::name() has it.
std::optional<IpEndpoint> parse_ip_endpoint(const std::string& text);

enum class TcpSide : std::uint8_t { kClient, kServer };

class TcpConversation {
 public:
  // Called with each frame, in order.
  using Emit = std::function<void(TcpSide from, ByteView frame)>;
  // Bytes of one segment at most: an Ethernet frame of the usual size with IPv6.
  static constexpr std::size_t kMaxSegmentBytes = 1440;

  // number tells connections between the same ends apart by their initial sequence numbers. If one end is IPv6, the
  // other becomes its IPv4-mapped address. server_dscp: of what the server sends.
  TcpConversation(IpEndpoint client, IpEndpoint server, std::uint32_t number, Emit emit, std::uint8_t server_dscp = 0);

  void open();
  void data(TcpSide from, ByteView bytes);
  // All of it: both directions end. Nothing may follow.
  void close(TcpSide first);

 private:
  void segment(TcpSide from, std::uint8_t flags, ByteView payload);

  std::array<IpEndpoint, 2> ends_;
  std::array<std::uint32_t, 2> next_sequence_{};
  std::array<std::uint16_t, 2> next_ip_id_{};
  Emit emit_;
  std::array<std::uint8_t, 2> dscp_{};
  Bytes frame_;
};

}  // namespace vinv::transports
