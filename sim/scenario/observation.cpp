#include "sim/scenario/observation.hpp"

#include <algorithm>
#include <cmath>

#include "motor_model/drive/drive_types.hpp"
#include "sim/rig/commands.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

// A set frequency that comes through an input filter is reached only in the limit.
constexpr double kAtReference_hz = 0.05;

std::string on_off(bool on) { return on ? "on" : "off"; }

}  // namespace

const std::array<std::string_view, kStateCount>& state_words() {
  static const std::array<std::string_view, kStateCount> words{
      "powered", "ready",           "running",  "stopped",       "at_reference",       "forward",
      "reverse", "up_to_frequency", "overload", "power_failure", "frequency_detected", "tripped"};
  return words;
}

const std::array<std::string_view, kTextCount>& text_words() {
  static const std::array<std::string_view, kTextCount> words{"alarm", "mode", "display", "led"};
  return words;
}

Observer::Observer(const rig::DriveUnit& drive) : drive_(drive) {
  for (const auto& s : drive.inverter->signals()) {
    if (s.name == "set_frequency") set_frequency_ = names_.size();
    if (s.name == "output_frequency") output_frequency_ = names_.size();
    if (s.name == "run_state") run_state_ = names_.size();
    names_.emplace_back(s.name);
    units_.emplace_back(s.unit);
  }
  for (const auto& [name, on] : drive.inverter->terminals()) terminals_.emplace_back(name);
  seen_.signals.resize(names_.size());
  seen_.terminals.resize(terminals_.size());
  look();
}

void Observer::look() {
  const inverter::Inverter& inverter = *drive_.inverter;
  std::size_t i = 0;
  for (const auto& s : inverter.signals()) seen_.signals[i++] = s.value;
  i = 0;
  for (const auto& [name, on] : inverter.terminals()) seen_.terminals[i++] = on;
  const port::DrivePort& port = drive_.inverter->port();
  const port::Status s = port.status();
  seen_.alarm = inverter.alarm_name();
  if (seen_.alarm.empty()) seen_.alarm = kNoAlarm;
  seen_.mode = port.operation_mode();
  seen_.led = drive_.board ? drive_.board->status_led() : std::string_view{};
  const bool constant = run_state_ && seen_.signals[*run_state_] == static_cast<double>(drive::RunState::kConstant);
  const bool near = set_frequency_ && output_frequency_ &&
                    std::abs(seen_.signals[*set_frequency_] - seen_.signals[*output_frequency_]) <= kAtReference_hz;
  const auto set = [&](State state, bool on) { seen_.states[static_cast<std::size_t>(state)] = on; };
  set(State::kPowered, inverter.powered());
  set(State::kReady, port.ready());
  set(State::kRunning, s.running);
  set(State::kStopped, !s.running);
  set(State::kAtReference, s.running && s.up_to_frequency && (constant || near));
  set(State::kForward, s.forward);
  set(State::kReverse, s.reverse);
  set(State::kUpToFrequency, s.up_to_frequency);
  set(State::kOverload, s.overload);
  set(State::kPowerFailure, s.power_failure);
  set(State::kFrequencyDetected, s.frequency_detected);
  set(State::kTripped, seen_.alarm != kNoAlarm);
}

double Observer::number(const Observable& o) const { return seen_.signals[o.index]; }

Observer::Judgement Observer::judge(const Expectation& e, double widen, bool with_text) const {
  Judgement j;
  const auto within = [&](double value) {
    const double more = std::abs(e.target) * widen;
    const double low = e.low - more;
    const double high = e.high + more;
    return (e.low_open ? value > low : value >= low) && (e.high_open ? value < high : value <= high);
  };
  const auto text = [&](std::string now) {
    j.holds = now == e.text;
    if (with_text) j.text = now.empty() ? "nothing" : std::move(now);
  };
  const auto state = [&](bool now) {
    j.holds = now == e.on;
    if (with_text) j.text = on_off(now);
  };
  switch (e.what.kind) {
    case Observable::Kind::kSignal:
      j.number = number(e.what);
      j.holds = within(j.number);
      if (with_text) j.text = show_value(j.number, e.what.unit);
      break;
    case Observable::Kind::kState: state(seen_.states[e.what.index]); break;
    case Observable::Kind::kTerminal: state(seen_.terminals[e.what.index]); break;
    case Observable::Kind::kText:
      switch (static_cast<Text>(e.what.index)) {
        case Text::kAlarm: text(seen_.alarm); break;
        case Text::kMode: text(std::string(rig::mode_name(seen_.mode))); break;
        case Text::kDisplay: text(drive_.inverter->display()); break;
        case Text::kLed: text(seen_.led); break;
      }
      break;
    case Observable::Kind::kParameter: {
      const auto value = drive_.inverter->get_parameter(e.what.name);
      if (value) j.number = *value;
      j.holds = value && within(*value);
      if (with_text) j.text = value ? show_value(*value, "-") : value.error();
      break;
    }
  }
  return j;
}

bool Observer::holds(const Condition& c, double widen) const {
  return std::all_of(c.begin(), c.end(), [&](const Expectation& e) { return judge(e, widen, false).holds; });
}

void archive(Archive& a, Snapshot& snapshot) {
  VINV_MEMBERS(snapshot, signals, states, alarm, mode, led, terminals);
  VINV_FIELDS(a, Snapshot, signals, states, alarm, mode, led);
  const std::size_t count = a.count(terminals.size());
  if (a.loads()) terminals.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    bool on = terminals[i];
    a.io(on);
    terminals[i] = on;
  }
}

void Observer::archive_state(Archive& a) {
  VINV_MEMBERS(*this, drive, names, units, terminals, set_frequency, output_frequency, run_state, seen);
  a.io(seen);
  a.require(seen.signals.size() == names.size() && seen.terminals.size() == terminals.size(),
            "a drive has other signals or terminals");
}

}  // namespace vinv::scenario
