// Which frames a fault befalls: the nth, every nth, by chance, so many times, within a span of time. Shared by the
// faults of all wires.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"
#include "sim/base/random.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

struct FaultTrigger {
  std::uint64_t nth = 0;    // that one, counted from 1; 0: see every
  std::uint64_t every = 0;  // each one whose number is a multiple; 0: by probability
  double probability = 0;   // of each, 0 to 1
  std::uint64_t times = 0;  // not more often; 0: no limit
  Instant from{};           // frames before it are not looked at
  Instant until = kForever;

  bool acts() const { return nth != 0 || every != 0 || probability > 0; }
  static FaultTrigger only(std::uint64_t number) {
    FaultTrigger t;
    t.nth = number;
    return t;
  }
  static FaultTrigger by_chance(double p) {
    FaultTrigger t;
    t.probability = p;
    return t;
  }
  static FaultTrigger always() { return by_chance(1); }
  VINV_ARCHIVE(FaultTrigger, nth, every, probability, times, from, until);
};

// How far a trigger has counted.
struct FaultCount {
  std::uint64_t seen = 0;
  std::uint64_t hits = 0;

  // One more frame. The random number is drawn for each, so that one rule's luck does not depend on another's.
  bool hit(const FaultTrigger& when, Instant now, Random& random) {
    const bool by_chance = when.nth == 0 && when.every == 0;
    const bool lucky = by_chance && random.uniform() < when.probability;
    if (now < when.from || now >= when.until) return false;
    ++seen;
    const bool chosen = by_chance ? lucky : when.nth != 0 ? seen == when.nth : seen % when.every == 0;
    if (!chosen || (when.times != 0 && hits >= when.times)) return false;
    ++hits;
    return true;
  }
  VINV_ARCHIVE(FaultCount, seen, hits);
};

}  // namespace vinv::transports
