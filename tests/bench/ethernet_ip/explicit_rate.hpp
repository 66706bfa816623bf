// Round trips of Get_Attribute_Single per second, one request under way on each connection, against an echo of as many
// bytes that does nothing but epoll_wait, read and write. Client, server and echo share one core, since several
// measure how long a processor takes to wake up; server and echo take turns, so that what else the machine does hits
// both.
#pragma once

#include <cstdint>
#include <vector>

namespace vinv::bench {

struct ExplicitOptions {
  std::uint32_t own = 0x7f000001, host = 0x7f000002;
  std::uint16_t port = 44818;
  int pid = 0;  // of the server, if it is on this machine
  int cpu = 0;  // less than 0: not pinned
  std::vector<unsigned> connections = {1, 16, 64};
  unsigned rounds = 9;
  double round_s = 0.4;
  std::uint16_t class_id = 1, instance = 1;
  std::uint8_t attribute = 1;
};

struct ExplicitResult {
  unsigned connections = 0;
  double server_per_s = 0, echo_per_s = 0;  // medians of the rounds
  double ratio = 0, best_ratio = 0;         // of a round and the echo's beside it: median, best
  double cpu_us_per_trip = 0;               // of the server; 0 if the process is not known
};

// Throws a sentence if the server is not there or refuses the attribute.
std::vector<ExplicitResult> measure_explicit(const ExplicitOptions& options);

}  // namespace vinv::bench
