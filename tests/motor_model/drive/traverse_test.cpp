#include "motor_model/drive/traverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace vinv::drive {
namespace {

constexpr double kDt = 0.001;

TEST(Traverse, SwingsByTheAmplitudeInTheSetTimes) {
  Traverse t;
  const TraverseSettings s{.amplitude = 0.1, .up_s = 2, .down_s = 1};
  double low = 100;
  double high = 0;
  int rising = 0;
  int falling = 0;
  double last = 40;
  for (int i = 0; i < 7000; ++i) {
    const double f = t.step(kDt, s, 40);
    low = std::min(low, f);
    high = std::max(high, f);
    // After the first half way: two whole swings of 3 s.
    if (i >= 1000) (f > last ? rising : falling)++;
    last = f;
  }
  EXPECT_NEAR(high, 44, 0.01);
  EXPECT_NEAR(low, 36, 0.01);
  EXPECT_NEAR(rising, 4000, 5);
  EXPECT_NEAR(falling, 2000, 5);
}

TEST(Traverse, DipsWhereAWayBegins) {
  Traverse t;
  const TraverseSettings s{.amplitude = 0.1, .dip_down = 0.5, .dip_up = 0.25, .up_s = 2, .down_s = 2};
  double step_down = 0;
  double step_up = 0;
  double last = 40;
  for (int i = 0; i < 8000; ++i) {
    const double f = t.step(kDt, s, 40);
    step_down = std::min(step_down, f - last);
    step_up = std::max(step_up, f - last);
    last = f;
  }
  EXPECT_NEAR(step_down, -2, 0.02);  // half of 4 Hz
  EXPECT_NEAR(step_up, 1, 0.02);     // a quarter of it
}

TEST(Traverse, BeginsAnewAtTheSetFrequency) {
  Traverse t;
  const TraverseSettings s{.amplitude = 0.2, .up_s = 1, .down_s = 1};
  for (int i = 0; i < 400; ++i) t.step(kDt, s, 50);
  t.reset();
  EXPECT_NEAR(t.step(kDt, s, 50), 50, 0.1);
}

}  // namespace
}  // namespace vinv::drive
