// Snapshots of a run: what the runner remembers, and whether it is of this scenario.
#include <algorithm>
#include <optional>

#include "sim/base/check.hpp"
#include "sim/scenario/runner.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {

std::string Runner::snapshot_objection() const {
  if (options_.live) return "a snapshot is of virtual time; this run is live.";
  if (state_.finished) return "the run is over at " + show_time(result_.end) + ".";
  return {};
}

// The steps of a track as far as it has come; of the one that it waits for, what it waits for.
std::string Runner::story(std::size_t track) const {
  const std::vector<Step>& steps = scenario_.tracks[track].steps;
  const TrackState& t = state_.tracks[track];
  std::string out = scenario_.tracks[track].name + "\n";
  const auto tell = [&](const Step& s, bool begun) {
    if (s.pace.at) out += " at " + std::to_string(s.pace.at->count());
    if (s.pace.after) out += " after " + std::to_string(s.pace.after->count());
    if (begun) {
      for (const Expectation& e : s.pace.when) out += " when " + e.what.name + " " + e.shown;
      const auto* action = std::get_if<Action>(&s.what);
      out += " " + drive_name(s) + " " + s.via + " " + std::to_string(s.what.index()) + " " + s.text;
      if (action != nullptr && action->refused) out += " refused";
    }
    out += "\n";
  };
  for (std::size_t i = 0; i < std::min(t.next, steps.size()); ++i) tell(steps[i], true);
  const bool waits = t.phase == TrackState::Phase::kTime || t.phase == TrackState::Phase::kWhen;
  const bool works = t.phase == TrackState::Phase::kRun || t.phase == TrackState::Phase::kBlocked;
  if ((waits || works) && t.next < steps.size()) tell(steps[t.next], works);
  return out;
}

void Runner::archive_masters(Archive& a) {
  const std::size_t count = a.count(masters_.size());
  if (a.loads()) masters_.clear();
  auto at = masters_.begin();
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    std::string name = a.loads() ? std::string() : (at++)->first;
    a.io(name);
    if (a.failed()) return;
    if (const auto made = make_master(name); !made) return a.fail(made.error());
    a.require(masters_.count(name) > 0, "a master without name");
    if (!a.failed()) masters_.at(name)->archive_wires(a);
  }
  if (!a.loads()) return;
  // Those of steps to come.
  for (const Track& track : scenario_.tracks)
    for (const Step& step : track.steps)
      if (const auto made = make_master(step.via); !made) return a.fail(made.error());
}

// By the step that began it: another story behind it numbers its spans otherwise.
void Runner::archive_watches(Archive& a) {
  const auto active = static_cast<std::size_t>(
      std::count_if(state_.watches.begin(), state_.watches.end(), [](const WatchState& w) { return w.active; }));
  const std::size_t count = a.count(active, scenario_.watches);
  if (!a.loads()) {
    for (WatchState& w : state_.watches)
      if (w.active) a.io(w);
    return;
  }
  state_.watches.assign(scenario_.watches, {});
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    WatchState w;
    a.io(w);
    const bool exists = w.track < scenario_.tracks.size() && w.step < scenario_.tracks[w.track].steps.size();
    const auto* const watch = exists ? std::get_if<Watch>(&scenario_.tracks[w.track].steps[w.step].what) : nullptr;
    a.require(w.active && watch != nullptr, "a span is watched that there is not");
    if (a.failed()) return;
    state_.watches[watch->number] = w;
  }
}

void Runner::archive_state(Archive& a) {
  // Scenario and options are what the run was made of.
  VINV_MEMBERS(*this, scenario, plant, options, observers, before, recorder, masters, master_user, frames, wakeups,
               start_event, tick_event, state, result, on_finished, steps_now, steps_at);
  VINV_MEMBERS(result, path, name, title, seed, verdict, reason, end, events, events_lost, checks, recording);
  a.must_match("plant: the scenario says otherwise of it", scenario.plant.checksum);
  a.must_match("number of tracks", scenario.tracks.size());
  std::uint64_t saved_seed = seed;
  VINV_FIELDS(a, Runner, saved_seed, state, before, events, events_lost, checks, steps_now, steps_at, frames,
              master_user);
  if (a.loads()) check_loaded(a);
  if (a.failed()) return;
  for (std::size_t i = 0; i < scenario.tracks.size(); ++i) {
    if (a.failed()) return;
    const std::string so_far = story(i);
    a.must_match("scenario: it has other steps before this instant",
                 snapshot_checksum({reinterpret_cast<const std::uint8_t*>(so_far.data()), so_far.size()}));
    check_loops(a, i);
  }
  // Only now: the steps that began them are the same.
  archive_watches(a);
  for (std::size_t i = 0; i < observers.size(); ++i) {
    a.io(*observers[i]);
    const Snapshot& is = observers[i]->seen();
    a.require(before[i].signals.size() == is.signals.size() && before[i].terminals.size() == is.terminals.size(),
              "a drive had other signals or terminals");
  }
  a.io(*recorder);

  // Those that the snapshot has; the others have done nothing yet.
  std::vector<std::string> saved_masters;
  for (const auto& [via, master] : masters) saved_masters.push_back(via);
  a.io(saved_masters);
  for (const std::string& via : saved_masters) {
    a.require(masters.count(via) > 0, "a master that there is not");
    if (a.failed()) return;
    masters.at(via)->archive_state(a);
  }

  auto& scheduler = plant.scheduler();
  scheduler.archive_event(a, start_event, [this](Instant now) { pass(now); });
  for (std::size_t i = 0; i < wakeups.size(); ++i)
    scheduler.archive_event(a, wakeups[i].event, [this, i](Instant now) { woken(now, i); });
  // An observer, whose place is nobody's business but its own.
  const auto place = scheduler.place_of(tick_event);
  std::optional<Instant> next_tick;
  if (place) next_tick = place->at;
  a.io(next_tick);
  if (!a.loads() || a.failed()) return;
  a.require(!next_tick || *next_tick >= scheduler.now(), "a tick lies in the past");
  if (a.failed()) return;
  tick_event = 0;
  if (next_tick)
    tick_event = scheduler.schedule_every(*next_tick, options.recording.period, kernel::Priority::kObserver,
                                          [this](Instant now) { tick(now); });
  verdict = Verdict::kNotRun;
  reason.clear();
  end = Instant{};
  if (saved_seed != seed) plant.reseed(seed);
}

// Of steps that are those of the snapshot: the loops that a track is in are those around its step.
void Runner::check_loops(Archive& a, std::size_t track) const {
  const std::vector<Step>& steps = scenario_.tracks[track].steps;
  const TrackState& t = state_.tracks[track];
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < std::min(t.next, steps.size()); ++i) {
    if (std::holds_alternative<RepeatBegin>(steps[i].what)) open.push_back(i);
    if (std::holds_alternative<RepeatEnd>(steps[i].what)) open.pop_back();
  }
  a.require(std::equal(open.begin(), open.end(), t.loops.begin(), t.loops.end(),
                       [](std::size_t begin, const LoopState& loop) { return begin == loop.begin; }),
            "a track repeats what there is not");
}

// All that a run uses as an index.
void Runner::check_loaded(Archive& a) const {
  const auto& tracks = scenario_.tracks;
  a.require(state_.tracks.size() == tracks.size() && state_.alarms.size() == observers_.size() &&
                before_.size() == observers_.size(),
            "a run has other tracks or drives");
  a.require(!state_.finished, "a run that is over");
  if (a.failed()) return;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const TrackState& t = state_.tracks[i];
    const bool at_step = t.phase != TrackState::Phase::kDone && t.phase != TrackState::Phase::kBegin;
    const bool exists = at_step ? t.next < tracks[i].steps.size() : t.next <= tracks[i].steps.size();
    if (!exists) return a.fail("the snapshot is of another scenario: it has come further than this one goes");
  }
  for (const auto& [via, track] : master_user_)
    a.require(masters_.count(via) > 0 && track < tracks.size(), "a master is used by nobody");
}

}  // namespace vinv::scenario
