// Everything that a run of a scenario remembers between two ticks, as plain values: it can be copied and put back, as
// the state of the plant can.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::scenario {

struct HeardFrame {
  Instant at{};  // of the look that found it
  Bytes bytes;
};

struct LoopState {
  std::size_t begin = 0;  // index of the RepeatBegin
  unsigned left = 0;      // rounds that still come
};

struct TrackState {
  enum class Phase : std::uint8_t { kBegin, kTime, kWhen, kRun, kBlocked, kDone };
  Phase phase = Phase::kBegin;
  std::size_t next = 0;  // step
  std::vector<LoopState> loops;
  Instant since{};  // end of the step before
  Instant due{};    // kTime
  Instant begun{};  // kWhen, kBlocked
  // What a waiting step has seen.
  bool started = false;  // a ramp has left its beginning, a trip has come, a master has been asked
  Instant mark{};        // when that was
  std::optional<double> last;
  Instant last_at{};
  std::vector<std::pair<Instant, double>> samples;
  // Its last word through a master, or the first of several frames that it sent: what was heard before is no answer.
  std::optional<Instant> spoke_at;
  bool sending = false;  // frames, and has not expected one since
};

struct WatchState {
  bool active = false;
  bool failed = false;
  std::size_t track = 0;
  std::size_t step = 0;
  bool begun = false;  // has seen a value
  double start = 0;    // the first one
  double extreme = 0;
  Instant since{};         // begin of the span
  std::string worst_name;  // of the signal with the largest part of its tolerance, which is in extreme
};

struct RunState {
  Instant start{};
  std::uint64_t ticks = 0;
  Instant ticked_at{};
  bool acted = false;     // a step has acted since the last tick
  bool stopping = false;  // no further steps
  Instant end_at{};       // when stopping
  bool finished = false;
  std::vector<TrackState> tracks;
  std::vector<WatchState> watches;
  std::vector<std::string> alarms;  // of each drive, at the last tick
};

}  // namespace vinv::scenario
