// How much a neighbour's I/O suffers while another adapter of the same process is flooded: intervals with and without
// the flood, in turns.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/ethernet_ip/attacks.hpp"
#include "tests/bench/ethernet_ip/io_intervals.hpp"

namespace vinv::bench {

struct FloodOptions {
  IoOptions io;  // host is attacked, host + 1 is the neighbour
  std::vector<std::string> kinds = attack_names();
  unsigned rpi_us = 2000;
  unsigned rounds = 3;
  double round_s = 1.5;
};

struct FloodResult {
  std::string kind;
  IntervalStatistics quiet, during;  // medians of the rounds
  double attacks_per_s = 0;
  std::int64_t memory_growth_bytes = 0;  // of the server, after all rounds; 0 if the process is not known
};

// Throws a sentence if the neighbour's connection does not open, or does not stay.
std::vector<FloodResult> measure_flood(const FloodOptions& options);

}  // namespace vinv::bench
