// The wires of a plant file, as words say them: host:port, a CAN bus and its bit rate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim/base/result.hpp"

namespace vinv::rig {

// In a plant file, 1-based; line 0: the file as a whole.
struct Position {
  int line = 0;
  int column = 0;
};

struct SerialNetwork {
  std::string name;    // a network's name, or the drive's for a line of its own
  std::string device;  // "pty" or "/dev/tty..."
  Position at;
};

struct TcpNetwork {
  std::string host = "127.0.0.1";  // an address, never a name
  std::uint16_t port = 1502;       // 0: any free port
  Position at;
};

struct CanNetwork {
  // kVirtual is a bus of this process; every other kind joins a bus that is elsewhere.
  enum class Kind : std::uint8_t { kVirtual, kSocketcan, kSocketcand, kSlcanTcp, kSlcanTty, kUdpMulticast };

  std::string name;
  Kind kind = Kind::kVirtual;
  std::string device;               // interface, tty, multicast group (empty: the default one), or a server's bus
  TcpNetwork remote;                // of kSocketcand and kSlcanTcp
  std::uint32_t bitrate = 125'000;  // bit/s

  // Ways for masters onto the bus. Several networks with one socketcand address are one server.
  std::optional<TcpNetwork> socketcand;
  std::optional<TcpNetwork> slcan;
  bool slcan_pty = false;
  std::string channel;  // as a socketcand client opens it
  Position at;
};

inline constexpr std::uint16_t kDefaultSocketcandPort = 29536;
inline constexpr std::string_view kDefaultCanName = "can0";

// "127.0.0.1:1502", "[::1]:0", "localhost:1502": an address and a port; empty otherwise.
std::optional<TcpNetwork> parse_host_port(std::string_view text);
std::string host_port(const std::string& host, std::uint16_t port);  // with brackets around an IPv6 address

// "virtual", "socketcan:vcan0", "socketcand:127.0.0.1:29536/can0", "slcan:127.0.0.1:3333", "slcan:/dev/ttyACM0",
// "udp_multicast", "udp_multicast:GROUP". Only kind, device and remote are set. Empty otherwise.
std::optional<CanNetwork> parse_can_way(std::string_view text);
// What parse_can_way takes, for messages.
inline constexpr std::string_view kCanWays =
    "virtual, socketcan:INTERFACE, socketcand:ADDRESS:PORT/CHANNEL, slcan:ADDRESS:PORT, slcan:/dev/ttyACM0, "
    "udp_multicast, udp_multicast:GROUP";
// As a file has it: "socketcan:vcan0".
std::string text_of(const CanNetwork& network);

// "125k", "1M" or "125000", for the bit rates of CAN buses; empty otherwise.
std::optional<std::uint32_t> parse_can_bitrate(std::string_view text);
inline constexpr std::string_view kCanBitrateWords = "20k, 50k, 62.5k, 100k, 125k, 250k, 500k, 1M";

}  // namespace vinv::rig
