// Intervals of I/O packets: how far they are from the requested packet interval, and how many of the packets that were
// asked for came; against a process that sends as many packets of the same size at absolute deadlines and does nothing
// else. Both take turns in one run. The kernel's time stamps of arrival count, so that the measuring process may be
// late itself.
#pragma once

#include <cstdint>
#include <vector>

namespace vinv::bench {

struct IoOptions {
  std::uint32_t own = 0x7f000001, host = 0x7f000002;  // UDP 2222 of own must be free
  std::uint16_t port = 44818, io_port = 2222;
  int pid = 0;                           // of the server, if it is on this machine
  std::vector<unsigned> adapters = {1};  // at host, host + 1 ...
  std::vector<unsigned> rpi_us = {1000, 2000, 10'000};
  unsigned rounds = 3;
  double round_s = 2;
  // Connection path: configuration, consumed and produced point of class 4, and the bytes of the latter two.
  std::vector<unsigned> points = {21, 71};
  unsigned consumed_bytes = 4, produced_bytes = 4;
};

struct IntervalStatistics {
  double p50_us = 0, p99_us = 0, p999_us = 0;  // of |interval - requested interval|, median of the rounds
  double got_share = 0;                        // packets that came, of those asked for; over all rounds
};

struct IoResult {
  unsigned adapters = 0, rpi_us = 0;
  IntervalStatistics server, sender;
  double cpu_share_per_drive = 0;  // of one core; 0 if the process is not known
};

// Throws a sentence if a connection is refused.
std::vector<IoResult> measure_io(const IoOptions& options);

// The packets of one connection that stays open while something else is measured.
class Neighbour {
 public:
  Neighbour(const IoOptions& options, unsigned rpi_us);
  ~Neighbour();
  Neighbour(const Neighbour&) = delete;
  Neighbour& operator=(const Neighbour&) = delete;
  IntervalStatistics run(double seconds);

 private:
  struct Impl;
  Impl* impl_;
};

}  // namespace vinv::bench
