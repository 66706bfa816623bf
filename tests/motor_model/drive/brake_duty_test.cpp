#include "motor_model/drive/brake_duty.hpp"

#include <gtest/gtest.h>

namespace vinv::drive {
namespace {

int ms_until(BrakeDuty& duty, bool permits, bool chopper_on, double percent, int limit_ms = 100'000) {
  for (int i = 1; i <= limit_ms; ++i) {
    duty.step(0.001, chopper_on, percent);
    if (duty.permits() == permits) return i;
  }
  return -1;
}

TEST(BrakeDuty, ContinuousBrakingUsesUpTheBudgetOfTheWindow) {
  BrakeDuty duty;
  EXPECT_NEAR(ms_until(duty, false, true, 3), 3000 / 0.97, 2);  // it refills at 3 % meanwhile
  EXPECT_NEAR(duty.fraction(), 1, 1e-6);
}

TEST(BrakeDuty, TheBudgetRefillsAtThePermittedDuty) {
  BrakeDuty duty;
  ms_until(duty, false, true, 10);
  EXPECT_NEAR(ms_until(duty, true, false, 10), 10'000, 2);  // a tenth of the window
  EXPECT_NEAR(duty.fraction(), 0.9, 1e-3);
}

TEST(BrakeDuty, BrakingAtThePermittedDutyGoesOnForever) {
  BrakeDuty duty;
  for (int i = 0; i < 500'000; ++i) {
    duty.step(0.001, i % 100 < 3, 3);
    ASSERT_TRUE(duty.permits()) << i;
  }
  EXPECT_LT(duty.fraction(), 0.05);
}

TEST(BrakeDuty, NoDutyPermitsNothing) {
  BrakeDuty duty;
  duty.step(0.001, false, 0);
  EXPECT_FALSE(duty.permits());
  duty.step(0.001, false, 3);
  EXPECT_TRUE(duty.permits());
}

}  // namespace
}  // namespace vinv::drive
