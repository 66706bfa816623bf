#include "sim/kernel/lateness.hpp"

#include <gtest/gtest.h>

namespace vinv::kernel {
namespace {

using std::chrono::microseconds;

TEST(Lateness, NoSampleGivesZeroAndSaysSo) {
  const LatenessHistogram h;
  EXPECT_EQ(h.quantile(0.5), Duration{});
  EXPECT_EQ(h.text(), "no events ran\n");
}

TEST(Lateness, QuantileIsTheLimitBelowWhichTheFractionLies) {
  LatenessHistogram h;
  for (int i = 0; i < 98; ++i) h.add(Duration{400});  // below 1 us
  h.add(microseconds(3));                             // in [2, 4)
  h.add(microseconds(100));                           // in [64, 128)
  EXPECT_EQ(h.count(), 100u);
  EXPECT_EQ(h.quantile(0.5), microseconds(1));
  EXPECT_EQ(h.quantile(0.98), microseconds(1));
  EXPECT_EQ(h.quantile(0.99), microseconds(4));
  EXPECT_EQ(h.quantile(1.0), microseconds(128));
  EXPECT_EQ(h.maximum(), microseconds(100));
}

TEST(Lateness, ABoundaryBelongsToTheBucketAboveIt) {
  LatenessHistogram h;
  h.add(Duration{999});
  EXPECT_EQ(h.quantile(1.0), microseconds(1));
  LatenessHistogram one;
  one.add(microseconds(1));
  EXPECT_EQ(one.quantile(1.0), microseconds(2));
}

TEST(Lateness, EarlyCountsAsOnTimeAndHoursFitIn) {
  LatenessHistogram h;
  h.add(Duration{-5000});
  EXPECT_EQ(h.quantile(1.0), microseconds(1));
  EXPECT_EQ(h.maximum(), Duration{});
  h.add(std::chrono::hours(3));
  EXPECT_EQ(h.quantile(1.0), Duration(std::chrono::hours(3)));
}

TEST(Lateness, MergeAddsCountsAndKeepsTheLargerMaximum) {
  LatenessHistogram a;
  LatenessHistogram b;
  a.add(microseconds(10));
  b.add(microseconds(1000));
  b.merge(a);
  EXPECT_EQ(b.count(), 2u);
  EXPECT_EQ(b.quantile(0.5), microseconds(16));
  EXPECT_EQ(b.maximum(), microseconds(1000));
}

TEST(Lateness, TextNamesTheQuantiles) {
  LatenessHistogram h;
  for (int i = 0; i < 1000; ++i) h.add(microseconds(i < 995 ? 5 : 200));
  EXPECT_EQ(h.text(), "1000 events; late by less than 8 us in 50 %, 8 us in 99 %, 256 us in 99.9 %; at most 200 us\n");
}

}  // namespace
}  // namespace vinv::kernel
