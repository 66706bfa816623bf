// What a lost line or a failed option does to the drive: FR-A7NE manual 4.5.1, Pr.500 to Pr.502. One step per tick.
#pragma once

#include <cstdint>

#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter::a700 {

class CommunicationError {
 public:
  struct Input {
    bool line_lost = false;
    bool line_acts = false;      // network operation: elsewhere the drive goes on
    bool option_failed = false;  // the option itself, where it acts: in network operation, a bad contact everywhere
    bool running = false;        // the output is on
    double wait_s = 0;           // Pr.500
    int stop_mode = 0;           // Pr.502
  };
  enum class Alarm : std::uint8_t { kNone, kLine, kOption };

  // The alarm to raise now, if any.
  Alarm step(double dt_s, const Input& input);
  // The drive has to decelerate whatever is commanded.
  bool stopping() const { return phase_ == Phase::kLineStops || phase_ == Phase::kOptionStops; }
  // The line's error is shown, without alarm (Pr.502 = 2, after the stop).
  bool shown() const { return shown_; }
  // The line was lost in this tick: Pr.501 counts.
  bool occurred() const { return occurred_; }
  void reset();  // a reset of the drive; a line that is still lost does not count anew

 private:
  enum class Phase : std::uint8_t { kGood, kLineStops, kOptionStops, kRaised };
  friend VINV_ENUM_RANGE(Phase, kGood, kRaised);
  Phase phase_ = Phase::kGood;
  drive::OnDelay lost_;
  bool last_lost_ = false;
  bool occurred_ = false;
  bool shown_ = false;
  VINV_ARCHIVE(CommunicationError, phase_, lost_, last_lost_, occurred_, shown_);
};

}  // namespace vinv::inverter::a700
