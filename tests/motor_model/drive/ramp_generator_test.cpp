#include "motor_model/drive/ramp_generator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "motor_model/drive/s_curve.hpp"

namespace vinv::drive {
namespace {

constexpr double kDt = 0.001;

int ticks_to(RampGenerator& ramp, double target_hz, const RampTimes& times, int limit = 1000000) {
  int n = 0;
  while (ramp.frequency_hz() != target_hz && n < limit) {
    ramp.step(kDt, target_hz, times);
    ++n;
  }
  return n;
}

TEST(RampGenerator, LinearTakesExactlyTheSetTime) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 5, .deceleration_s = 2};
  EXPECT_NEAR(ticks_to(ramp, 50, times), 5000, 1);
  EXPECT_NEAR(ticks_to(ramp, 0, times), 2000, 1);
}

TEST(RampGenerator, PartialRampScalesWithReference) {
  RampGenerator ramp;
  RampTimes times{.acceleration_s = 5, .deceleration_s = 5};
  EXPECT_NEAR(ticks_to(ramp, 25, times), 2500, 1);
  times.reference_hz = 100;
  EXPECT_NEAR(ticks_to(ramp, 50, times), 1250, 1);
  EXPECT_NEAR(ticks_to(ramp, 40, times), 500, 1);
}

TEST(RampGenerator, ZeroTimeIsImmediate) {
  for (const auto pattern : {RampPattern::kLinear, RampPattern::kSCurveA, RampPattern::kSCurveB}) {
    RampGenerator ramp;
    const RampTimes times{.acceleration_s = 0, .deceleration_s = 0, .pattern = pattern};
    ramp.step(kDt, 50, times);
    EXPECT_EQ(ramp.frequency_hz(), 50);
    ramp.step(kDt, 20, times);
    EXPECT_EQ(ramp.frequency_hz(), 20);
    ramp.step(kDt, -20, times);
    EXPECT_EQ(ramp.frequency_hz(), 0);
    ramp.step(kDt, -20, times);
    EXPECT_EQ(ramp.frequency_hz(), -20);
  }
}

TEST(RampGenerator, TimesMayChangeOnTheWay) {
  for (const auto pattern : {RampPattern::kLinear, RampPattern::kSCurveB}) {
    RampGenerator ramp;
    RampTimes times{.acceleration_s = 10, .pattern = pattern};
    for (int i = 0; i < 5000; ++i) ramp.step(kDt, 50, times);
    EXPECT_NEAR(ramp.frequency_hz(), 25, 1e-6);
    times.acceleration_s = 2;
    EXPECT_NEAR(ticks_to(ramp, 50, times), 1000, 1);
  }
}

TEST(RampGenerator, ReversalDeceleratesToZeroThenAccelerates) {
  RampGenerator ramp;
  ramp.set(50);
  const RampTimes times{.acceleration_s = 4, .deceleration_s = 2};
  EXPECT_EQ(ramp.motion_towards(-50), Motion::kDecelerating);
  for (int i = 0; i < 1000; ++i) ramp.step(kDt, -50, times);
  EXPECT_NEAR(ramp.frequency_hz(), 25, 0.03);
  for (int i = 0; i < 1001; ++i) ramp.step(kDt, -50, times);
  EXPECT_NEAR(ramp.frequency_hz(), 0, 0.03);
  EXPECT_EQ(ramp.motion_towards(-50), Motion::kAccelerating);
  EXPECT_NEAR(ticks_to(ramp, -50, times), 4000, 2);
}

TEST(RampGenerator, LowerStopsAtItsFloorAndNeverRaises) {
  RampGenerator ramp;
  ramp.set(-2);
  ramp.lower(1, 0.5);
  EXPECT_DOUBLE_EQ(ramp.frequency_hz(), -1);
  ramp.lower(1, 0.5);
  EXPECT_DOUBLE_EQ(ramp.frequency_hz(), -0.5);
  ramp.set(0.3);
  ramp.lower(1, 0.5);
  EXPECT_DOUBLE_EQ(ramp.frequency_hz(), 0.3);
}

// The family's formula for S-curve A: t = 4/9 T/fb^2 f^2 + 5/9 T at and above the base frequency. Its printed table for
// 5 s and 60 Hz base: 5, 12, 27, 102 s to 60, 120, 200, 400 Hz.
TEST(SCurveA, TimesToFrequenciesAboveBaseFollowTheFormula) {
  for (const auto& [hz, seconds] : {std::pair{60.0, 5.0}, {120.0, 12.0}, {200.0, 27.0}, {400.0, 102.0}}) {
    RampGenerator ramp;
    const RampTimes times{.acceleration_s = 5, .s_curve_base_hz = 60, .pattern = RampPattern::kSCurveA};
    const double exact_s = 4.0 / 9 * 5 / 3600 * hz * hz + 5.0 / 9 * 5;
    const int n = ticks_to(ramp, hz, times);
    EXPECT_NEAR(n, exact_s * 1000, 2) << hz;
    EXPECT_NEAR(n * 1e-3, seconds, 0.5) << hz;
  }
}

TEST(SCurveA, HasItsSteepestSlopeAtTheBaseFrequencyWithoutAStep) {
  double last = 0, last_slope = 0;
  for (int i = 1; i <= 8000; ++i) {
    const double f = s_curve_a_frequency_hz(i * kDt, 5, 50);
    const double slope = (f - last) / kDt;
    EXPECT_GT(slope, 0);
    EXPECT_LE(slope, 9.0 / 8 * 10 + 1e-6);
    EXPECT_LT(std::abs(slope - last_slope), 0.06) << i;
    EXPECT_NEAR(s_curve_a_time_s(f, 5, 50), i * kDt, 1e-9);
    last = f;
    last_slope = slope;
  }
}

TEST(SCurveA, DecelerationMirrorsAcceleration) {
  RampGenerator up, down;
  const RampTimes times{.acceleration_s = 5, .deceleration_s = 5, .pattern = RampPattern::kSCurveA};
  down.set(80);
  const int n = ticks_to(up, 80, times);
  EXPECT_NEAR(ticks_to(down, 0, times), n, 2);
  up.set(0);
  down.set(80);
  for (int i = 0; i < 2000; ++i) up.step(kDt, 80, times);
  for (int i = 0; i < n - 2000; ++i) down.step(kDt, 0, times);
  EXPECT_NEAR(up.frequency_hz(), down.frequency_hz(), 0.03);
}

TEST(SCurveB, FollowsHalfACosineBetweenPresentAndTarget) {
  RampGenerator ramp;
  ramp.set(20);
  const RampTimes times{.acceleration_s = 5, .deceleration_s = 5, .pattern = RampPattern::kSCurveB};
  for (int i = 1; i <= 2000; ++i) {
    ramp.step(kDt, 40, times);
    const double exact = 20 + 20 * 0.5 * (1 - std::cos(std::numbers::pi * i / 2000));
    ASSERT_NEAR(ramp.frequency_hz(), exact, 1e-9) << i;
  }
  EXPECT_EQ(ramp.frequency_hz(), 40);
  EXPECT_NEAR(ticks_to(ramp, 20, times), 2000, 1);
}

TEST(SCurveB, AMovingTargetKeepsTheSlope) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 5, .pattern = RampPattern::kSCurveB};
  double last = 0, last_slope = 0;
  for (int i = 1; i <= 6000; ++i) {
    ramp.step(kDt, 50 + 0.05 * std::sin(i * 0.7), times);
    const double slope = (ramp.frequency_hz() - last) / kDt;
    if (i < 4500) {
      ASSERT_NEAR(slope, last_slope, 1.0) << i;
    }
    last = ramp.frequency_hz();
    last_slope = slope;
  }
  EXPECT_NEAR(ramp.frequency_hz(), 50, 0.2);
}

TEST(SCurveB, ATargetMovedAwayNearTheEndIsReachedInPlausibleTime) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 5, .pattern = RampPattern::kSCurveB};
  for (int i = 0; i < 1990; ++i) ramp.step(kDt, 20, times);
  EXPECT_NEAR(ticks_to(ramp, 50, times), 3000, 60);
}

TEST(SCurveB, AReversedTargetStartsANewCurve) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 5, .deceleration_s = 5, .pattern = RampPattern::kSCurveB};
  for (int i = 0; i < 2500; ++i) ramp.step(kDt, 50, times);
  EXPECT_NEAR(ramp.frequency_hz(), 25, 1e-6);
  EXPECT_NEAR(ticks_to(ramp, 5, times), 2000, 1);
}

TEST(RampGenerator, SCurveCTakesItsSTimeInAdditionAndHasNoJumpOfTheRate) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 4,
                        .deceleration_s = 2,
                        .pattern = RampPattern::kSCurveC,
                        .s_time_acceleration_s = 1,
                        .s_time_deceleration_s = 0.5};
  double last = 0;
  double last_rate = 0;
  double most = 0;
  int n = 0;
  while (ramp.frequency_hz() != 50 && n < 10000) {
    ramp.step(kDt, 50, times);
    const double rate = (ramp.frequency_hz() - last) / kDt;
    EXPECT_LT(std::abs(rate - last_rate), 0.1) << n;  // 12.5 Hz/s within a second
    most = std::max(most, rate);
    last = ramp.frequency_hz();
    last_rate = rate;
    ++n;
  }
  EXPECT_NEAR(n, 5000, 2);
  EXPECT_NEAR(most, 12.5, 0.01);
  EXPECT_NEAR(ticks_to(ramp, 0, times), 2500, 2);
}

TEST(RampGenerator, BacklashStopsOnTheWayUpAndOnTheWayDown) {
  RampGenerator ramp;
  const RampTimes times{.acceleration_s = 5,
                        .deceleration_s = 5,
                        .pattern = RampPattern::kBacklash,
                        .hold_up_hz = 3,
                        .hold_up_s = 0.5,
                        .hold_down_hz = 2,
                        .hold_down_s = 0.25};
  int held = 0;
  for (int i = 0; i < 5505; ++i) {
    ramp.step(kDt, 50, times);
    held += ramp.frequency_hz() == 3 ? 1 : 0;
  }
  EXPECT_EQ(ramp.frequency_hz(), 50);
  EXPECT_NEAR(held, 501, 2);
  held = 0;
  for (int i = 0; i < 5305; ++i) {
    ramp.step(kDt, 0, times);
    held += ramp.frequency_hz() == 2 ? 1 : 0;
  }
  EXPECT_EQ(ramp.frequency_hz(), 0);
  EXPECT_NEAR(held, 251, 2);
  // In the other direction the same.
  held = 0;
  for (int i = 0; i < 1500; ++i) {
    ramp.step(kDt, -50, times);
    held += ramp.frequency_hz() == -3 ? 1 : 0;
  }
  EXPECT_NEAR(held, 501, 2);
}

}  // namespace
}  // namespace vinv::drive
