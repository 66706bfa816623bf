// The CAN bus in virtual time: frames per second of a saturated bus with 2, 16 and 99 nodes, of a bus without timing,
// and SDO round trips of a drive with nothing between master and board but the bus.
//
//   vinverter_bench --benchmark_filter=Can
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "tests/bench/allocation_count.hpp"
#include "tests/bench/can_drive.hpp"

namespace vinv::transports {
namespace {

using Timing = CanBusOptions::Timing;

void count(benchmark::State& bench, std::uint64_t frames, std::uint64_t allocations) {
  const auto n = static_cast<double>(frames);
  bench.counters["frames_per_s"] = benchmark::Counter(n, benchmark::Counter::kIsRate);
  bench.counters["allocs_per_frame"] = static_cast<double>(allocations) / std::max(n, 1.0);
}

// Each node has always one frame to send; all hear all.
void CanSaturatedBus(benchmark::State& bench) {
  kernel::Scheduler scheduler;
  CanBusOptions options;
  options.bitrate = 1'000'000;
  CanBus bus(scheduler, options);
  std::vector<std::unique_ptr<CanNode>> nodes;
  for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(bench.range(0)); ++n) {
    CanNodeOptions node_options;
    node_options.name = "node";
    nodes.push_back(bus.attach({}, node_options));
    CanNode* const node = nodes.back().get();
    CanHandlers handlers;
    handlers.on_frame = [](Instant, const CanFrame& frame) { benchmark::DoNotOptimize(frame.id); };
    handlers.on_sent = [node](Instant now, const CanFrame& frame) { node->send(now, frame); };
    node->set_handlers(std::move(handlers));
    node->send({}, CanFrame::standard(0x180 + n, {1, 2, 3, 4, 5, 6, 7, 8}));
  }
  scheduler.run_until(scheduler.now() + std::chrono::milliseconds(100));
  const auto frames = bus.stats(scheduler.now()).frames;
  const auto allocations = test::allocation_count();
  for ([[maybe_unused]] auto _ : bench) scheduler.run_until(scheduler.now() + std::chrono::milliseconds(10));
  const auto allocated = test::allocation_count() - allocations;
  count(bench, bus.stats(scheduler.now()).frames - frames, allocated);
  bench.counters["sim_s_per_s"] =
      benchmark::Counter(0.01 * static_cast<double>(bench.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(CanSaturatedBus)->Arg(2)->Arg(16)->Arg(99);

// Two nodes, a frame there and one back, in one instant or with the time of their bits.
void CanPingPong(benchmark::State& bench, Timing timing) {
  kernel::Scheduler scheduler;
  CanBusOptions options;
  options.timing = timing;
  CanBus bus(scheduler, options);
  const auto ping = bus.attach({}, {});
  const auto pong = bus.attach({}, {});
  std::uint64_t heard = 0;
  pong->set_handlers({[&](Instant now, const CanFrame& frame) { pong->send(now, frame); }, {}, {}});
  ping->set_handlers({[&](Instant, const CanFrame&) { ++heard; }, {}, {}});
  const CanFrame frame = CanFrame::standard(0x605, {0x40, 0, 0x10, 0, 0, 0, 0, 0});
  const auto allocations = test::allocation_count();
  const std::uint64_t before = heard;
  for ([[maybe_unused]] auto _ : bench) {
    ping->send(scheduler.now(), frame);
    scheduler.run_until(scheduler.now() + (timing == Timing::kNone ? Duration{} : std::chrono::milliseconds(5)));
  }
  const auto allocated = test::allocation_count() - allocations;
  VINV_CHECK(heard - before == static_cast<std::uint64_t>(bench.iterations()));
  count(bench, 2 * (heard - before), allocated);
}
BENCHMARK_CAPTURE(CanPingPong, Timed, Timing::kExact);
BENCHMARK_CAPTURE(CanPingPong, Untimed, Timing::kNone);

// Upload of 1000H from the board of a whole drive; the drive does not tick meanwhile.
void CanSdoInProcess(benchmark::State& bench) {
  kernel::Scheduler scheduler;
  CanBusOptions options;
  options.timing = Timing::kNone;
  CanBus bus(scheduler, options);
  const test::CanDrives drives(scheduler, bus, 1);
  const auto master = bus.attach({}, {});
  std::uint64_t answers = 0;
  master->set_handlers({[&](Instant, const CanFrame& frame) { answers += frame.id == 0x581 ? 1 : 0; }, {}, {}});
  scheduler.run_until(instant_from_ns(2'000'000'500));  // started, and between two ticks
  const CanFrame request = CanFrame::standard(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0});
  const auto allocations = test::allocation_count();
  for ([[maybe_unused]] auto _ : bench) {
    master->send(scheduler.now(), request);
    scheduler.run_until(scheduler.now());
  }
  const auto allocated = test::allocation_count() - allocations;
  VINV_CHECK(answers == static_cast<std::uint64_t>(bench.iterations()));
  bench.counters["trips_per_s"] = benchmark::Counter(static_cast<double>(answers), benchmark::Counter::kIsRate);
  bench.counters["allocs_per_trip"] = static_cast<double>(allocated) / static_cast<double>(answers);
}
BENCHMARK(CanSdoInProcess);

}  // namespace
}  // namespace vinv::transports
