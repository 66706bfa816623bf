#include "motor_model/drive/stall_prevention.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vinv::drive {
namespace {

DriveSettings four_amps() {
  DriveSettings s;
  s.rated_current_a_rms = 4;  // 150 %: 6 A
  return s;
}

constexpr double kRamp_hz_s = 25;

struct Held {
  Motion motion = Motion::kAccelerating;
  double current_a = 0;
  double active_a = 0;  // 0: nearly all of it, with the sign that belongs to the motion
  double frequency_hz = 30;
  double dc_link_v = 566;
  double voltage_factor = 1;
};

// The decision after the current has stood for a while.
StallPrevention::Decision hold(StallPrevention& stall, const DriveSettings& s, const Held& h, int ms = 400) {
  StallPrevention::Decision d;
  const double sign = h.motion == Motion::kDecelerating ? -1 : 1;
  for (int i = 0; i < ms; ++i) {
    stall.observe(0.001, s,
                  {.output = {.current_a_rms = h.current_a,
                              .active_current_a_rms = h.active_a != 0 ? h.active_a : sign * 0.9 * h.current_a,
                              .phase_voltage_v_rms = 100},
                   .voltage_factor = h.voltage_factor});
    d = stall.step(0.001, s,
                   {.motion = h.motion,
                    .frequency_hz = h.frequency_hz,
                    .acceleration_hz_s = kRamp_hz_s,
                    .deceleration_hz_s = kRamp_hz_s,
                    .dc_link_v = h.dc_link_v});
  }
  return d;
}

bool follows(const StallPrevention::Decision& d) { return std::isinf(d.most_hz_s); }

TEST(StallPrevention, AnAccelerationBelowTheLevelIsLeftAlone) {
  StallPrevention stall;
  const auto d = hold(stall, four_amps(), {.current_a = 5});
  EXPECT_TRUE(follows(d));
  EXPECT_FALSE(d.active);
  EXPECT_EQ(d.level_a_rms, 6);
}

TEST(StallPrevention, AnAccelerationAboveTheLevelIsSlowedThenTakenBackThenGivenBack) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  hold(stall, s, {.current_a = 5});
  double before = kRamp_hz_s;
  for (int i = 0; i < 5; ++i) {
    const auto d = hold(stall, s, {.current_a = 6.6}, 20);
    EXPECT_LT(d.most_hz_s, before) << i;
    before = d.most_hz_s;
  }
  auto d = hold(stall, s, {.current_a = 7.5});
  EXPECT_EQ(d.most_hz_s, -kRamp_hz_s);
  EXPECT_TRUE(d.active);
  d = hold(stall, s, {.current_a = 5.5}, 20);
  EXPECT_GT(d.most_hz_s, -kRamp_hz_s);
  EXPECT_TRUE(d.active);  // still slowed
  d = hold(stall, s, {.current_a = 4});
  EXPECT_TRUE(follows(d));
  EXPECT_FALSE(d.active);
}

TEST(StallPrevention, AtTheLevelTheRateStandsWhereItIs) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  hold(stall, s, {.current_a = 6.3}, 100);
  const double rate = hold(stall, s, {.current_a = 6}, 100).most_hz_s;
  EXPECT_NEAR(hold(stall, s, {.current_a = 6}, 1000).most_hz_s, rate, 0.1);
  EXPECT_LT(std::abs(rate), kRamp_hz_s);
}

TEST(StallPrevention, AConstantSpeedIsLoweredAlongTheDecelerationRampAndGivenBack) {
  StallPrevention stall;
  const DriveSettings s = four_amps();
  hold(stall, s, {.motion = Motion::kConstant, .current_a = 4});
  auto d = hold(stall, s, {.motion = Motion::kConstant, .current_a = 7.5});
  EXPECT_EQ(d.most_hz_s, -kRamp_hz_s);
  EXPECT_TRUE(d.active);
  d = hold(stall, s, {.motion = Motion::kConstant, .current_a = 4}, 1000);
  EXPECT_TRUE(follows(d));
  EXPECT_FALSE(d.active);
}

TEST(StallPrevention, DecelerationIsHeldOnCurrentAndWhereFittedOnTheLink) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  auto d = hold(stall, s, {.motion = Motion::kDecelerating, .current_a = 7});
  EXPECT_EQ(d.most_hz_s, 0);
  EXPECT_TRUE(d.active);
  EXPECT_TRUE(follows(hold(stall, s, {.motion = Motion::kDecelerating, .current_a = 5, .dc_link_v = 790})));
  s.dc_link_hold_v = 760;
  d = hold(stall, s, {.motion = Motion::kDecelerating, .current_a = 5, .dc_link_v = 790});
  EXPECT_EQ(d.most_hz_s, 0);
  EXPECT_TRUE(d.active);
  EXPECT_TRUE(follows(hold(stall, s, {.motion = Motion::kAccelerating, .current_a = 5, .dc_link_v = 790})));
}

TEST(StallPrevention, AMotoringCurrentDoesNotHoldADeceleration) {
  StallPrevention stall;
  const auto d = hold(stall, four_amps(), {.motion = Motion::kDecelerating, .current_a = 7, .active_a = 6});
  EXPECT_TRUE(follows(d));
  EXPECT_FALSE(d.active);
}

TEST(StallPrevention, ABrakingCurrentDoesNotLowerAnAcceleration) {
  StallPrevention stall;
  EXPECT_TRUE(follows(hold(stall, four_amps(), {.current_a = 7, .active_a = -3})));
}

// 10 ohm take 0.7 of 1 A of active current at 100 V: the motor brakes although it takes power.
TEST(StallPrevention, TheStatorResistanceCountsForTheSignOfTheTorque) {
  DriveSettings s = four_amps();
  s.motor_stator_ohm = 10;
  StallPrevention with;
  EXPECT_TRUE(follows(hold(with, s, {.current_a = 7, .active_a = 3})));
  s.motor_stator_ohm = 0;
  StallPrevention without;
  EXPECT_LT(hold(without, s, {.current_a = 7, .active_a = 3}).most_hz_s, 0);
}

TEST(StallPrevention, WhatTheFastLimitHidesCounts) {
  StallPrevention stall;
  const auto d = hold(stall, four_amps(), {.current_a = 5.5, .voltage_factor = 0.8});
  EXPECT_LT(d.most_hz_s, 0);
  EXPECT_TRUE(d.active);
}

TEST(StallPrevention, EachStateMayBeExcluded) {
  DriveSettings s = four_amps();
  s.stall_in_acceleration = false;
  s.stall_at_constant = false;
  s.stall_in_deceleration = false;
  for (const Motion m : {Motion::kAccelerating, Motion::kConstant, Motion::kDecelerating}) {
    StallPrevention stall;
    const auto d = hold(stall, s, {.motion = m, .current_a = 9});
    EXPECT_TRUE(follows(d));
    EXPECT_FALSE(d.active);
  }
  s.stall_at_constant = true;
  StallPrevention stall;
  EXPECT_LT(hold(stall, s, {.motion = Motion::kConstant, .current_a = 9}).most_hz_s, 0);
}

TEST(StallPrevention, LevelZeroIsOff) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  s.stall_level_percent = 0;
  EXPECT_TRUE(follows(hold(stall, s, {.motion = Motion::kConstant, .current_a = 20})));
}

TEST(StallPrevention, AMagnetisingTransientDoesNotAct) {
  StallPrevention stall;
  // 200 % for 8 ms.
  const auto d = hold(stall, four_amps(), {.current_a = 8, .frequency_hz = 0.5}, 8);
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
  Held h{.motion = Motion::kConstant, .current_a = 6.5, .frequency_hz = 0.6};
  EXPECT_FALSE(hold(stall, s, h, 10'000).trip);
  h.frequency_hz = 0.5;
  EXPECT_FALSE(hold(stall, s, h, 3000).trip);
  EXPECT_TRUE(hold(stall, s, h, 1).trip);
}

TEST(StallPrevention, TripsAtOnceWhereSoSet) {
  StallPrevention stall;
  DriveSettings s = four_amps();
  s.stall_trips_at_once = true;
  EXPECT_FALSE(hold(stall, s, {.motion = Motion::kConstant, .current_a = 5.9}).trip);
  EXPECT_TRUE(hold(stall, s, {.motion = Motion::kConstant, .current_a = 6.5, .frequency_hz = 40}).trip);
}

TEST(StallPrevention, AHeldDecelerationAtHalfAHertzIsNoStallTrip) {
  StallPrevention stall;
  const auto d =
      hold(stall, four_amps(), {.motion = Motion::kDecelerating, .current_a = 7, .frequency_hz = 0.5}, 10'000);
  EXPECT_TRUE(d.active);
  EXPECT_FALSE(d.trip);
}

}  // namespace
}  // namespace vinv::drive
