// Control supervisor and speeds of the AC drive profile.
#include <gtest/gtest.h>

#include "option_boards/cip/profile/control_supervisor.hpp"
#include "option_boards/cip/profile/speed_scale.hpp"

namespace vinv::cip {
namespace {

// OPC-E11S-DEV manual, 4.7: run/stop event matrix.
TEST(CipControlSupervisor, RunStopEventMatrix) {
  constexpr RunSignals kStop{}, kForward{true, false}, kReverse{false, true}, kBoth{true, true};
  const auto edges = [](RunSignals before, RunSignals now, RunSignals acting) {
    return run_signals(RunStyle::kEdges, before, now, acting);
  };
  EXPECT_EQ(edges(kForward, kStop, kForward), kStop);
  EXPECT_EQ(edges(kStop, kForward, kStop), kForward);
  EXPECT_EQ(edges(kStop, kReverse, kStop), kReverse);
  EXPECT_EQ(edges(kStop, kBoth, kStop), kStop);
  EXPECT_EQ(edges(kBoth, kBoth, kStop), kStop);
  EXPECT_EQ(edges(kBoth, kReverse, kStop), kReverse);
  EXPECT_EQ(edges(kBoth, kForward, kStop), kForward);
  EXPECT_EQ(edges(kForward, kBoth, kForward), kForward);
  EXPECT_EQ(run_signals(RunStyle::kLevels, kStop, kBoth, kStop), kBoth);
}

TEST(CipControlSupervisor, FaultResetActsOnTheRisingEdge) {
  FaultResetEdge reset;
  EXPECT_FALSE(reset.write(false));
  EXPECT_TRUE(reset.write(true));
  EXPECT_FALSE(reset.write(true));
  EXPECT_TRUE(reset.value());
  EXPECT_FALSE(reset.write(false));
  EXPECT_TRUE(reset.write(true));
}

TEST(CipSpeedScale, RoundsToTheNearest) {
  const SpeedScale four = SpeedScale::of_poles(4);
  EXPECT_EQ(four.speed_of(5000), 1500);
  EXPECT_EQ(four.speed_of(1), 0);
  EXPECT_EQ(four.speed_of(2), 1);
  EXPECT_EQ(four.speed_of(-5000), -1500);
  EXPECT_EQ(four.frequency_of(100), 333);
  EXPECT_EQ(SpeedScale::of_machine(1000, 6000).speed_of(3000), 500);
}

}  // namespace
}  // namespace vinv::cip
