#include "sim/scenario/virtual_run.hpp"

#include <functional>
#include <utility>

#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

rig::PlantOptions plant_options(const rig::Catalogue& catalogue, std::uint64_t seed) {
  rig::PlantOptions options;
  options.catalogue = catalogue;
  options.seed = seed;
  return options;
}

// Plant and run, with all that waits on their scheduler.
struct Whole {
  rig::Plant& plant;
  Runner& runner;
  friend void archive(Archive& a, Whole& whole) {
    a.io(whole.plant);
    a.io(whole.runner);
    whole.plant.scheduler().archive_waiting(a);
  }
};

RunResult guarded(const Scenario& scenario, const RunOptions& options, const std::function<RunResult()>& run) {
  try {
    return run();
  } catch (const std::exception& e) {
    RunResult failed = not_run(scenario, options);
    failed.reason = e.what();
    return failed;
  }
}

}  // namespace

VirtualRun::VirtualRun(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options)
    : clock_(scheduler_),
      plant_(scenario.plant, scheduler_, plant_options(catalogue, options.seed.value_or(scenario.seed))),
      runner_(scenario, plant_, options),
      // The runner ends at the limit by itself; a second more is only for the window after a trip.
      longest_(scenario.limit + options.recording.after + std::chrono::seconds(1)) {
  runner_.set_on_finished([this] { clock_.stop(); });
  plant_.start();
  runner_.start();
}

void VirtualRun::run_until(Duration at) {
  const Instant until = runner_.state().start + at;
  if (finished() || until < scheduler_.now()) return;
  try {
    clock_.run_until(until);
  } catch (const plant::SolverFailure& e) {
    runner_.abort("the integration of the equations failed at " + show_time(scheduler_.now()) + ": " +
                  rig::sentence(e.what()));
  }
}

RunResult VirtualRun::finish() {
  run_until(longest_);
  return runner_.take_result();
}

std::string VirtualRun::objection() const {
  std::string why = runner_.snapshot_objection();
  return why.empty() ? plant_.snapshot_objection() : why;
}

Result<void, std::string> VirtualRun::save(Bytes& out) {
  if (std::string why = objection(); !why.empty()) return Unexpected(std::move(why));
  Whole whole{plant_, runner_};
  save_snapshot(whole, out);
  return {};
}

Result<void, std::string> VirtualRun::load(ByteView snapshot) {
  if (std::string why = objection(); !why.empty()) return Unexpected(std::move(why));
  Whole whole{plant_, runner_};
  return load_snapshot(whole, snapshot);
}

RunResult run_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options) {
  return guarded(scenario, options, [&] { return VirtualRun(scenario, catalogue, options).finish(); });
}

RunResult resume_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                         ByteView snapshot) {
  return guarded(scenario, options, [&] {
    VirtualRun run(scenario, catalogue, options);
    if (const auto loaded = run.load(snapshot); !loaded) throw std::runtime_error(rig::sentence(loaded.error()));
    return run.finish();
  });
}

}  // namespace vinv::scenario
