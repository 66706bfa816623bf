// Runs a scenario on a plant. It looks at the drives after each control tick and acts between ticks, on the plant's
// scheduler: under a virtual clock as fast as the machine allows, under an event loop in real time.
//
// A step that waits for a time acts at that time, before the drives' tick; a step that waits for the drives acts right
// after the tick that brought it about. What was just done is looked at from the next tick on.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "sim/rig/plant.hpp"
#include "sim/scenario/master.hpp"
#include "sim/scenario/recorder.hpp"
#include "sim/scenario/result.hpp"
#include "sim/scenario/run_state.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

struct RunOptions {
  bool live = false;                  // the file's tolerance applies
  std::optional<std::uint64_t> seed;  // in place of the file's
  RecorderSettings recording;
  std::vector<MasterKind> masters;
  OpenUdp open_udp = {};  // live: where adapters hear sockets only
};

class Runner {
 public:
  // Scenario and plant outlive the runner; the plant is the scenario's, and has not started.
  Runner(const Scenario& scenario, rig::Plant& plant, RunOptions options);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  // Right after the plant's start(), at the same instant. Throws std::runtime_error if a master cannot be made.
  void start();
  bool finished() const { return state_.finished; }
  // Called once, from within an event of the scheduler.
  void set_on_finished(std::function<void()> done) { on_finished_ = std::move(done); }
  // The run could not go on: a numerical failure, for example.
  void abort(const std::string& reason);
  // After finished() or abort().
  RunResult take_result();

  const RunState& state() const { return state_; }

  // --- snapshots (docs/decisions/0005-snapshots.md) ---

  // Why the run cannot be saved now, beside what its plant objects to; empty if it can.
  std::string snapshot_objection() const;
  // Before the plant, which is to find the nodes and connections of the masters.
  void archive_masters(Archive& a);
  // Position of all tracks, what they wait for, checks, events and recording; after the plant. The scenario that loads
  // has the same plant, and the same steps as far as that had come; what follows, limits and seed may be others.
  friend void archive(Archive& a, Runner& runner) { runner.archive_state(a); }

 private:
  struct Wakeup {
    kernel::EventId event = 0;
  };
  enum class Progress : std::uint8_t { kNone, kSome };

  void tick(Instant now);
  void pass(Instant now);
  Progress advance(Instant now, std::size_t track);
  Progress begin_step(Instant now, std::size_t track);
  Progress run_step(Instant now, std::size_t track);
  Progress poll_step(Instant now, std::size_t track);
  void finish_step(Instant now, std::size_t track);
  void wake(Instant at, std::size_t track);
  void woken(Instant now, std::size_t track);

  bool act(Instant now, std::size_t track, const Step& step, const Action& action);
  void answer(Instant now, const Step& step, const Action& action, const Master::Outcome& outcome, bool refusal);
  void judge(Instant now, const Step& step, const Condition& all, const std::string& what);
  Progress poll_reached(Instant now, std::size_t track, const Step& step, const Reached& r);
  Progress poll_ramp(Instant now, std::size_t track, const Step& step, const Ramp& r);
  void judge_ramp(Instant now, std::size_t track, const Step& step, const Ramp& r, Instant end);
  Progress poll_trip(Instant now, std::size_t track, const Step& step, const Trip& t);
  void hear(Instant now, const std::string& via);
  Progress poll_frame(Instant now, std::size_t track, const Step& step, const ExpectFrame& f);
  void begin_watch(Instant now, std::size_t track, std::size_t step_index, const Watch& w);
  void follow_trace(Instant now, WatchState& state, const Step& step, const Watch& w);
  void end_watch(Instant now, std::size_t number);
  void follow_watches(Instant now);
  void follow_drives(Instant now);
  void stop(Instant now);
  void finish(Instant now);
  void out_of_time(Instant now);

  void event(Instant now, Event::Kind kind, const std::string& drive, std::string text, int line = 0);
  void result(Instant now, const Step* step, bool passed, std::string what, std::string expected, std::string seen);
  const std::string& drive_name(const Step& step) const;
  Observer& observer(const Step& step) { return *observers_[step.drive]; }
  Duration patience(Duration limit) const;
  double widening() const;
  const Step& current(std::size_t track) const { return scenario_.tracks[track].steps[state_.tracks[track].next]; }

  // runner_snapshot.cpp
  void archive_state(Archive& a);
  void check_loaded(Archive& a) const;
  void check_loops(Archive& a, std::size_t track) const;
  void archive_watches(Archive& a);
  std::string story(std::size_t track) const;
  Result<void, std::string> make_master(const std::string& name);

  const Scenario& scenario_;
  rig::Plant& plant_;
  RunOptions options_;
  std::vector<std::unique_ptr<Observer>> observers_;
  std::vector<Snapshot> before_;  // what the drives were like a tick ago
  std::unique_ptr<Recorder> recorder_;
  std::map<std::string, std::unique_ptr<Master>> masters_;
  std::map<std::string, std::size_t> master_user_;         // track that uses it now
  std::map<std::string, std::vector<HeardFrame>> frames_;  // that no step has expected yet, oldest first
  std::vector<Wakeup> wakeups_;
  kernel::EventId start_event_ = 0;
  kernel::EventId tick_event_ = 0;
  RunState state_;
  RunResult result_;
  std::function<void()> on_finished_;
  std::uint64_t steps_now_ = 0;  // steps done at this instant
  Instant steps_at_{};
};

// What a result says before the run: which scenario, which seed.
RunResult not_run(const Scenario& scenario, const RunOptions& options);

}  // namespace vinv::scenario
