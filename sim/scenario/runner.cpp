// Order of steps, time and waiting. The checks are in runner_checks.cpp.
#include "sim/scenario/runner.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

using Phase = TrackState::Phase;

// More steps at one instant are a loop in which no time passes.
constexpr std::uint64_t kMaxStepsAtOnce = 100'000;

}  // namespace

Runner::Runner(const Scenario& scenario, rig::Plant& plant, RunOptions options)
    : scenario_(scenario), plant_(plant), options_(std::move(options)) {
  std::vector<const Observer*> recorded;
  for (const auto& d : plant_.drives()) {
    observers_.push_back(std::make_unique<Observer>(*d));
    before_.push_back(observers_.back()->seen());
    recorded.push_back(observers_.back().get());
  }
  options_.recording.period = inverter::Inverter::kControlPeriod;
  recorder_ = std::make_unique<Recorder>(std::move(recorded), options_.recording);
  wakeups_.resize(scenario_.tracks.size());
  state_.tracks.resize(scenario_.tracks.size());
  state_.watches.resize(scenario_.watches);
  state_.alarms.assign(observers_.size(), std::string(kNoAlarm));
  result_ = not_run(scenario_, options_);
}

Runner::~Runner() {
  for (const Wakeup& w : wakeups_)
    if (w.event != 0) plant_.scheduler().cancel(w.event);
  for (const kernel::EventId id : {start_event_, tick_event_})
    if (id != 0) plant_.scheduler().cancel(id);
}

void Runner::start() {
  auto& scheduler = plant_.scheduler();
  const Instant now = scheduler.now();
  state_.start = now;
  for (TrackState& t : state_.tracks) t.since = now;
  for (const Track& track : scenario_.tracks)
    for (const Step& step : track.steps)
      if (const auto made = make_master(step.via); !made) throw std::runtime_error(made.error());
  // The plant's own tick was scheduled for the same instants before, so that its drives have ticked by then.
  tick_event_ = scheduler.schedule_every(now + options_.recording.period, options_.recording.period,
                                         kernel::Priority::kObserver, [this](Instant at) { tick(at); });
  start_event_ = scheduler.schedule(now, kernel::Priority::kStimulus, [this](Instant at) { pass(at); });
}

// A name that is empty means nobody.
Result<void, std::string> Runner::make_master(const std::string& name) {
  if (name.empty() || masters_.count(name) > 0) return {};
  const auto kind = std::find_if(options_.masters.begin(), options_.masters.end(),
                                 [&](const MasterKind& m) { return m.name == name; });
  if (kind == options_.masters.end()) return Unexpected("there is no master \"" + name + "\".");
  auto made = kind->make(
      {plant_, result_.seed, [this](WireRecord r) { recorder_->add_wire(std::move(r)); }, options_.open_udp});
  if (!made) return Unexpected("the master " + name + " cannot start: " + rig::sentence(made.error()));
  masters_[name] = std::move(made).value();
  return {};
}

void Runner::tick(Instant now) {
  ++state_.ticks;
  state_.ticked_at = now;
  state_.acted = false;
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    before_[i] = observers_[i]->seen();
    observers_[i]->look();
  }
  recorder_->sample(now);
  follow_drives(now);
  if (!state_.stopping) follow_watches(now);
  pass(now);
  if (state_.finished) return;
  if (!state_.stopping && now - state_.start >= scenario_.limit) out_of_time(now);
  if (state_.stopping && now >= state_.end_at) finish(now);
}

void Runner::pass(Instant now) {
  for (bool some = true; some && !state_.stopping;) {
    some = false;
    for (std::size_t i = 0; i < state_.tracks.size() && !state_.stopping; ++i)
      some = advance(now, i) == Progress::kSome || some;
  }
  const bool all_done = std::all_of(state_.tracks.begin(), state_.tracks.end(),
                                    [](const TrackState& t) { return t.phase == Phase::kDone; });
  if (all_done && !state_.stopping) stop(now);
}

Runner::Progress Runner::advance(Instant now, std::size_t i) {
  TrackState& t = state_.tracks[i];
  switch (t.phase) {
    case Phase::kDone: return Progress::kNone;
    case Phase::kBegin: return begin_step(now, i);
    case Phase::kTime:
      if (now < t.due) return Progress::kNone;
      t.phase = Phase::kWhen;
      t.begun = now;
      return Progress::kSome;
    case Phase::kWhen: {
      const Step& step = current(i);
      if (step.pace.when.empty() || (!state_.acted && observer(step).holds(step.pace.when, widening()))) {
        t.phase = Phase::kRun;
        return Progress::kSome;
      }
      if (!step.pace.within || state_.acted || now - t.begun < patience(*step.pace.within)) return Progress::kNone;
      for (const Expectation& e : step.pace.when) {
        const auto seen = observer(step).judge(e, widening(), true);
        if (!seen.holds)
          result(now, &step, false, "when: " + e.what.name, e.shown + " within " + show_duration(*step.pace.within),
                 seen.text);
      }
      stop(now);
      return Progress::kNone;
    }
    case Phase::kRun: return run_step(now, i);
    case Phase::kBlocked: return poll_step(now, i);
  }
  return Progress::kNone;
}

Runner::Progress Runner::begin_step(Instant now, std::size_t i) {
  TrackState& t = state_.tracks[i];
  if (t.next >= scenario_.tracks[i].steps.size()) {
    t.phase = Phase::kDone;
    return Progress::kSome;
  }
  if (steps_at_ != now) steps_now_ = 0;
  steps_at_ = now;
  const Step& step = current(i);
  if (++steps_now_ > kMaxStepsAtOnce) {
    result(now, &step, false, "time", "passes", std::to_string(kMaxStepsAtOnce) + " steps at one instant");
    stop(now);
    return Progress::kNone;
  }
  const Pace& pace = step.pace;
  t.due = pace.at ? state_.start + *pace.at : pace.after ? t.since + *pace.after : now;
  if (pace.at && t.due < now) {
    result(now, &step, false, "at: " + show_duration(*pace.at), "not yet over", "it is " + show_time(now) + " already");
    stop(now);
    return Progress::kNone;
  }
  t.phase = Phase::kTime;
  if (t.due > now) wake(t.due, i);
  return Progress::kSome;
}

void Runner::wake(Instant at, std::size_t i) {
  auto& scheduler = plant_.scheduler();
  // Another track's wakeup at this instant may have come first and done what this one was for.
  if (wakeups_[i].event != 0) scheduler.cancel(wakeups_[i].event);
  wakeups_[i].event = scheduler.schedule(at, kernel::Priority::kStimulus, [this, i](Instant now) { woken(now, i); });
}

void Runner::woken(Instant now, std::size_t i) {
  wakeups_[i].event = 0;
  pass(now);
}

Runner::Progress Runner::run_step(Instant now, std::size_t i) {
  TrackState& t = state_.tracks[i];
  const Step& step = current(i);
  if (const auto* action = std::get_if<Action>(&step.what)) {
    if (!step.via.empty()) {
      t.phase = Phase::kBlocked;
      t.begun = now;
      t.started = false;
      return Progress::kSome;
    }
    if (act(now, i, step, *action)) finish_step(now, i);
    return Progress::kSome;
  }
  if (const auto* check = std::get_if<Check>(&step.what)) {
    if (state_.acted) return Progress::kNone;
    judge(now, step, check->all, "check");
    finish_step(now, i);
    return Progress::kSome;
  }
  if (const auto* watch = std::get_if<Watch>(&step.what)) {
    begin_watch(now, i, t.next, *watch);
  } else if (const auto* end = std::get_if<WatchEnd>(&step.what)) {
    end_watch(now, end->number);
  } else if (const auto* loop = std::get_if<RepeatBegin>(&step.what)) {
    t.loops.push_back({t.next, loop->times - 1});
  } else if (std::holds_alternative<RepeatEnd>(step.what)) {
    LoopState& round = t.loops.back();
    if (round.left > 0) {
      --round.left;
      t.next = round.begin;  // finish_step goes on to the first step of the body
    } else {
      t.loops.pop_back();
    }
  } else if (const auto* note = std::get_if<Note>(&step.what)) {
    event(now, Event::Kind::kNote, "", note->text, step.at.line);
  } else if (const auto* frame = std::get_if<SendFrame>(&step.what)) {
    if (!t.sending) {
      hear(now, step.via);
      t.spoke_at = now;
      t.sending = true;
    }
    masters_.at(step.via)->send_frame(now, frame->bytes);
    event(now, Event::Kind::kAction, "", step.text + " via " + step.via, step.at.line);
    state_.acted = true;
  } else if (!std::holds_alternative<Wait>(step.what)) {
    t.phase = Phase::kBlocked;
    t.begun = now;
    t.started = false;
    t.last.reset();
    t.samples.clear();
    // A ramp that this instant's actions set off begins at what the drive showed before them.
    // One that follows another from where that ended has begun in the tick that is over.
    if (const auto* ramp = std::get_if<Ramp>(&step.what)) {
      const bool over = !state_.acted && now == state_.ticked_at;
      t.last = over ? before_[step.drive].signals[ramp->what.index] : observer(step).number(ramp->what);
      t.last_at = over ? now - options_.recording.period : state_.ticked_at;
    }
    return Progress::kSome;
  }
  finish_step(now, i);
  return Progress::kSome;
}

Runner::Progress Runner::poll_step(Instant now, std::size_t i) {
  TrackState& t = state_.tracks[i];
  const Step& step = current(i);
  if (const auto* action = std::get_if<Action>(&step.what)) {
    Master& master = *masters_.at(step.via);
    if (!t.started) {
      if (master_user_.count(step.via) > 0) return Progress::kNone;  // another track's turn
      master_user_[step.via] = i;
      t.started = true;
      event(now, Event::Kind::kAction, drive_name(step), step.text + " via " + step.via, step.at.line);
      hear(now, step.via);
      t.spoke_at = now;
      t.sending = false;
      master.begin(now, step.drive, action->command, action->value);
    }
    const auto outcome = master.poll(now);
    if (!outcome) return Progress::kNone;
    master_user_.erase(step.via);
    state_.acted = true;
    answer(now, step, *action, *outcome, true);
    if (!state_.stopping) finish_step(now, i);
    return Progress::kSome;
  }
  if (state_.acted) return Progress::kNone;
  if (const auto* reached = std::get_if<Reached>(&step.what)) return poll_reached(now, i, step, *reached);
  if (const auto* ramp = std::get_if<Ramp>(&step.what)) return poll_ramp(now, i, step, *ramp);
  if (const auto* trip = std::get_if<Trip>(&step.what)) return poll_trip(now, i, step, *trip);
  return poll_frame(now, i, step, std::get<ExpectFrame>(step.what));
}

void Runner::finish_step(Instant now, std::size_t i) {
  TrackState& t = state_.tracks[i];
  ++t.next;
  t.since = now;
  t.phase = Phase::kBegin;
}

// False if the run stops.
bool Runner::act(Instant now, std::size_t, const Step& step, const Action& action) {
  event(now, Event::Kind::kAction, drive_name(step), step.text, step.at.line);
  const auto done = rig::execute(plant_, action.command, drive_name(step), action.value);
  state_.acted = true;
  if (done)
    answer(now, step, action, *done, true);
  else
    answer(now, step, action, Unexpected(done.error().message), done.error().code == rig::CommandCode::kRefused);
  return !state_.stopping;
}

void Runner::answer(Instant now, const Step& step, const Action& action, const Master::Outcome& outcome, bool refusal) {
  if (action.refused && !outcome && refusal) {
    result(now, &step, true, step.text, "refused", outcome.error());
  } else if (action.refused && outcome) {
    result(now, &step, false, step.text, "refused", "done");
  } else if (!outcome) {
    result(now, &step, false, step.text, "done", outcome.error());
    stop(now);
  }
}

void Runner::stop(Instant now) {
  if (state_.stopping) return;
  state_.stopping = true;
  for (std::size_t i = 0; i < state_.watches.size(); ++i) end_watch(now, i);
  for (Wakeup& w : wakeups_)
    if (w.event != 0) plant_.scheduler().cancel(std::exchange(w.event, 0));
  // What follows a trip is recorded to the end of its window.
  state_.end_at = std::max(now, recorder_->window_ends());
}

void Runner::out_of_time(Instant now) {
  for (std::size_t i = 0; i < state_.tracks.size(); ++i) {
    if (state_.tracks[i].phase == Phase::kDone) continue;
    const std::string& name = scenario_.tracks[i].name;
    const Step& step = current(i);
    result(now, &step, false, "limit", "the end within " + show_duration(scenario_.limit),
           (name.empty() ? "" : "track " + name + " ") + ("at \"" + step.text + "\""));
  }
  stop(now);
}

void Runner::finish(Instant now) {
  if (state_.finished) return;
  state_.finished = true;
  if (tick_event_ != 0) plant_.scheduler().cancel(std::exchange(tick_event_, 0));
  result_.end = now;
  const bool failed =
      std::any_of(result_.checks.begin(), result_.checks.end(), [](const CheckResult& c) { return !c.passed; });
  result_.verdict = failed ? Verdict::kFailed : Verdict::kPassed;
  if (on_finished_) on_finished_();
}

void Runner::abort(const std::string& reason) {
  const Instant now = plant_.scheduler().now();
  stop(now);
  finish(now);
  result_.verdict = Verdict::kNotRun;
  result_.reason = reason;
}

RunResult Runner::take_result() {
  result_.recording = recorder_->take();
  return std::move(result_);
}

Duration Runner::patience(Duration limit) const { return options_.live ? limit + scenario_.tolerance.time : limit; }

double Runner::widening() const { return options_.live ? scenario_.tolerance.value : 0; }

const std::string& Runner::drive_name(const Step& step) const { return scenario_.plant.drives[step.drive].name; }

RunResult not_run(const Scenario& scenario, const RunOptions& options) {
  RunResult result;
  result.path = scenario.path;
  result.name = scenario.name;
  result.title = scenario.title;
  result.seed = options.seed.value_or(scenario.seed);
  return result;
}

}  // namespace vinv::scenario
