// Simulated seconds per wall second of the plant through a 60 s run: V/f ramp up in 5 s, rated load step at 20 s, ramp
// down in 10 s from 45 s, inputs set every 1 ms. Per solver, and for 1, 16, 64 and 256 plants in turn. The error column
// is the largest deviation from RK4 at 25 us at any tick: speed, current, link voltage, each of its rated value.
//
//   vinverter_bench --benchmark_filter=Plant
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "motor_model/plant/power_plant.hpp"
#include "tests/bench/allocation_count.hpp"

namespace vinv::plant {
namespace {

constexpr int kTicks = 60'000;
constexpr Duration kTick = std::chrono::milliseconds(1);

PlantConfig drive_2k2(double source_resistance_ohm) {
  PlantConfig config;
  config.machine = *find_machine("motulator_2k2");
  config.losses = typical_losses(config.machine);
  config.dc_link.source_resistance_ohm = source_resistance_ohm;
  config.comparators = {20, 800, 345, 380};
  config.thermal.heat_sink_k_per_w = 0.5;
  config.load.inertia_kg_m2 = 0.015;
  return config;
}

// A plant with its link charged.
PowerPlant charged(double source_resistance_ohm, const SolverSettings& solver) {
  PowerPlant plant(drive_2k2(source_resistance_ohm), solver);
  plant.advance(std::chrono::milliseconds(500));
  return plant;
}

struct Profile {
  double ramp_hz(int tick) const {
    const double t = (tick + 1) * 1e-3;
    return std::max(0.0, std::min({10 * t, 50.0, 5 * (55 - t)}));
  }
  void set(PowerPlant& plant, int tick) const {
    const double f = ramp_hz(tick);
    plant.set_stage({true, f, 16.33 + (326.6 - 16.33) * f / 50, false, 0, 0});
    if (tick == 20'000 || tick == 40'000) {
      LoadSettings load = plant.load();
      load.constant_nm = tick == 20'000 ? 14.6 : 0;
      plant.set_load(load);
    }
  }
};

struct Sample {
  float speed_rpm, current_a, link_v;
};

Sample sample(const PowerPlant& plant) {
  const auto& m = plant.measurements();
  return {static_cast<float>(m.speed_rpm), static_cast<float>(m.current_peak_a), static_cast<float>(m.dc_link_v)};
}

std::vector<Sample> record(double source_resistance_ohm, const SolverSettings& solver) {
  auto plant = charged(source_resistance_ohm, solver);
  std::vector<Sample> out;
  out.reserve(kTicks);
  for (int tick = 0; tick < kTicks; ++tick) {
    Profile{}.set(plant, tick);
    plant.advance(kTick);
    out.push_back(sample(plant));
  }
  return out;
}

double error_of_rated(double source_resistance_ohm, const SolverSettings& solver) {
  const auto reference = record(source_resistance_ohm, {SolverChoice::kRk4, 0, 25e-6});
  const auto run = record(source_resistance_ohm, solver);
  double worst = 0;
  for (int n = 0; n < kTicks; ++n) {
    worst = std::max({worst, std::abs(run[n].speed_rpm - reference[n].speed_rpm) / 1500.0,
                      std::abs(run[n].current_a - reference[n].current_a) / 7.07,
                      std::abs(run[n].link_v - reference[n].link_v) / 566.0});
  }
  return worst;
}

SolverSettings settings(SolverChoice choice) {
  SolverSettings out;
  out.choice = choice;
  return out;
}

void run_60_s(benchmark::State& bench, SolverChoice choice, double source_resistance_ohm) {
  const auto count = static_cast<std::size_t>(bench.range(0));
  std::uint64_t rhs = 0, restarts = 0, ticks = 0, allocations = 0;
  for ([[maybe_unused]] auto _ : bench) {
    bench.PauseTiming();
    std::vector<PowerPlant> plants;
    for (std::size_t n = 0; n < count; ++n) plants.push_back(charged(source_resistance_ohm, settings(choice)));
    for (const auto& plant : plants) {
      rhs -= plant.rhs_calls();
      restarts -= plant.reinitialisations();
    }
    bench.ResumeTiming();
    const auto before = test::allocation_count();
    for (int tick = 0; tick < kTicks; ++tick) {
      for (auto& plant : plants) {
        Profile{}.set(plant, tick);
        benchmark::DoNotOptimize(plant.advance(kTick).count);
      }
    }
    allocations += test::allocation_count() - before;
    ticks += count * kTicks;
    for (const auto& plant : plants) {
      rhs += plant.rhs_calls();
      restarts += plant.reinitialisations();
    }
  }
  const auto n = static_cast<double>(ticks);
  bench.counters["sim_s_per_s"] = benchmark::Counter(n * 1e-3, benchmark::Counter::kIsRate);
  bench.counters["rhs_per_tick"] = static_cast<double>(rhs) / n;
  bench.counters["restarts"] = static_cast<double>(restarts) * kTicks / n;
  bench.counters["allocs_per_tick"] = static_cast<double>(allocations) / n;
  if (count == 1) bench.counters["error"] = error_of_rated(source_resistance_ohm, settings(choice));
}

void PlantErk(benchmark::State& b) { run_60_s(b, SolverChoice::kErk, 2.0); }
void PlantRk4At250us(benchmark::State& b) { run_60_s(b, SolverChoice::kRk4, 2.0); }
void PlantCvode(benchmark::State& b) { run_60_s(b, SolverChoice::kCvodeBdf, 2.0); }
void PlantErkStiffSource(benchmark::State& b) { run_60_s(b, SolverChoice::kErk, 0.5); }
void PlantRk4StiffSource(benchmark::State& b) { run_60_s(b, SolverChoice::kRk4, 0.5); }
void PlantCvodeStiffSource(benchmark::State& b) { run_60_s(b, SolverChoice::kCvodeBdf, 0.5); }

BENCHMARK(PlantErk)->Arg(1)->Arg(16)->Arg(64)->Arg(256)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(PlantRk4At250us)->Arg(1)->Arg(16)->Arg(64)->Arg(256)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(PlantCvode)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(PlantErkStiffSource)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(PlantRk4StiffSource)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(PlantCvodeStiffSource)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);

// Inputs constant over many ticks, integrated in one go: what an owner that looks ahead may use.
void PlantLookAhead(benchmark::State& bench, SolverChoice choice) {
  auto plant = charged(2.0, settings(choice));
  for (int tick = 0; tick < 6'000; ++tick) {
    Profile{}.set(plant, tick);
    plant.advance(kTick);
  }
  const auto span = std::chrono::milliseconds(bench.range(0));
  const auto rhs = plant.rhs_calls();
  for ([[maybe_unused]] auto _ : bench) benchmark::DoNotOptimize(plant.advance(span).count);
  const double seconds = to_seconds(span) * static_cast<double>(bench.iterations());
  bench.counters["sim_s_per_s"] = benchmark::Counter(seconds, benchmark::Counter::kIsRate);
  bench.counters["rhs_per_ms"] = static_cast<double>(plant.rhs_calls() - rhs) / (seconds * 1000);
}
BENCHMARK_CAPTURE(PlantLookAhead, Erk, SolverChoice::kErk)->Arg(1)->Arg(10)->Arg(100);
BENCHMARK_CAPTURE(PlantLookAhead, Cvode, SolverChoice::kCvodeBdf)->Arg(1)->Arg(10)->Arg(100);

}  // namespace
}  // namespace vinv::plant
