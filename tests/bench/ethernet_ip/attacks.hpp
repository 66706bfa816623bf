// Clients that mean no good, for tests and benchmarks: each does one thing over and over.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace vinv::bench {

struct Victim {
  std::uint32_t host = 0;
  std::uint16_t port = 44818, io_port = 2222;
  std::uint8_t input_only_point = 238;  // heartbeat of input only connections with point 71
};

std::vector<std::string> attack_names();
// Until the process is ended, counting what it did. Throws for a name that is none.
void attack(const std::string& name, const Victim& victim, std::atomic<std::uint64_t>& count);

}  // namespace vinv::bench
