// Virtual seconds per second of whole scenarios, layer by layer in one run:
//
//   plant    drives and boards on the scheduler, told what to do at the same times, nothing looked at
//   run      the scenario on it: a master on the CAN bus, a watch, every signal, state and frame recorded
//   reports  and the files of the run: page, tables, wire logs, without the disk
//
// run_cost and report_cost are what a layer takes in addition, as a share of the plant's time. And the shipped line of
// eight drives with its reports.
//
//   vinverter_bench --benchmark_filter=Scenario
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>

#include "sim/base/check.hpp"
#include "sim/kernel/virtual_clock.hpp"
#include "sim/rig/commands.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_report.hpp"
#include "sim/scenario/report/wire_report.hpp"
#include "sim/scenario/virtual_run.hpp"
#include "sim/scenario/scenario_file.hpp"

namespace vinv::scenario {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

LoadOptions load_options() {
  LoadOptions options;
  options.catalogue = rig::shipped_catalogue();
  options.masters = protocol_masters();
  return options;
}

RunOptions run_options() {
  RunOptions options;
  options.masters = protocol_masters();
  return options;
}

// 60 s: ramps up and down, load steps, direction changes; each drive's master asks it ten times a second.
std::string story(int drives) {
  std::string plant, tracks;
  for (int n = 1; n <= drives; ++n) {
    const std::string name = "d" + std::to_string(n);
    plant += "    - { name: " + name + ", inverter: { model: FR-E540-2.2K }, load: { inertia_kg_m2: 0.015, " +
             "torque: { constant_Nm: 3 } }, board: { node: " + std::to_string(n) + ", network: bus } }\n";
    const auto say = [&](const std::string& at, const std::string& words) {
      tracks += "    - { drive: " + name + ", at: " + at + " s, " + words + " }\n";
    };
    tracks += "  hand_" + name + ":\n";
    say("1", "reference: 50 Hz");
    say("1.2", "run: forward");
    say("10", "load: { torque: 12 Nm }");
    say("20", "load: { torque: 3 Nm }");
    say("25", "stop: ");
    say("32", "run: reverse");
    say("45", "load: { torque: 12 Nm }");
    say("50", "stop: ");
    say("60", "note: end");
    tracks += "  watch_" + name + ":\n    - { drive: " + name + ", never: { dc_link: above 900 V }, during: 60 s }\n";
    tracks += "  master_" + name + ":\n    - { drive: " + name + ", at: 2 s, note: begin }\n    - repeat:\n" +
              "        times: 500\n        steps: [ { drive: " + name +
              ", after: 100 ms, via: canopen, monitor: output_frequency } ]\n";
  }
  return "# A benchmark.\nplant:\n  networks: { bus: { can: virtual, bitrate: 1M } }\n  drives:\n" + plant +
         "limit: 70 s\ntracks:\n" + tracks;
}

double plant_seconds(const Scenario& scenario) {
  const auto begin = Clock::now();
  kernel::Scheduler scheduler;
  rig::PlantOptions options;
  options.catalogue = rig::shipped_catalogue();
  rig::Plant plant(scenario.plant, scheduler, std::move(options));
  for (const Track& track : scenario.tracks)
    for (const Step& step : track.steps) {
      const auto* action = std::get_if<Action>(&step.what);
      if (action == nullptr || !step.via.empty() || !step.pace.at) continue;
      scheduler.schedule(scheduler.now() + *step.pace.at, kernel::Priority::kStimulus, [&, action](Instant) {
        VINV_CHECK(
            rig::execute(plant, action->command, scenario.plant.drives[step.drive].name, action->value).has_value());
      });
    }
  plant.start();
  kernel::VirtualClock(scheduler).run_until(scheduler.now() + std::chrono::seconds(60));
  return seconds_since(begin);
}

std::size_t report_bytes(const Scenario& scenario, const RunResult& result) {
  return signals_csv(result.recording).size() + states_csv(result.recording).size() + events_csv(result).size() +
         candump_log(result.recording).size() + wire_pcapng(result.recording).size() +
         html_report(&scenario, result, "", {}).size();
}

void ScenarioLayers(benchmark::State& bench) {
  const Scenario scenario = parse_scenario(story(static_cast<int>(bench.range(0))), "bench.yaml", load_options());
  double plant_s = 0, run_s = 0, reports_s = 0, virtual_s = 0;
  std::size_t frames = 0, bytes = 0;
  for ([[maybe_unused]] auto _ : bench) {
    plant_s += plant_seconds(scenario);
    auto begin = Clock::now();
    const RunResult result = run_virtual(scenario, rig::shipped_catalogue(), run_options());
    run_s += seconds_since(begin);
    VINV_CHECK(result.verdict == Verdict::kPassed);
    begin = Clock::now();
    bytes = report_bytes(scenario, result);
    reports_s += seconds_since(begin);
    virtual_s += to_seconds(result.end.time_since_epoch());
    frames = result.recording.wire.size();
  }
  bench.counters["plant_s_per_s"] = virtual_s / plant_s;
  bench.counters["run_s_per_s"] = virtual_s / run_s;
  bench.counters["all_s_per_s"] = virtual_s / (run_s + reports_s);
  bench.counters["run_cost"] = run_s / plant_s - 1;
  bench.counters["report_cost"] = reports_s / plant_s;
  bench.counters["frames"] = static_cast<double>(frames);
  bench.counters["report_bytes"] = static_cast<double>(bytes);
}

void ScenarioConveyorLine(benchmark::State& bench) {
  const Scenario scenario = load_scenario(VINV_SOURCE_DIR "/scenarios/lines/conveyor_line.yaml", load_options());
  double virtual_s = 0;
  for ([[maybe_unused]] auto _ : bench) {
    const RunResult result = run_virtual(scenario, rig::shipped_catalogue(), run_options());
    VINV_CHECK(result.verdict == Verdict::kPassed);
    benchmark::DoNotOptimize(report_bytes(scenario, result));
    virtual_s += to_seconds(result.end.time_since_epoch());
  }
  bench.counters["s_per_s"] = benchmark::Counter(virtual_s, benchmark::Counter::kIsRate);
}

BENCHMARK(ScenarioLayers)->Arg(1)->Arg(8)->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(ScenarioConveyorLine)->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vinv::scenario
