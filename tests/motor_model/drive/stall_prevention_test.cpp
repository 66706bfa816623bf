#include "motor_model/drive/stall_prevention.hpp"

#include <gtest/gtest.h>

namespace vinv::drive {
namespace {

DriveSettings four_amps() {
  DriveSettings s;
  s.rated_current_a_rms = 4;  // 150 %: 6 A
  return s;
}

StallPrevention::Decision settle(StallPrevention& stall, const DriveSettings& s, Motion motion, double a,
                                 double hz = 30, double link_v = 566, int ms = 200, bool regenerating = true) {
  StallPrevention::Decision d;
  for (int i = 0; i < ms; ++i) {
    stall.observe(0.001, a);
    d = stall.step(0.001, s, {motion, hz, regenerating, link_v});
  }
  return d;
}

TEST(StallPrevention, AccelerationIsHeldJustAboveTheLevelAndTakenBackBeyond) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  auto d = settle(stall, s, Motion::kAccelerating, 5.9);
  EXPECT_EQ(d.action, RampAction::kFollow);
  EXPECT_FALSE(d.active);
  d = settle(stall, s, Motion::kAccelerating, 6.2);
  EXPECT_EQ(d.action, RampAction::kHold);
  EXPECT_TRUE(d.active);
  d = settle(stall, s, Motion::kAccelerating, 6.4);
  EXPECT_EQ(d.action, RampAction::kLower);
  d = settle(stall, s, Motion::kAccelerating, 5.9);
  EXPECT_EQ(d.action, RampAction::kFollow);
  EXPECT_TRUE(d.active);  // until it has recovered
  d = settle(stall, s, Motion::kAccelerating, 5.8);
  EXPECT_FALSE(d.active);
}

TEST(StallPrevention, ConstantSpeedIsLoweredThenHeldThenGivenBack) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 6.05).action, RampAction::kLower);
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 5.9).action, RampAction::kHold);
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 5.8).action, RampAction::kFollow);
}

TEST(StallPrevention, DecelerationIsHeldOnCurrentAndWhereFittedOnTheLink) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  EXPECT_EQ(settle(stall, s, Motion::kDecelerating, 6.5).action, RampAction::kHold);
  EXPECT_EQ(settle(stall, s, Motion::kDecelerating, 5, 30, 790).action, RampAction::kFollow);
  s.dc_link_hold_v = 760;
  const auto d = settle(stall, s, Motion::kDecelerating, 5, 30, 790);
  EXPECT_EQ(d.action, RampAction::kHold);
  EXPECT_TRUE(d.active);
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 5, 30, 790).action, RampAction::kFollow);
}

TEST(StallPrevention, AMotoringCurrentDoesNotHoldADeceleration) {
  StallPrevention stall;
  const auto d = settle(stall, four_amps(), Motion::kDecelerating, 6.5, 30, 566, 200, false);
  EXPECT_EQ(d.action, RampAction::kFollow);
  EXPECT_FALSE(d.active);
}

TEST(StallPrevention, EachStateMayBeExcluded) {
  DriveSettings s = four_amps();
  s.stall_in_acceleration = false;
  s.stall_at_constant = false;
  s.stall_in_deceleration = false;
  for (const Motion m : {Motion::kAccelerating, Motion::kConstant, Motion::kDecelerating}) {
    StallPrevention stall;
    const auto d = settle(stall, s, m, 9);
    EXPECT_EQ(d.action, RampAction::kFollow);
    EXPECT_FALSE(d.active);
  }
  s.stall_at_constant = true;
  StallPrevention stall;
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 9).action, RampAction::kLower);
}

TEST(StallPrevention, LevelZeroIsOff) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  s.stall_level_percent = 0;
  EXPECT_EQ(settle(stall, s, Motion::kConstant, 20).action, RampAction::kFollow);
}

TEST(StallPrevention, AMagnetisingTransientDoesNotAct) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  // 200 % for 8 ms.
  const auto d = settle(stall, s, Motion::kAccelerating, 8, 0.5, 566, 8);
  EXPECT_FALSE(d.active);
}

// Level formula of the family: A + B (L - A)/(L - B) (k - 100)/100, A = fs L/f, B = fs L/400.
TEST(StallPrevention, LevelAboveTheStartFrequencyFollowsTheCompensationFactor) {
  DriveSettings s = four_amps();
  EXPECT_EQ(stall_level_percent(s, 400), 150);
  s.stall_compensated = true;
  s.stall_reduction_start_hz = 50;
  s.stall_level_double_speed_percent = 100;
  EXPECT_EQ(stall_level_percent(s, 50), 150);
  EXPECT_NEAR(stall_level_percent(s, 100), 75, 1e-9);
  EXPECT_NEAR(stall_level_percent(s, 400), 18.75, 1e-9);
  s.stall_level_double_speed_percent = 200;
  EXPECT_NEAR(stall_level_percent(s, 100), 75 + 18.75 * 75 / 131.25, 1e-9);
  EXPECT_NEAR(stall_level_percent(s, 400), 37.5, 1e-9);
  s.stall_level_double_speed_percent = 0;
  EXPECT_NEAR(stall_level_percent(s, 400), 1, 1e-9);  // reduced is not off
  s.stall_reduction_start_hz = 0;
  EXPECT_GE(stall_level_percent(s, 10), 1);
}

TEST(StallPrevention, TripsAfterThreeSecondsAtHalfAHertz) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  EXPECT_FALSE(settle(stall, s, Motion::kConstant, 6.5, 0.6, 566, 10'000).trip);
  EXPECT_FALSE(settle(stall, s, Motion::kConstant, 6.5, 0.5, 566, 3000).trip);
  EXPECT_TRUE(settle(stall, s, Motion::kConstant, 6.5, 0.5, 566, 1).trip);
}

TEST(StallPrevention, TripsAtOnceWhereSoSet) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  s.stall_trips_at_once = true;
  EXPECT_FALSE(settle(stall, s, Motion::kConstant, 5.9).trip);
  EXPECT_TRUE(settle(stall, s, Motion::kConstant, 6.5, 40).trip);
}

TEST(StallPrevention, AHeldDecelerationAtHalfAHertzIsNoStallTrip) {
  StallPrevention stall;
  const auto d = settle(stall, four_amps(), Motion::kDecelerating, 6.5, 0.5, 566, 10'000);
  EXPECT_TRUE(d.active);
  EXPECT_FALSE(d.trip);
}

}  // namespace
}  // namespace vinv::drive
