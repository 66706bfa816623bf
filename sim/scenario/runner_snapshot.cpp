// Snapshots of a run: what the runner remembers, and whether it is of this scenario.
#include <algorithm>
#include <optional>

#include "sim/base/check.hpp"
#include "sim/scenario/runner.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {

std::string Runner::snapshot_objection() const {
  if (options_.live) return "a snapshot is of virtual time; this run is live.";
  if (!masters_.empty())
    return "a snapshot does not hold the masters of a scenario: " + masters_.begin()->first + " is one (via).";
  if (state_.finished) return "the run is over.";
  return {};
}

// The steps of a track as far as it has come, the one that it is at included.
std::string Runner::story(std::size_t track) const {
  const std::vector<Step>& steps = scenario_.tracks[track].steps;
  std::string out;
  for (std::size_t i = 0; i < std::min(state_.tracks[track].next + 1, steps.size()); ++i) {
    const Step& s = steps[i];
    out += drive_name(s) + " " + s.via + " " + std::to_string(s.what.index()) + " " + s.text;
    if (s.pace.at) out += " at " + show_duration(*s.pace.at);
    if (s.pace.after) out += " after " + show_duration(*s.pace.after);
    for (const Expectation& e : s.pace.when) out += " when " + e.what.name + " " + e.shown;
    out += "\n";
  }
  return out;
}

void Runner::archive_state(Archive& a) {
  // Scenario, options and masters are what the run was made of; without masters nobody uses one or has its frames.
  VINV_MEMBERS(*this, scenario, plant, options, observers, before, recorder, masters, master_user, frames, wakeups,
               start_event, tick_event, state, result, on_finished, steps_now, steps_at);
  VINV_MEMBERS(result, path, name, title, seed, verdict, reason, end, events, events_lost, checks, recording);
  VINV_CHECK(masters.empty());
  a.must_match("number of tracks", scenario.tracks.size());
  VINV_FIELDS(a, Runner, state, before, events, events_lost, checks, steps_now, steps_at);
  if (a.loads()) check_loaded(a);
  if (a.failed()) return;
  state.watches.resize(scenario.watches);
  for (std::size_t i = 0; i < scenario.tracks.size(); ++i) {
    const std::string so_far = story(i);
    a.must_match("scenario: it has other steps before this instant",
                 snapshot_checksum({reinterpret_cast<const std::uint8_t*>(so_far.data()), so_far.size()}));
  }
  for (const auto& observer : observers) a.io(*observer);
  a.io(*recorder);

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
    for (const LoopState& loop : t.loops)
      a.require(
          loop.begin < tracks[i].steps.size() && std::holds_alternative<RepeatBegin>(tracks[i].steps[loop.begin].what),
          "a track repeats what there is not");
  }
  for (std::size_t n = 0; n < state_.watches.size(); ++n) {
    const WatchState& w = state_.watches[n];
    if (!w.active) continue;
    const bool exists = w.track < tracks.size() && w.step < tracks[w.track].steps.size();
    const auto* const watch = exists ? std::get_if<Watch>(&tracks[w.track].steps[w.step].what) : nullptr;
    a.require(watch != nullptr && watch->number == n && n < scenario_.watches, "a span is watched that there is not");
  }
}

}  // namespace vinv::scenario
