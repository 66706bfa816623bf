// What every snapshot has to stand: runs that are interrupted after each step, and forged bytes.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "sim/base/archive.hpp"
#include "sim/base/random.hpp"

namespace vinv {

// A run that is saved and goes on in a fresh object after each step saves the same bytes as one that is not, and so does
// one that has been doing something else. make(): an object; story(object, seed): a step, a function of seed and object;
// look(one, relayed): after both took it.
template <class Make, class Story, class Look>
void expect_the_same_after_each_step(int steps, std::uint64_t seed, Make&& make, Story&& story, Look&& look) {
  auto one = make();
  auto relayed = make();
  auto used = make();
  for (int i = 0; i < steps; ++i) {
    story(*one, seed);
    story(*relayed, seed);
    const Bytes saved = save_snapshot(*one);
    ASSERT_EQ(save_snapshot(*relayed), saved) << "step " << i;
    look(*one, *relayed);
    if (::testing::Test::HasFailure()) {
      ADD_FAILURE() << "step " << i;
      return;
    }
    auto fresh = make();
    const auto loaded = load_snapshot(*fresh, saved);
    ASSERT_TRUE(loaded) << loaded.error();
    ASSERT_EQ(save_snapshot(*fresh), saved) << "step " << i;
    relayed = std::move(fresh);
    story(*used, seed + 100);
    ASSERT_TRUE(load_snapshot(*used, saved));
    ASSERT_EQ(save_snapshot(*used), saved);
  }
}

// One bit of good is wrong, with a checksum that fits: it is refused, or taken and harmless (then(object) lives a little
// with it); in the end the object is as it was. More than at_least are refused.
template <class T, class Then>
void expect_forged_leave_no_trace(T& object, const Bytes& good, int tries, std::uint64_t seed, int at_least,
                                  Then&& then) {
  const Bytes before = save_snapshot(object);
  Random random(seed);
  int refused = 0;
  for (int i = 0; i < tries; ++i) {
    Bytes bad = good;
    const std::size_t at = kSnapshotHeader + random.below(bad.size() - kSnapshotHeader);
    bad[at] ^= static_cast<std::uint8_t>(1u << random.below(8));
    ASSERT_FALSE(load_snapshot(object, bad)) << "checksum";
    seal_snapshot(bad);
    if (load_snapshot(object, bad)) {
      then(object);
      ASSERT_TRUE(load_snapshot(object, before));
    } else {
      ++refused;
    }
    ASSERT_EQ(save_snapshot(object), before) << at;
  }
  EXPECT_GT(refused, at_least);
}

}  // namespace vinv
