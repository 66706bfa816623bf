// A scenario as data: a plant, tracks of steps, checks. docs/scenarios.md is the language; scenario_file.hpp reads it.
// Plain values: the same scenario runs any number of times, and a run is a pure function of it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/plant_file.hpp"
#include "sim/rig/trace.hpp"

namespace vinv::scenario {

// What can be looked at in a drive, by name.
struct Observable {
  enum class Kind : std::uint8_t {
    kSignal,     // a number: one of Inverter::signals()
    kState,      // on or off: one of state_words()
    kText,       // one of text_words(): alarm, mode, display, led
    kTerminal,   // on or off, by its printed name
    kParameter,  // a number without unit
  };
  Kind kind = Kind::kSignal;
  std::string name;
  std::string unit;       // of a signal, as the inverter names it: "Hz", "A", "degC"
  std::size_t index = 0;  // of a signal, in Inverter::signals(); of a state or text, in its table
};

// What a value must be. Numbers are in the observable's unit.
struct Expectation {
  Observable what;
  double low = 0;  // numbers: the interval that is allowed
  double high = 0;
  bool low_open = false;  // the bound itself is not allowed
  bool high_open = false;
  double target = 0;  // middle of a tolerance, or the bound that was written
  bool on = false;    // states and terminals
  std::string text;   // texts
  std::string shown;  // as written: "40 Hz +- 0.5 Hz"
};
// All of them at the same time.
using Condition = std::vector<Expectation>;

// When a step begins: at a time of the scenario, or some time after the step before; then on a condition.
struct Pace {
  std::optional<Duration> at;
  std::optional<Duration> after;
  Condition when;  // empty: none
  std::optional<Duration> within;
};

// One word of the control socket.
struct Action {
  std::string command;
  rig::Json value;
  bool refused = false;  // the drive must refuse it
};
struct Check {
  Condition all;
};
// The value gets there in time; the step waits for it.
struct Reached {
  Expectation target;
  bool crossing = false;  // passing through the target counts, although no sample may lie on it
  Duration within{};
  std::optional<Duration> not_before;
};
// A signal goes from one value to another; the step waits for it, and measures.
struct Ramp {
  Observable what;
  double from = 0;
  double to = 0;
  Duration time{};
  Duration tolerance{};
  std::optional<double> linearity;  // largest distance from the straight line between both points
};
// An alarm comes; the step waits for it.
struct Trip {
  std::string code;  // empty: any
  Duration within{};
  Condition with;                  // holds at the latest `settle` after the trip
  std::vector<std::string> cause;  // words that the cause chain has
};
// Something that is watched from here to the WatchEnd of the same number, or to the end of the scenario.
struct Watch {
  enum class Kind : std::uint8_t { kAlways, kNever, kOvershoot, kRising, kFalling, kFollows };
  struct Followed {
    Observable what;
    std::size_t column = 0;  // of the trace
    double tolerance = 0;
  };
  Kind kind = Kind::kAlways;
  std::size_t number = 0;
  Condition all;                            // kAlways, kNever
  Observable what;                          // the others
  double target = 0;                        // kOvershoot
  double tolerance = 0;                     // kOvershoot: how far beyond the target; kRising, kFalling: how far back
  std::shared_ptr<const rig::Trace> trace;  // kFollows
  std::vector<Followed> followed;
  Duration trace_begin{};  // its time at the beginning of the span
};
struct WatchEnd {
  std::size_t number = 0;
};
struct RepeatBegin {
  unsigned times = 1;
};
struct RepeatEnd {
  std::size_t begin = 0;  // index of its RepeatBegin
};
struct Note {
  std::string text;
};
// Only the pace counts.
struct Wait {};
// A raw frame through a master, in the master's own notation.
struct SendFrame {
  Bytes bytes;
};
struct ExpectFrame {
  Bytes bytes;
  Bytes mask;  // as long as bytes; a bit that is 0 may be anything
  Duration within{};
  bool absent = false;  // no such frame may come in that time
};

struct Step {
  using What = std::variant<Wait, Action, Check, Reached, Ramp, Trip, Watch, WatchEnd, RepeatBegin, RepeatEnd, Note,
                            SendFrame, ExpectFrame>;
  rig::Position at;
  std::size_t drive = 0;  // index into Scenario::plant.drives
  std::string via;        // name of a master; empty: by hand
  Pace pace;
  What what;
  std::string text;  // for people: "run: forward"
};

struct Track {
  std::string name;  // empty: the main one
  std::vector<Step> steps;
};

// How much more a live run may take and be off.
struct LiveTolerance {
  Duration time{};
  double value = 0;  // fraction of the expected value
};

struct Scenario {
  std::string path;   // as messages name it
  std::string name;   // file name without ending
  std::string title;  // what it shows: the first line's comment
  rig::PlantFile plant;
  std::uint64_t seed = 1;
  Duration limit{};
  LiveTolerance tolerance;
  std::vector<std::string> allow_trips;          // alarms that do not fail the run
  std::map<std::string, std::string> variables;  // with values given from outside
  std::vector<Track> tracks;                     // `steps:` first
  std::size_t watches = 0;
};

}  // namespace vinv::scenario
