// The overload curves: inverter 150 % for 60 s and 200 % for 3 s; motor 150 % for 60 s from hot.
#include <gtest/gtest.h>

#include <utility>

#include "motor_model/drive/electronic_thermal.hpp"
#include "motor_model/drive/inverter_overload.hpp"

namespace vinv::drive {
namespace {

double seconds_to_trip(InverterOverload overload, double ratio, double start = 1.1, double dt = 0.001) {
  int n = 0;
  while (!overload.tripped() && n < 2'000'000) {
    overload.step(dt, ratio, 50, start);
    ++n;
  }
  return n * dt;
}

double seconds_to_trip(ElectronicThermal thermal, double ratio, double hz = 50, bool forced = false) {
  int n = 0;
  while (!thermal.tripped() && n < 2'000'000) {
    thermal.step(0.001, ratio, hz, forced);
    ++n;
  }
  return n * 0.001;
}

ElectronicThermal hot() {
  ElectronicThermal t;
  for (int i = 0; i < 1000; ++i) t.step(326, 1, 50, false);
  return t;
}

TEST(InverterOverload, TripTimesFollowTheInverseTimeCurve) {
  for (const auto& [ratio, seconds] : {std::pair{1.1, 659.0},
                                       {1.2, 362.0},
                                       {1.3, 199.0},
                                       {1.4, 109.0},
                                       {1.5, 60.0},
                                       {1.6, 33.0},
                                       {1.7, 18.1},
                                       {1.8, 9.94},
                                       {1.9, 5.46},
                                       {2.0, 3.0}}) {
    EXPECT_NEAR(seconds_to_trip(InverterOverload{}, ratio, 1.05), seconds, seconds * 0.02) << ratio;
  }
}

TEST(InverterOverload, CountsOnlyAboveItsStartLevelAndBackBelow) {
  InverterOverload overload;
  for (int i = 0; i < 3'000'000; ++i) overload.step(0.001, 1.1, 50, 1.1);
  EXPECT_EQ(overload.fraction(), 0);
  for (int i = 0; i < 30'000; ++i) overload.step(0.001, 1.5, 50, 1.1);
  EXPECT_NEAR(overload.fraction(), 0.5, 0.001);
  for (int i = 0; i < 30'000; ++i) overload.step(0.001, 1.0, 50, 1.1);
  EXPECT_NEAR(overload.fraction(), 0.25, 0.001);
}

TEST(InverterOverload, AnOverloadCountsForMoreNearStandstillButRatedCurrentDoesNot) {
  EXPECT_EQ(InverterOverload::effective_ratio(1.5, 10), 1.5);
  EXPECT_NEAR(InverterOverload::effective_ratio(1.5, 5), 1.6, 1e-12);
  EXPECT_NEAR(InverterOverload::effective_ratio(1.5, 0), 1.7, 1e-12);
  EXPECT_EQ(InverterOverload::effective_ratio(1.0, 0), 1.0);
  InverterOverload slow;
  InverterOverload fast;
  for (int i = 0; i < 10'000; ++i) slow.step(0.001, 1.5, 5, 1.1), fast.step(0.001, 1.5, 50, 1.1);
  EXPECT_NEAR(fast.fraction(), 10.0 / 60, 1e-6);
  EXPECT_NEAR(slow.fraction(), 10.0 / InverterOverload::time_to_trip_s(1.6), 1e-6);
}

TEST(ElectronicThermal, TripTimesFromColdAndHotFollowTheTable) {
  struct Row {
    double ratio, cold_s, hot_s;
  };
  for (const Row& row : {Row{1.15, 804, 344}, Row{1.2, 598, 212}, Row{1.3, 411, 118}, Row{1.5, 252, 60},
                         Row{1.75, 164, 35}, Row{2.0, 118, 24}, Row{2.5, 70, 13}, Row{3.0, 47, 8.7}}) {
    // The table is rounded to whole seconds, which is more than 2 % in its last hot columns.
    EXPECT_NEAR(seconds_to_trip(ElectronicThermal{}, row.ratio), row.cold_s, row.cold_s * 0.02) << row.ratio;
    EXPECT_NEAR(seconds_to_trip(hot(), row.ratio), row.hot_s, std::max(row.hot_s * 0.02, 0.5)) << row.ratio;
  }
}

TEST(ElectronicThermal, RatedCurrentNeverTripsAt50Hz) {
  const ElectronicThermal t = hot();
  EXPECT_NEAR(t.fraction(), 1 / 1.21, 1e-6);
  EXPECT_FALSE(t.tripped());
  EXPECT_FALSE(t.pre_alarm());
}

TEST(ElectronicThermal, DeratingFollowsItsBreakPoints) {
  for (const auto& [hz, c] : {std::pair{0.0, 0.4},
                              {1.0, 0.4},
                              {3.0, 0.45},
                              {5.0, 0.5},
                              {15.0, 0.6},
                              {17.5, 0.65},
                              {20.0, 0.7},
                              {30.0, 0.9},
                              {40.0, 0.95},
                              {50.0, 1.0},
                              {120.0, 1.0}}) {
    EXPECT_NEAR(ElectronicThermal::continuous_current(hz), c, 1e-12) << hz;
  }
}

TEST(ElectronicThermal, ASelfCooledMotorTripsAtLowSpeedAForcedCooledOneDoesNot) {
  EXPECT_LT(seconds_to_trip(ElectronicThermal{}, 1.0, 5), 150);
  ElectronicThermal forced;
  for (int i = 0; i < 1000; ++i) forced.step(10, 1.0, 5, true);
  EXPECT_FALSE(forced.tripped());
}

TEST(ElectronicThermal, PreAlarmComesAt85PercentAndCoolingClearsIt) {
  ElectronicThermal t;
  while (t.fraction() < 0.8499) {
    EXPECT_FALSE(t.pre_alarm());
    t.step(0.01, 1.5, 50, false);
  }
  t.step(0.1, 1.5, 50, false);
  EXPECT_TRUE(t.pre_alarm());
  EXPECT_FALSE(t.tripped());
  t.step(326, 0, 0, false);
  EXPECT_NEAR(t.fraction(), 0.85 / 2.71828, 0.01);
}

}  // namespace
}  // namespace vinv::drive
