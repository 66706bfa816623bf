#include "sim/scenario/virtual_run.hpp"

#include <functional>
#include <stdexcept>
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
    whole.runner.archive_masters(a);
    a.io(whole.plant);
    a.io(whole.runner);
    whole.plant.streams().archive_owners(a);
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

Result<Duration, std::string> VirtualRun::run_to_grid(Duration at) {
  constexpr Duration kTick = inverter::Inverter::kControlPeriod;
  constexpr Duration kLongestGrid = std::chrono::seconds(10);
  const Duration first = (at + kTick - Duration{1}) / kTick * kTick;
  for (Duration next = first; next <= first + kLongestGrid; next += kTick) {
    run_until(next);
    if (finished() || plant_.snapshot_objection().empty()) break;
  }
  if (std::string why = objection(); !why.empty()) return Unexpected(std::move(why));
  return scheduler_.now() - runner_.state().start;
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

RunResult run_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                      const SnapshotOptions& snapshots) {
  return guarded(scenario, options, [&] {
    VirtualRun run(scenario, catalogue, options);
    if (!snapshots.resume.empty())
      if (const auto loaded = run.load(snapshots.resume); !loaded)
        throw std::runtime_error(rig::sentence(loaded.error()));
    if (snapshots.at) {
      const auto at = run.run_to_grid(*snapshots.at);
      Bytes saved;
      const auto ok = at ? run.save(saved) : Result<void, std::string>(Unexpected(at.error()));
      if (!ok) throw std::runtime_error("there is no snapshot: " + rig::sentence(ok.error()));
      if (snapshots.on_saved) snapshots.on_saved(*at, saved);
    }
    return run.finish();
  });
}

RunResult run_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options) {
  return run_virtual(scenario, catalogue, options, SnapshotOptions{});
}

RunResult resume_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                         ByteView snapshot) {
  SnapshotOptions snapshots;
  snapshots.resume = snapshot;
  return run_virtual(scenario, catalogue, options, snapshots);
}

}  // namespace vinv::scenario
