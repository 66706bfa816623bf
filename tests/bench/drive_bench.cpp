// Simulated seconds per wall second of whole FR-E500 drives, control tick included, through a 60 s run: ramp up in 5 s,
// rated load step at 20 s, off at 40 s, ramp down in 10 s from 45 s. For 1, 16, 64 and 256 drives ticked in turn, and
// the same with the plant on fixed-step RK4 at 250 us.
//
//   vinverter_bench --benchmark_filter=Drive
//
// And what a fork costs: saving a running drive, and a new drive that loads it.
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "sim/base/check.hpp"
#include "tests/bench/allocation_count.hpp"

namespace vinv::inverter {
namespace {

constexpr int kTicks = 60'000;

class Drive {
 public:
  explicit Drive(plant::SolverChoice solver) {
    config_.model = "FR-E540-2.2K";
    config_.motor = *plant::find_machine("motulator_2k2");
    config_.load.inertia_kg_m2 = 0.015;
    config_.solver.choice = solver;
    auto made = make_inverter("fr-e500", config_);
    VINV_CHECK(made.has_value());
    inverter_ = std::move(*made);
    VINV_CHECK(inverter_->preset_parameter("Pr.8", 10).has_value());
    inverter_->set_power(true);
    for (int tick = 0; tick < 1000; ++tick) step();
    VINV_CHECK(inverter_->press_key(PanelKey::kPuExt).has_value());
    VINV_CHECK(inverter_->set_panel_frequency(50).has_value());
  }

  void step(int tick) {
    switch (tick) {
      case 0: VINV_CHECK(inverter_->press_key(PanelKey::kFwd).has_value()); break;
      case 20'000: set_torque(14.6); break;
      case 40'000: set_torque(0); break;
      case 45'000: VINV_CHECK(inverter_->press_key(PanelKey::kStopReset).has_value()); break;
      default: break;
    }
    step();
  }

  const Inverter& inverter() const { return *inverter_; }
  Inverter& inverter() { return *inverter_; }
  const InverterConfig& config() const { return config_; }

 private:
  void step() {
    inverter_->tick(now_);
    now_ += Inverter::kControlPeriod;
  }
  void set_torque(double nm) {
    plant::LoadSettings load = inverter_->plant().load();
    load.constant_nm = nm;
    inverter_->set_load(load);
  }

  Instant now_{};
  InverterConfig config_;
  std::unique_ptr<Inverter> inverter_;
};

void run_60_s(benchmark::State& bench, plant::SolverChoice solver) {
  const auto count = static_cast<std::size_t>(bench.range(0));
  std::uint64_t rhs = 0, ticks = 0, allocations = 0, trips = 0;
  for (auto _ : bench) {
    bench.PauseTiming();
    std::vector<Drive> drives;
    drives.reserve(count);
    for (std::size_t n = 0; n < count; ++n) drives.emplace_back(solver);
    for (const Drive& drive : drives) rhs -= drive.inverter().plant().rhs_calls();
    bench.ResumeTiming();
    const auto before = test::allocation_count();
    for (int tick = 0; tick < kTicks; ++tick) {
      for (Drive& drive : drives) drive.step(tick);
    }
    allocations += test::allocation_count() - before;
    ticks += count * kTicks;
    for (const Drive& drive : drives) {
      rhs += drive.inverter().plant().rhs_calls();
      trips += drive.inverter().alarm_name().empty() ? 0 : 1;
    }
  }
  const auto n = static_cast<double>(ticks);
  bench.counters["sim_s_per_s"] = benchmark::Counter(n * 1e-3, benchmark::Counter::kIsRate);
  bench.counters["rhs_per_tick"] = static_cast<double>(rhs) / n;
  bench.counters["allocs_per_tick"] = static_cast<double>(allocations) / n;
  bench.counters["tripped"] = static_cast<double>(trips);
}

void DriveErk(benchmark::State& b) { run_60_s(b, plant::SolverChoice::kErk); }
void DriveRk4At250us(benchmark::State& b) { run_60_s(b, plant::SolverChoice::kRk4); }

BENCHMARK(DriveErk)->Arg(1)->Arg(16)->Arg(64)->Arg(256)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(DriveRk4At250us)->Arg(1)->Arg(16)->Iterations(1)->Unit(benchmark::kMillisecond);

void DriveSave(benchmark::State& bench) {
  Drive drive(plant::SolverChoice::kErk);
  for (int tick = 0; tick < 5000; ++tick) drive.step(tick);
  Bytes bytes;
  for (auto _ : bench) save_snapshot(drive.inverter(), bytes);
  bench.counters["bytes"] = static_cast<double>(bytes.size());
}

void DriveFork(benchmark::State& bench) {
  Drive drive(plant::SolverChoice::kErk);
  for (int tick = 0; tick < 5000; ++tick) drive.step(tick);
  const Bytes bytes = save_snapshot(drive.inverter());
  for (auto _ : bench) {
    auto fork = make_inverter("fr-e500", drive.config());
    VINV_CHECK(fork && (*fork)->load(bytes));
  }
}

BENCHMARK(DriveSave);
BENCHMARK(DriveFork);

}  // namespace
}  // namespace vinv::inverter
