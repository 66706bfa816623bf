#include "sim/transports/can/bus_load.hpp"

#include <gtest/gtest.h>

namespace vinv::transports {
namespace {

constexpr Instant at_ms(std::int64_t ms) { return instant_from_ns(ms * 1'000'000); }

TEST(CanLoadMeter, CountsBusyTimePerSecondAndInTotal) {
  CanLoadMeter m(at_ms(500));
  m.add(at_ms(600), at_ms(700));
  m.add(at_ms(1100), at_ms(1400));
  EXPECT_DOUBLE_EQ(m.load(at_ms(1500)).last_second, 0.1);
  EXPECT_DOUBLE_EQ(m.load(at_ms(1500)).total, 0.4);
  EXPECT_DOUBLE_EQ(m.load(at_ms(2000)).last_second, 0.3);
  EXPECT_DOUBLE_EQ(m.load(at_ms(2000)).peak_second, 0.3);
  EXPECT_DOUBLE_EQ(m.load(at_ms(3000)).last_second, 0.0);
  EXPECT_DOUBLE_EQ(m.load(at_ms(3000)).peak_second, 0.3);
  EXPECT_DOUBLE_EQ(m.load(at_ms(4500)).total, 0.1);
}

TEST(CanLoadMeter, SplitsAnIntervalAtTheSecondsItCrosses) {
  CanLoadMeter m(at_ms(0));
  m.add(at_ms(900), at_ms(3200));
  EXPECT_DOUBLE_EQ(m.load(at_ms(3500)).last_second, 1.0);
  EXPECT_DOUBLE_EQ(m.load(at_ms(4000)).last_second, 0.2);
  EXPECT_DOUBLE_EQ(m.load(at_ms(4000)).peak_second, 1.0);
  EXPECT_DOUBLE_EQ(m.load(at_ms(4600)).total, 0.5);
}

TEST(CanLoadMeter, AQuietSecondBetweenIsZero) {
  CanLoadMeter m(at_ms(0));
  m.add(at_ms(100), at_ms(200));
  m.add(at_ms(2100), at_ms(2200));
  EXPECT_DOUBLE_EQ(m.load(at_ms(2500)).last_second, 0.0);
}

TEST(CanLoadMeter, WhatLiesAheadIsNotCountedYet) {
  CanLoadMeter m(at_ms(0));
  m.add(at_ms(0), at_ms(200));
  EXPECT_DOUBLE_EQ(m.load(at_ms(100)).total, 1.0);
  EXPECT_DOUBLE_EQ(m.load(at_ms(400)).total, 0.5);
}

}  // namespace
}  // namespace vinv::transports
