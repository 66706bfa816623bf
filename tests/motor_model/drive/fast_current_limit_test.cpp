#include "motor_model/drive/fast_current_limit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "motor_model/drive/protections.hpp"

namespace vinv::drive {
namespace {

// Locked motor as a winding: the current follows voltage/impedance with a lag of 8 ms.
struct Winding {
  double full_voltage_a_peak;
  double a = 0;
  double highest_a = 0;
  void advance(double factor) {
    for (int i = 0; i < 10; ++i) {
      a += (full_voltage_a_peak * factor - a) * 1e-4 / 8e-3;
      highest_a = std::max(highest_a, a);
    }
  }
};

TEST(FastCurrentLimit, KeepsASuddenVoltageBelowTheOverCurrentLevel) {
  DriveSettings s;
  s.rated_current_a_rms = 4;
  const double trip = over_current_level_a_peak(s);
  EXPECT_NEAR(trip, 2 * std::sqrt(2.0) * 4, 1e-9);
  for (const double times : {1.2, 1.5, 2.0, 2.5}) {
    Winding with{trip * times}, without{trip * times};
    FastCurrentLimit limit;
    for (int i = 0; i < 500; ++i) {
      with.advance(limit.step(0.001, s, with.a, with.a));
      without.advance(1);
    }
    EXPECT_GT(without.highest_a, trip) << times;
    EXPECT_LT(with.highest_a, trip) << times;
    EXPECT_GT(with.a, 0.6 * trip) << times;
  }
}

TEST(FastCurrentLimit, GivesTheVoltageBackWhenTheCurrentIsLow) {
  DriveSettings s;
  s.rated_current_a_rms = 4;
  FastCurrentLimit limit;
  for (int i = 0; i < 20; ++i) limit.step(0.001, s, 11, 5);
  EXPECT_LT(limit.step(0.001, s, 11, 5), 0.5);
  double factor = 0;
  for (int i = 0; i < 50; ++i) factor = limit.step(0.001, s, 2, 2);
  EXPECT_EQ(factor, 1);
}

TEST(FastCurrentLimit, LeavesARegeneratingMotorAndADisabledLimitAlone) {
  DriveSettings s;
  s.rated_current_a_rms = 4;
  FastCurrentLimit limit;
  EXPECT_EQ(limit.step(0.001, s, 11, -5), 1);
  s.fast_current_limit = false;
  EXPECT_EQ(limit.step(0.001, s, 11, 5), 1);
}

}  // namespace
}  // namespace vinv::drive
