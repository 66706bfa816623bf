#include "motor_model/drive/frequency_limits.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace vinv::drive {
namespace {

TEST(FrequencyLimits, MinimumAndMaximumClampTheReference) {
  DriveSettings s;
  s.max_frequency_hz = 60;
  s.min_frequency_hz = 10;
  EXPECT_EQ(limited_reference_hz(s, 70), 60);
  EXPECT_EQ(limited_reference_hz(s, 30), 30);
  EXPECT_EQ(limited_reference_hz(s, 0), 10);
  EXPECT_EQ(limited_reference_hz(s, -5), 10);
  s.max_frequency_hz = 5;
  EXPECT_EQ(limited_reference_hz(s, 30), 5);
}

TEST(FrequencyLimits, AReferenceInAJumpBandTakesTheJumpFrequencyRisingAndFalling) {
  DriveSettings s;
  s.jump_bands[0] = {30, 35, 35};  // 1A = 35, 1B = 30
  s.jump_bands[2] = {50, 55, 50};  // 3A = 50, 3B = 55
  double last = -1;
  for (int i = 0; i < 2900; ++i) {
    const double f = 28.005 + i * 0.01;
    const double got = limited_reference_hz(s, f);
    const double expected = f > 30 && f < 35 ? 35 : f > 50 && f < 55 ? 50 : f;
    EXPECT_EQ(got, expected) << f;
    EXPECT_GE(got, last);
    last = got;
  }
  EXPECT_EQ(limited_reference_hz(s, 32), 35);
  EXPECT_EQ(limited_reference_hz(s, 30), 30);
}

TEST(FrequencyLimits, TheMaximumWinsOverAJumpFrequency) {
  DriveSettings s;
  s.max_frequency_hz = 33;
  s.jump_bands[1] = {30, 35, 35};
  EXPECT_EQ(limited_reference_hz(s, 31), 33);
}

TEST(FrequencyLimits, ABandWithoutWidthIsOff) {
  DriveSettings s;
  s.jump_bands[0] = {35, 30, 40};
  EXPECT_EQ(limited_reference_hz(s, 32), 32);
}

TEST(FrequencyLimits, AReferenceThatIsNotANumberIsZero) {
  EXPECT_EQ(limited_reference_hz(DriveSettings{}, std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace vinv::drive
