// Simulated time: integer nanoseconds since the start of the plant. Engines and models get it as an argument;
// nothing below sim/kernel knows which clock makes it pass.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

namespace vinv {

using Duration = std::chrono::nanoseconds;

// A clock without now(): whoever owns the time passes it down.
struct SimClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<SimClock, duration>;
  static constexpr bool is_steady = true;
};

using Instant = SimClock::time_point;

inline constexpr Instant kForever = Instant::max();

constexpr Instant instant_from_ns(std::int64_t ns) { return Instant{Duration{ns}}; }
constexpr std::int64_t to_ns(Instant t) { return t.time_since_epoch().count(); }
constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }
constexpr double to_seconds(Instant t) { return to_seconds(t.time_since_epoch()); }

// Rounds to the nearest nanosecond.
constexpr Duration seconds_to_duration(double s) {
  return Duration{static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5))};
}

}  // namespace vinv
