// Campaign cases per second: the shipped campaign in as many processes as the argument says, results on disk.
//
//   vinverter_bench --benchmark_filter=Campaign
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "sim/campaign/campaign_file.hpp"
#include "sim/campaign/campaign_run.hpp"

namespace vinv::campaign {
namespace {

void BM_CampaignCases(benchmark::State& state) {
  CampaignRunOptions options;
  options.load.catalogue = rig::shipped_catalogue();
  options.jobs = static_cast<std::size_t>(state.range(0));
  options.folder = (std::filesystem::temp_directory_path() / ("vinv-bench-" + std::to_string(::getpid()))).string();
  const Campaign campaign = load_campaign(VINV_SOURCE_DIR "/scenarios/campaigns/deceleration_ov3.yaml", options.load);
  double virtual_s = 0;
  options.on_result = [&](std::uint64_t, std::uint64_t, const CaseResult& r) {
    virtual_s += static_cast<double>(r.end_ns) * 1e-9;
  };
  for (auto _ : state) {
    std::filesystem::remove_all(options.folder);
    run_campaign(campaign, options);
  }
  std::filesystem::remove_all(options.folder);
  const auto cases = static_cast<double>(state.iterations()) * static_cast<double>(campaign.cases());
  state.counters["cases/s"] = benchmark::Counter(cases, benchmark::Counter::kIsRate);
  state.counters["virtual s/s"] = benchmark::Counter(virtual_s, benchmark::Counter::kIsRate);
}
// The text and the digest of a case, without running it.
void BM_CampaignText(benchmark::State& state) {
  scenario::LoadOptions load;
  load.catalogue = rig::shipped_catalogue();
  const Campaign campaign = load_campaign(VINV_SOURCE_DIR "/scenarios/campaigns/deceleration_ov3.yaml", load);
  std::uint64_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(campaign.scenario_text(k % campaign.cases() + 1));
    benchmark::DoNotOptimize(campaign.digest(k++ % campaign.cases() + 1));
  }
}

BENCHMARK(BM_CampaignCases)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);
BENCHMARK(BM_CampaignText)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace vinv::campaign
