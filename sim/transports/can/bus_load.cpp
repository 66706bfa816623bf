#include "sim/transports/can/bus_load.hpp"

#include <algorithm>

namespace vinv::transports {

void CanLoadMeter::roll_to(Instant window) {
  if (window == window_) return;
  peak_ = std::max(peak_, in_window_);
  last_ = window - window_ == kWindow ? in_window_ : Duration{};
  in_window_ = Duration{};
  window_ = window;
}

void CanLoadMeter::add(Instant begin, Instant end) {
  begin = std::max(begin, counted_to_);
  if (end <= begin) return;
  total_ += end - begin;
  counted_to_ = end;
  roll_to(window_of(begin));
  while (end > window_ + kWindow) {
    in_window_ += window_ + kWindow - begin;
    begin = window_ + kWindow;
    roll_to(begin);
  }
  in_window_ += end - begin;
}

CanLoad CanLoadMeter::load(Instant now) const {
  const double window = to_seconds(kWindow);
  CanLoadMeter m = *this;
  // What lies ahead of now is less than a frame and its intermission, which is less than a window.
  const Duration ahead = std::max(counted_to_ - now, Duration{});
  m.total_ -= ahead;
  if (window_of(now) > window_) m.roll_to(window_of(now));
  CanLoad out;
  out.last_second = to_seconds(m.last_) / window;
  out.peak_second = to_seconds(m.peak_) / window;
  const Duration span = now - start_;
  if (span > Duration{}) out.total = std::min(1.0, to_seconds(m.total_) / to_seconds(span));
  return out;
}

}  // namespace vinv::transports
