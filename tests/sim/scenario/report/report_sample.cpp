// Writes the reports of the made-up runs into a folder, for the test of the page's own scripts and for a look at them.
// Usage: report_sample FOLDER [FRAMES]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "sim/scenario/report/report_folder.hpp"
#include "tests/sim/scenario/report/sample_run.hpp"

int main(int argc, char** argv) {
  using namespace vinv;
  using namespace vinv::scenario;
  if (argc < 2) return 2;
  try {
    ReportFolder writer(argv[1], "vinverter 0.1.0 (sample)");
    RunResult small = small_run();
    small.recording.wire = sample_wire();
    writer.write(nullptr, small);
    RunResult run = long_run(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1000);
    run.path = "scenarios/fr-e500/long.yaml";
    run.title = "Ramps up, runs with load, and trips when it stops too fast";
    const auto begin = std::chrono::steady_clock::now();
    writer.write(nullptr, run);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    RunResult passed = small;
    passed.path = "scenarios/fr-e500/start.yaml";
    passed.title = "Starts and gets to its speed";
    passed.verdict = Verdict::kPassed;
    passed.checks.pop_back();
    passed.events.pop_back();
    writer.write(nullptr, passed);
    RunResult broken;
    broken.path = "scenarios/fr-e500/broken.yaml";
    broken.name = "broken";
    broken.reason = "scenarios/fr-e500/broken.yaml:3:5: unknown word runn; did you mean run?";
    writer.write(nullptr, broken);
    writer.finish();
    std::printf("the long run took %.0f ms to write\n", took.count());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
