#include "tests/bench/ethernet_ip/flood.hpp"

#include <sys/mman.h>

#include <atomic>
#include <stdexcept>

#include "tests/bench/ethernet_ip/measure.hpp"

namespace vinv::bench {
namespace {

// What a child counts for its parent.
class SharedCount {
 public:
  SharedCount() {
    void* const page = ::mmap(nullptr, sizeof *count_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) throw std::runtime_error("no shared memory");
    count_ = new (page) std::atomic<std::uint64_t>(0);
  }
  ~SharedCount() { ::munmap(count_, sizeof *count_); }
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;
  std::atomic<std::uint64_t>& value() { return *count_; }

 private:
  std::atomic<std::uint64_t>* count_ = nullptr;
};

IntervalStatistics middle(const std::vector<IntervalStatistics>& rounds) {
  IntervalStatistics all;
  std::vector<double> p50, p99, p999;
  for (const auto& r : rounds) {
    p50.push_back(r.p50_us);
    p99.push_back(r.p99_us);
    p999.push_back(r.p999_us);
    all.got_share += r.got_share / static_cast<double>(rounds.size());
  }
  all.p50_us = median(p50);
  all.p99_us = median(p99);
  all.p999_us = median(p999);
  return all;
}

FloodResult measure(const FloodOptions& o, const std::string& kind) {
  FloodResult result;
  result.kind = kind;
  IoOptions io = o.io;
  io.host = o.io.host + 1;
  Neighbour neighbour(io, o.rpi_us);
  std::vector<IntervalStatistics> quiet, during;
  const std::int64_t before = resident_bytes(io.pid);
  SharedCount attacks;
  double seconds = 0;
  for (unsigned round = 0; round < o.rounds; ++round) {
    quiet.push_back(neighbour.run(o.round_s));
    const std::int64_t start = monotonic_ns();
    const Child attacker([&] { attack(kind, {o.io.host, o.io.port, o.io.io_port}, attacks.value()); });
    during.push_back(neighbour.run(o.round_s));
    seconds += static_cast<double>(monotonic_ns() - start) / 1e9;
  }
  result.quiet = middle(quiet);
  result.during = middle(during);
  if (result.during.got_share == 0) throw std::runtime_error(kind + ": the neighbour's connection is gone");
  result.attacks_per_s = static_cast<double>(attacks.value().load()) / seconds;
  if (io.pid != 0) result.memory_growth_bytes = resident_bytes(io.pid) - before;
  return result;
}

}  // namespace

std::vector<FloodResult> measure_flood(const FloodOptions& options) {
  std::vector<FloodResult> results;
  for (const std::string& kind : options.kinds) results.push_back(measure(options, kind));
  return results;
}

}  // namespace vinv::bench
