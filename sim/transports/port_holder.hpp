// Who has a port of this machine: what /proc/net/tcp, udp and their version 6 say (proc(5)).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vinv::transports {

enum class PortKind : std::uint8_t { kTcp, kUdp };

struct PortHolder {
  std::string address;  // "127.0.0.2", "0.0.0.0", "[::]"
  std::string program;  // "opener, process 312"; empty: of somebody else, who is not shown
};

// Sockets that leave no room for this address and port: TCP listeners and bound UDP sockets on it or on every address.
// Empty: nobody, or it cannot be read.
std::vector<PortHolder> holders_of(PortKind kind, std::uint32_t address, std::uint16_t port);

}  // namespace vinv::transports
