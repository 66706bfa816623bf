// What a run is judged by: values, times, ramps, trips, spans.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/rig/commands.hpp"
#include "sim/scenario/runner.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

using Phase = TrackState::Phase;

// Status bits, LEDs and output terminals may follow an alarm a little later.
constexpr Duration kTripSettles = std::chrono::milliseconds(100);
constexpr std::size_t kMaxChecks = 100'000;
constexpr std::size_t kMaxRampSamples = 200'000;
constexpr std::size_t kMaxHeard = 4096;

// Numbers that were computed are equal up to this part of the span.
constexpr double kRounding = 1e-6;

Instant crossing(Instant t0, double v0, Instant t1, double v1, double level) {
  if (v1 == v0) return t1;
  const double part = std::clamp((level - v0) / (v1 - v0), 0.0, 1.0);
  return t0 + Duration{static_cast<std::int64_t>(std::llround(part * static_cast<double>((t1 - t0).count())))};
}

// What was heard in place of an expected frame: how many, and the last of them.
std::string other_frames(const std::vector<HeardFrame>& heard, std::optional<Instant> since) {
  constexpr std::size_t kShown = 3;
  std::vector<std::string> texts;
  for (const HeardFrame& frame : heard)
    if (!since || frame.at > *since) texts.push_back(show_bytes(frame.bytes));
  if (texts.empty()) return "no frame";
  std::string out = std::to_string(texts.size()) + (texts.size() == 1 ? " other frame" : " other frames");
  const std::size_t first = texts.size() > kShown ? texts.size() - kShown : 0;
  out += first > 0 ? ", at last " : ": ";
  for (std::size_t i = first; i < texts.size(); ++i) out += (i == first ? "" : " | ") + texts[i];
  return out;
}

std::string seconds(Duration d) { return show_duration(std::chrono::duration_cast<std::chrono::microseconds>(d)); }

}  // namespace

// --- bookkeeping ---

void Runner::event(Instant now, Event::Kind kind, const std::string& drive, std::string text, int line) {
  if (result_.events.size() < kMaxEvents)
    result_.events.push_back({now, kind, drive, std::move(text), line});
  else
    ++result_.events_lost;
}

void Runner::result(Instant now, const Step* step, bool passed, std::string what, std::string expected,
                    std::string seen) {
  // Failures stop the run or come once for each watch: only what passes can be many.
  if (passed && result_.checks.size() >= kMaxChecks) return;
  CheckResult c;
  c.passed = passed;
  c.at = now;
  if (step != nullptr) {
    c.where = step->at;
    c.drive = drive_name(*step);
    if (!passed) c.cause = plant_.drives()[step->drive]->inverter->alarm_cause();
  }
  c.what = std::move(what);
  c.expected = std::move(expected);
  c.seen = std::move(seen);
  c.events_before = result_.events.size();
  event(now, Event::Kind::kCheck, c.drive,
        c.what + (passed ? ": as expected, " : ": expected " + c.expected + ", seen ") + c.seen, c.where.line);
  result_.checks.push_back(std::move(c));
}

// --- drives ---

void Runner::follow_drives(Instant now) {
  constexpr std::array kTold{State::kPowered, State::kReady, State::kRunning, State::kAtReference, State::kOverload};
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    const Snapshot& is = observers_[i]->seen();
    const Snapshot& was = before_[i];
    const std::string& name = scenario_.plant.drives[i].name;
    for (const State s : kTold) {
      const auto at = static_cast<std::size_t>(s);
      if (is.states[at] != was.states[at])
        event(now, Event::Kind::kState, name, (is.states[at] ? "" : "not ") + std::string(state_words()[at]));
    }
    if (is.mode != was.mode) event(now, Event::Kind::kState, name, "mode " + std::string(rig::mode_name(is.mode)));
    if (is.alarm == state_.alarms[i]) continue;
    state_.alarms[i] = is.alarm;
    if (is.alarm == kNoAlarm) {
      event(now, Event::Kind::kState, name, "no alarm");
      continue;
    }
    recorder_->mark(now);
    const std::string cause = plant_.drives()[i]->inverter->alarm_cause();
    event(now, Event::Kind::kTrip, name, "trip " + is.alarm + (cause.empty() ? "" : ": " + cause));
    bool expected =
        std::find(scenario_.allow_trips.begin(), scenario_.allow_trips.end(), is.alarm) != scenario_.allow_trips.end();
    for (std::size_t t = 0; t < state_.tracks.size() && !expected; ++t) {
      if (state_.tracks[t].phase != Phase::kBlocked) continue;
      const Step& step = current(t);
      const auto* trip = std::get_if<Trip>(&step.what);
      expected = trip != nullptr && step.drive == i && trip->code == is.alarm;
    }
    if (expected || state_.stopping) continue;
    CheckResult c;
    c.at = now;
    c.drive = name;
    c.what = "no unexpected trip";
    c.expected = "no alarm";
    c.seen = is.alarm;
    c.cause = cause;
    c.events_before = result_.events.size();
    result_.checks.push_back(std::move(c));
    stop(now);
  }
}

// --- checks at one instant ---

void Runner::judge(Instant now, const Step& step, const Condition& all, const std::string& what) {
  for (const Expectation& e : all) {
    const auto seen = observer(step).judge(e, widening(), true);
    result(now, &step, seen.holds, what + ": " + e.what.name, e.shown, seen.text);
  }
}

Runner::Progress Runner::poll_reached(Instant now, std::size_t i, const Step& step, const Reached& r) {
  TrackState& t = state_.tracks[i];
  const auto seen = observer(step).judge(r.target, widening(), false);
  bool there = seen.holds;
  if (r.crossing) {
    const double near = kRounding * std::max(1.0, std::abs(r.target.target));
    const double off = seen.number - r.target.target;
    there = std::abs(off) <= near || (t.last && (*t.last - r.target.target) * off < 0);
    t.last = seen.number;
  }
  const Duration took = now - t.begun;
  const Duration limit = patience(r.within);
  if (!there && took < limit) return Progress::kNone;
  const std::string what = "reached: " + r.target.what.name;
  std::string expected = r.target.shown + " within " + show_duration(r.within);
  if (r.not_before) expected += ", not before " + show_duration(*r.not_before);
  const std::string now_is = observer(step).judge(r.target, widening(), true).text;
  if (!there) {
    result(now, &step, false, what, expected, now_is + " after " + seconds(took));
    stop(now);
    return Progress::kNone;
  }
  const Duration earliest = r.not_before.value_or(Duration{}) - (options_.live ? scenario_.tolerance.time : Duration{});
  result(now, &step, took >= earliest, what, expected, now_is + " after " + seconds(took));
  finish_step(now, i);
  return Progress::kSome;
}

// --- ramps ---

Runner::Progress Runner::poll_ramp(Instant now, std::size_t i, const Step& step, const Ramp& r) {
  TrackState& t = state_.tracks[i];
  const double value = observer(step).number(r.what);
  const double sign = r.to > r.from ? 1 : -1;
  const double near = kRounding * std::abs(r.to - r.from);
  const auto behind = [&](double v) { return sign * (v - r.from) <= near; };  // not yet beyond the beginning
  if (behind(value)) {
    t.started = false;
    t.samples.clear();
  } else if (!t.started && t.last && behind(*t.last)) {
    t.started = true;
    t.mark = crossing(t.last_at, *t.last, now, value, r.from);
    t.samples.clear();
  }
  if (t.started && t.samples.size() < kMaxRampSamples) t.samples.emplace_back(now, value);
  const auto last = t.last;
  const Instant last_at = t.last_at;
  t.last = value;
  t.last_at = now;
  if (t.started && sign * (r.to - value) <= near) {
    judge_ramp(now, i, step, r, last ? crossing(last_at, *last, now, value, r.to) : now);
    finish_step(now, i);
    return Progress::kSome;
  }
  // Long enough to measure a ramp that is far too slow, and to wait for its beginning.
  const Duration limit = patience(3 * r.time + r.tolerance + std::chrono::seconds(5));
  if (now - t.begun < limit) return Progress::kNone;
  result(now, &step, false, "ramp: " + r.what.name,
         show_value(r.from, r.what.unit) + " to " + show_value(r.to, r.what.unit) + " in " + show_duration(r.time),
         t.started ? "only " + show_value(value, r.what.unit) + " after " + seconds(now - t.mark)
                   : "no beginning at " + show_value(r.from, r.what.unit) + "; " + show_value(value, r.what.unit) +
                         " after " + seconds(now - t.begun));
  stop(now);
  return Progress::kNone;
}

void Runner::judge_ramp(Instant now, std::size_t i, const Step& step, const Ramp& r, Instant end) {
  const TrackState& t = state_.tracks[i];
  const Duration took = end - t.mark;
  const Duration off = std::chrono::abs(took - r.time);
  const std::string span = show_value(r.from, r.what.unit) + " to " + show_value(r.to, r.what.unit);
  result(now, &step, off <= patience(r.tolerance), "ramp: " + r.what.name,
         span + " in " + show_duration(r.time) + " +- " + show_duration(r.tolerance), seconds(took));
  if (!r.linearity || took.count() <= 0) return;
  double worst = 0;
  Instant worst_at = t.mark;
  for (const auto& [at, value] : t.samples) {
    if (at > end) continue;
    const double part = static_cast<double>((at - t.mark).count()) / static_cast<double>(took.count());
    const double distance = std::abs(value - (r.from + part * (r.to - r.from)));
    if (distance > worst) {
      worst = distance;
      worst_at = at;
    }
  }
  const double allowed = *r.linearity + std::abs(r.to - r.from) * widening();
  result(now, &step, worst <= allowed, "linearity: " + r.what.name,
         "at most " + show_value(*r.linearity, r.what.unit) + " from the straight line " + span,
         show_value(worst, r.what.unit) + " at " + show_time(worst_at));
}

// --- trips ---

Runner::Progress Runner::poll_trip(Instant now, std::size_t i, const Step& step, const Trip& trip) {
  TrackState& t = state_.tracks[i];
  Observer& seen = observer(step);
  if (!t.started) {
    if (seen.seen().alarm != trip.code) {
      if (now - t.begun < patience(trip.within)) return Progress::kNone;
      result(now, &step, false, "trip", trip.code + " within " + show_duration(trip.within),
             seen.seen().alarm == kNoAlarm ? "no alarm" : seen.seen().alarm);
      stop(now);
      return Progress::kNone;
    }
    t.started = true;
    t.mark = now;
    result(now, &step, true, "trip", trip.code + " within " + show_duration(trip.within),
           trip.code + " after " + seconds(now - t.begun));
  }
  if (!seen.holds(trip.with, widening()) && now - t.mark < kTripSettles) return Progress::kNone;
  judge(now, step, trip.with, "trip");
  const std::string cause = plant_.drives()[step.drive]->inverter->alarm_cause();
  for (const std::string& word : trip.cause)
    result(now, &step, cause.find(word) != std::string::npos, "trip: cause", "\"" + word + "\"",
           cause.empty() ? "no cause" : cause);
  finish_step(now, i);
  return Progress::kSome;
}

// --- frames ---

void Runner::hear(Instant now, const std::string& via) {
  auto& heard = frames_[via];
  for (Bytes& frame : masters_.at(via)->take_frames()) heard.push_back({now, std::move(frame)});
  if (heard.size() > kMaxHeard) heard.erase(heard.begin(), heard.end() - static_cast<std::ptrdiff_t>(kMaxHeard));
}

Runner::Progress Runner::poll_frame(Instant now, std::size_t i, const Step& step, const ExpectFrame& f) {
  TrackState& t = state_.tracks[i];
  t.sending = false;
  hear(now, step.via);
  auto& heard = frames_[step.via];
  const auto matches = [&](const HeardFrame& frame) {
    if (t.spoke_at && frame.at <= *t.spoke_at) return false;
    if (frame.bytes.size() != f.bytes.size()) return false;
    for (std::size_t k = 0; k < frame.bytes.size(); ++k)
      if ((frame.bytes[k] & f.mask[k]) != (f.bytes[k] & f.mask[k])) return false;
    return true;
  };
  const auto it = std::find_if(heard.begin(), heard.end(), matches);
  const bool found = it != heard.end();
  const bool over = now - t.begun >= (f.absent ? f.within : patience(f.within));
  if (!found && !over) return Progress::kNone;
  const std::string when = "after " + seconds(now - t.begun);
  const bool passed = found != f.absent;
  result(now, &step, passed, "expect_frame", step.text,
         found ? (passed ? when : show_bytes(it->bytes) + " " + when)
               : (passed ? "none in " + seconds(now - t.begun) : other_frames(heard, t.spoke_at)));
  // A sequence is told in its order: what came before is over.
  if (found) heard.erase(heard.begin(), it + 1);
  if (!passed) {
    stop(now);
    return Progress::kNone;
  }
  finish_step(now, i);
  return Progress::kSome;
}

// --- spans ---

void Runner::begin_watch(Instant now, std::size_t track, std::size_t step_index, const Watch& w) {
  WatchState& state = state_.watches[w.number];
  if (state.active) return;  // of a loop, with no end of its own: it goes on
  state = {};
  state.active = true;
  state.track = track;
  state.step = step_index;
  state.since = now;
}

void Runner::end_watch(Instant now, std::size_t number) {
  WatchState& state = state_.watches[number];
  if (!state.active) return;
  state.active = false;
  if (state.failed) return;
  const Step& step = scenario_.tracks[state.track].steps[state.step];
  const auto& w = std::get<Watch>(step.what);
  if (!state.begun) {
    result(now, &step, false, step.text, "a span with at least one tick", "none");
    return;
  }
  std::string seen = "held";
  if (w.kind == Watch::Kind::kOvershoot) seen = "at most " + show_value(state.extreme, w.what.unit);
  if (w.kind == Watch::Kind::kFollows)
    seen = "at most " + show_value(state.extreme * 100, "%") + " of the tolerance of " + state.worst_name;
  result(now, &step, true, step.text, "all the time", seen);
}

void Runner::follow_trace(Instant now, WatchState& state, const Step& step, const Watch& w) {
  const double t = to_seconds(w.trace_begin + (now - state.since));
  if (!w.trace->covers(t)) return;
  state.begun = true;
  for (const Watch::Followed& f : w.followed) {
    const double expected = w.trace->at(w.trace->columns[f.column], t);
    const double value = observer(step).number(f.what);
    const double tolerance = f.tolerance + std::abs(expected) * widening();
    const double off = std::abs(value - expected);
    if (off > tolerance) {
      state.failed = true;
      result(now, &step, false, step.text,
             f.what.name + " " + show_value(expected, f.what.unit) + " +- " + show_value(tolerance, f.what.unit) +
                 " at " + show_value(t, "s") + " of the table",
             show_value(value, f.what.unit));
      return;
    }
    const double part = tolerance > 0 ? off / tolerance : 0;
    if (part < state.extreme && !state.worst_name.empty()) continue;
    state.extreme = part;
    state.worst_name = f.what.name;
  }
}

void Runner::follow_watches(Instant now) {
  for (WatchState& state : state_.watches) {
    if (!state.active || state.failed) continue;
    const Step& step = scenario_.tracks[state.track].steps[state.step];
    const auto& w = std::get<Watch>(step.what);
    const Observer& seen = observer(step);
    if (w.kind == Watch::Kind::kFollows) {
      follow_trace(now, state, step, w);
      continue;
    }
    const bool first = !std::exchange(state.begun, true);
    const auto fail = [&](const std::string& expected, const std::string& is) {
      state.failed = true;
      result(now, &step, false, step.text, expected, is);
    };
    if (w.kind == Watch::Kind::kAlways) {
      for (const Expectation& e : w.all) {
        if (seen.judge(e, widening(), false).holds) continue;
        fail("always " + e.what.name + " " + e.shown, seen.judge(e, widening(), true).text);
        break;
      }
      continue;
    }
    if (w.kind == Watch::Kind::kNever) {
      if (!seen.holds(w.all, 0)) continue;
      std::string is;
      std::string expected = "never";
      for (const Expectation& e : w.all) {
        is += (is.empty() ? "" : ", ") + seen.judge(e, 0, true).text;
        expected += (expected == "never" ? " " : " and ") + e.what.name + " " + e.shown;
      }
      fail(expected, is);
      continue;
    }
    const double value = seen.number(w.what);
    if (first) {
      state.start = value;
      state.extreme = value;
      if (w.kind == Watch::Kind::kOvershoot) state.extreme = 0;
      continue;
    }
    if (w.kind == Watch::Kind::kOvershoot) {
      const double beyond = state.start <= w.target ? value - w.target : w.target - value;
      state.extreme = std::max(state.extreme, beyond);
      if (beyond > w.tolerance + std::abs(w.target) * widening())
        fail("at most " + show_value(w.tolerance, w.what.unit) + " beyond " + show_value(w.target, w.what.unit),
             show_value(value, w.what.unit));
      continue;
    }
    const double sign = w.kind == Watch::Kind::kRising ? 1 : -1;
    const double back = sign * (state.extreme - value);
    if (back > w.tolerance + std::abs(state.extreme) * widening()) {
      fail(std::string("only ") + (sign > 0 ? "rises" : "falls") +
               (w.tolerance > 0 ? ", but for " + show_value(w.tolerance, w.what.unit) : ""),
           "from " + show_value(state.extreme, w.what.unit) + " to " + show_value(value, w.what.unit));
      continue;
    }
    state.extreme = sign > 0 ? std::max(state.extreme, value) : std::min(state.extreme, value);
  }
}

}  // namespace vinv::scenario
