#include "motor_model/drive/pid.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kDt = 0.001;

double run(Pid& pid, const PidSettings& s, double set, double measured, int ms) {
  double out = 0;
  for (int i = 0; i < ms; ++i) out = pid.step(kDt, s, set, measured);
  return out;
}

TEST(Pid, ProportionalBandIsTheDeviationForFullOutput) {
  Pid pid;
  PidSettings s{.proportional_band_percent = 50, .integral_s = 0};
  EXPECT_NEAR(pid.step(kDt, s, 30, 10), 40, 1e-9);
  EXPECT_NEAR(pid.step(kDt, s, 30, 30), 0, 1e-9);
  EXPECT_NEAR(pid.step(kDt, s, 90, 10), 100, 1e-9);
  s.action = PidAction::kForward;
  EXPECT_NEAR(pid.step(kDt, s, 10, 30), 40, 1e-9);
  EXPECT_NEAR(pid.step(kDt, s, 30, 10), 0, 1e-9);
}

TEST(Pid, IntegralTimeRepeatsTheProportionalPart) {
  Pid pid;
  const PidSettings s{.proportional_band_percent = 100, .integral_s = 2};
  EXPECT_NEAR(run(pid, s, 30, 20, 1), 10, 0.01);
  EXPECT_NEAR(run(pid, s, 30, 20, 2000), 20, 0.02);
}

TEST(Pid, WithoutProportionalBandTheIntegralActsAlone) {
  Pid pid;
  const PidSettings s{.proportional_band_percent = 0, .integral_s = 2};
  EXPECT_NEAR(run(pid, s, 30, 20, 2000), 10, 0.02);
}

TEST(Pid, DerivativeActsOnTheMeasuredRateNotOnTheSetPoint) {
  const PidSettings s{.proportional_band_percent = 100, .integral_s = 0, .derivative_s = 0.5};
  Pid pid;
  double out = 0;
  for (int i = 0; i < 1000; ++i) out = pid.step(kDt, s, 50, 10 * i * kDt);  // rises by 10 %/s
  EXPECT_NEAR(out, 50 - 10 - 5, 0.1);
  Pid kick;
  run(kick, s, 20, 20, 10);
  EXPECT_NEAR(kick.step(kDt, s, 60, 20), 40, 1e-9);
}

TEST(Pid, DoesNotWindUpAtItsLimit) {
  Pid pid;
  const PidSettings s{.proportional_band_percent = 100, .integral_s = 1};
  EXPECT_EQ(run(pid, s, 80, 0, 60'000), 100);
  // After a minute at the limit the output leaves it as soon as the deviation changes sign.
  EXPECT_LT(run(pid, s, 80, 90, 1), 100);
  EXPECT_EQ(run(pid, s, 0, 90, 60'000), 0);
  EXPECT_GT(run(pid, s, 20, 10, 20), 0);
}

TEST(Pid, TakesOverFromATrackedOutputWithoutAStep) {
  Pid pid;
  const PidSettings s{.proportional_band_percent = 50, .integral_s = 5};
  pid.track(42);
  EXPECT_NEAR(pid.step(kDt, s, 50, 30), 42, 0.1);
  EXPECT_GT(run(pid, s, 50, 30, 1000), 45);
}

TEST(Pid, RetuningDoesNotStepTheOutput) {
  Pid pid;
  PidSettings s{.proportional_band_percent = 100, .integral_s = 5, .derivative_s = 0.2};
  const double before = run(pid, s, 50, 30, 1000);
  s.proportional_band_percent = 20;
  EXPECT_NEAR(run(pid, s, 50, 30, 1), before, 0.1);
  const double later = run(pid, s, 50, 30, 100);
  s.integral_s = 1;
  EXPECT_NEAR(run(pid, s, 50, 30, 1), later, 0.2);
}

TEST(Pid, MeasuredValueLimitsSetTheirOutputs) {
  Pid pid;
  const PidSettings s{.upper_limit_percent = 80, .lower_limit_percent = 20};
  pid.step(kDt, s, 50, 81);
  EXPECT_TRUE(pid.above_upper_limit());
  EXPECT_FALSE(pid.below_lower_limit());
  pid.step(kDt, s, 50, 19);
  EXPECT_FALSE(pid.above_upper_limit());
  EXPECT_TRUE(pid.below_lower_limit());
  pid.step(kDt, s, 50, 50);
  EXPECT_FALSE(pid.above_upper_limit() || pid.below_lower_limit());
}

TEST(Pid, SettlesAFirstOrderProcessAtItsSetPoint) {
  Pid pid;
  const PidSettings s{.proportional_band_percent = 50, .integral_s = 1, .derivative_s = 0.05};
  double measured = 0;
  for (int i = 0; i < 30'000; ++i) measured += (pid.step(kDt, s, 60, measured) * 0.9 - measured) * kDt / 2;
  EXPECT_NEAR(measured, 60, 0.01);
  EXPECT_NEAR(pid.output_percent(), 60 / 0.9, 0.05);
}

}  // namespace
}  // namespace vinv::drive
