// A run of a scenario in virtual time, from a plant of its own: to its end, or to an instant from which it is saved,
// and from there to as many ends as there are continuations.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/kernel/virtual_clock.hpp"
#include "sim/scenario/runner.hpp"

namespace vinv::scenario {

class VirtualRun {
 public:
  // The scenario outlives the run. Throws PlantFileError or std::runtime_error if plant or master cannot be made.
  VirtualRun(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options);

  // Everything up to and including this time of the scenario, not before what has run already.
  void run_until(Duration at);
  // To the first instant from there on at which a snapshot can be taken: multiples of 100 ms. Returns it; refused if
  // the run is over before.
  Result<Duration, std::string> run_to_grid(Duration at);
  bool finished() const { return runner_.finished(); }
  // To the end. Call it last.
  RunResult finish();

  // Between two run_until, on the grid of snapshots: multiples of 100 ms. Refused with a sentence.
  Result<void, std::string> save(Bytes& out);
  // Goes on as the run that was saved, byte for byte; results are those of one run. The scenario may be another one
  // from here on: its plant and the steps so far are the same. With
  // another seed everything random is other from here on. A refused load leaves the run as it was.
  Result<void, std::string> load(ByteView snapshot);

 private:
  std::string objection() const;

  kernel::Scheduler scheduler_;
  kernel::VirtualClock clock_;
  rig::Plant plant_;
  Runner runner_;
  Duration longest_;
};

// Of a run on its way, or of where it begins.
struct SnapshotOptions {
  ByteView resume;             // a saved run that this one goes on from; empty: it begins at the beginning
  std::optional<Duration> at;  // saved at the first possible instant from there on
  std::function<void(Duration at, const Bytes& snapshot)> on_saved;  // may throw
};
// A whole run, or the rest of one. Does not throw: what goes wrong, a refused snapshot too, is in the result.
RunResult run_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                      const SnapshotOptions& snapshots);

// A whole run. Neither throws: what goes wrong is in the result.
RunResult run_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options);
// The rest of a run that was saved. Any number of them, also at the same time in several threads.
RunResult resume_virtual(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                         ByteView snapshot);

}  // namespace vinv::scenario
