// Frequency and speed: FR-A7NE manual 4.7, every combination of Pr.37 and Pr.144.
#include <gtest/gtest.h>

#include <string>

#include "motor_model/port/speed_conversion.hpp"

namespace vinv::port {
namespace {

using Unit = SpeedConversion::Unit;

TEST(SpeedConversion, UnitsFollowPr37AndPr144) {
  for (std::uint32_t pr144 : {0u, 2u, 4u, 6u, 8u, 10u, 102u, 104u, 106u, 108u, 110u}) {
    for (std::uint32_t pr37 : {0u, 1u, 1800u, 9998u}) {
      const SpeedConversion c{pr37, pr144, 60};
      SCOPED_TRACE(std::to_string(pr37) + " " + std::to_string(pr144));
      const bool hundreds = pr144 > 100;
      EXPECT_EQ(c.running_unit(), pr37 == 0 || hundreds ? Unit::kRpm : Unit::kMachineSpeed);
      EXPECT_EQ(c.frequency_unit(true), Unit::kHertz);
      const Unit bare = pr37 == 0 && hundreds                  ? Unit::kRpm
                        : pr37 != 0 && !hundreds && pr144 != 0 ? Unit::kMachineSpeed
                                                               : Unit::kHertz;
      EXPECT_EQ(c.frequency_unit(false), bare);
      EXPECT_EQ(c.poles(), pr144 == 0 ? 4 : pr144 % 100);
    }
  }
}

TEST(SpeedConversion, FollowsTheFormulasBothWays) {
  const SpeedConversion four{0, 4, 60};
  EXPECT_DOUBLE_EQ(four.rpm(60), 1800);
  EXPECT_DOUBLE_EQ(four.hz_of_rpm(1500), 50);
  EXPECT_DOUBLE_EQ((SpeedConversion{0, 106, 60}.rpm(60)), 1200);
  const SpeedConversion machine{500, 4, 50};
  EXPECT_DOUBLE_EQ(machine.machine_speed(25), 250);
  EXPECT_DOUBLE_EQ(machine.hz_of_machine_speed(250), 25);
  EXPECT_DOUBLE_EQ(machine.in_unit(25, Unit::kMachineSpeed), 250);
  EXPECT_DOUBLE_EQ(machine.in_unit(25, Unit::kHertz), 25);
  EXPECT_DOUBLE_EQ(machine.in_unit(25, Unit::kRpm), 750);
}

}  // namespace
}  // namespace vinv::port
