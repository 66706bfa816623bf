// The outcome of one run: events, checks, verdict.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"
#include "sim/rig/plant_file.hpp"
#include "sim/scenario/recording.hpp"

namespace vinv::scenario {

struct Event {
  enum class Kind : std::uint8_t { kAction, kState, kTrip, kCheck, kNote, kWire };
  friend VINV_ENUM_RANGE(Kind, kAction, kWire);
  Instant at;
  Kind kind = Kind::kState;
  std::string drive;  // empty: the scenario as a whole
  std::string text;   // "run: forward", "running", "trip E.OV3: DC link ..."
  int line = 0;       // of the scenario file; 0: not caused by a step
  VINV_ARCHIVE(Event, at, kind, drive, text, line);
};
inline constexpr std::size_t kMaxEvents = 100'000;

struct CheckResult {
  bool passed = false;
  Instant at;                     // when it was decided
  std::string drive;              // empty: the scenario as a whole
  std::string what;               // "reached: output_frequency"
  std::string expected;           // "50 Hz +- 0.5 Hz within 5.2 s"
  std::string seen;               // "48.2 Hz"
  std::string cause;              // cause chain of the alarm that was present; empty: none
  rig::Position where;            // of the step in the scenario file; line 0: the scenario as a whole
  std::size_t events_before = 0;  // how many of RunResult::events had happened
  friend void archive(Archive& a, CheckResult& check) {
    VINV_MEMBERS(check, passed, at, drive, what, expected, seen, cause, where, events_before);
    VINV_FIELDS(a, CheckResult, passed, at, drive, what, expected, seen, cause, where.line, where.column,
                events_before);
  }
};

enum class Verdict : std::uint8_t { kPassed, kFailed, kNotRun };

struct RunResult {
  std::string path;
  std::string name;
  std::string title;
  std::uint64_t seed = 0;
  Verdict verdict = Verdict::kNotRun;
  std::string reason;  // of kNotRun: a sentence or lines with positions
  Instant end{};
  std::vector<Event> events;
  std::uint64_t events_lost = 0;
  std::vector<CheckResult> checks;
  Recording recording;

  std::size_t failures() const {
    std::size_t n = 0;
    for (const CheckResult& c : checks) n += c.passed ? 0 : 1;
    return n;
  }
};

// A failed check for a person: what, where, when, expected, seen, cause, and the last events before it.
std::string failure_text(const RunResult& result, const CheckResult& check);

}  // namespace vinv::scenario
