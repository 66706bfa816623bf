// How busy a bus is: the share of time taken by frames, error frames and their intermissions, per second of simulated
// time and over all. A bus on which frame follows frame has a load of 1.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

struct CanLoad {
  double last_second = 0;  // the last complete second, from one whole second of simulated time to the next
  double peak_second = 0;  // the busiest complete second so far
  double total = 0;        // from the first instant of the bus to now
};

class CanLoadMeter {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(1);

  explicit CanLoadMeter(Instant start) : start_(start), window_(window_of(start)), counted_to_(start) {}
  // The bus was busy from begin to end. Intervals come in order and do not overlap; end may lie ahead of now.
  void add(Instant begin, Instant end);
  // Of what was added, without what lies ahead of now.
  CanLoad load(Instant now) const;

 private:
  static Instant window_of(Instant t) { return t - t.time_since_epoch() % kWindow; }
  void roll_to(Instant window);

  Instant start_;
  Instant window_;      // start of the window that is being filled
  Instant counted_to_;  // end of the last interval
  Duration in_window_{};
  Duration last_{};
  Duration peak_{};
  Duration total_{};
  VINV_ARCHIVE(CanLoadMeter, start_, window_, counted_to_, in_window_, last_, peak_, total_);
};

}  // namespace vinv::transports
