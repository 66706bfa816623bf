// Time to make the files of a run of 60 s with every millisecond recorded, without the disk; the argument is the number
// of CAN frames.
//
//   vinverter_bench --benchmark_filter=Report
#include <benchmark/benchmark.h>

#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_report.hpp"
#include "sim/scenario/report/wire_report.hpp"
#include "tests/sim/scenario/report/sample_run.hpp"

namespace vinv::scenario {
namespace {

void BM_ReportHtml(benchmark::State& state) {
  const RunResult run = long_run(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(html_report(nullptr, run, "", {}));
}
void BM_ReportCsv(benchmark::State& state) {
  const RunResult run = long_run(0);
  for (auto _ : state) benchmark::DoNotOptimize(signals_csv(run.recording));
}
void BM_ReportWire(benchmark::State& state) {
  const RunResult run = long_run(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(candump_log(run.recording));
    benchmark::DoNotOptimize(wire_pcapng(run.recording));
  }
}

BENCHMARK(BM_ReportHtml)->Arg(6000)->Arg(100'000)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_ReportCsv)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_ReportWire)->Arg(6000)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vinv::scenario
