// ISO 11898-1, fault confinement.
#include "sim/transports/can/error_counters.hpp"

#include <gtest/gtest.h>

namespace vinv::transports {
namespace {

TEST(CanErrorCounters, StatesFollowTheLevels) {
  CanErrorCounters c;
  EXPECT_EQ(c.state(), CanState::kErrorActive);
  c.tec = 95;
  EXPECT_EQ(c.state(), CanState::kErrorActive);
  c.tec = 96;
  EXPECT_EQ(c.state(), CanState::kErrorWarning);
  c.tec = 127;
  EXPECT_EQ(c.state(), CanState::kErrorWarning);
  c.tec = 128;
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  c.tec = 255;
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  c.tec = 256;
  EXPECT_EQ(c.state(), CanState::kBusOff);
}

TEST(CanErrorCounters, AReceiverBecomesPassiveButNeverBusOff) {
  CanErrorCounters c;
  for (int i = 0; i < 128; ++i) c.on_receive_error();
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  for (int i = 0; i < 1000; ++i) c.on_receive_error();
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  c.on_received();
  EXPECT_EQ(c.rec, 127);
  EXPECT_EQ(c.state(), CanState::kErrorWarning);
  for (int i = 0; i < 127; ++i) c.on_received();
  EXPECT_EQ(c.rec, 0);
  c.on_received();
  EXPECT_EQ(c.rec, 0);
}

TEST(CanErrorCounters, ThirtyTwoFailedFramesInARowMeanBusOff) {
  CanErrorCounters c;
  for (int i = 0; i < 31; ++i) c.on_transmit_error();
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  c.on_transmit_error();
  EXPECT_EQ(c.state(), CanState::kBusOff);
}

TEST(CanErrorCounters, MissingAcknowledgesEndAtErrorPassive) {
  CanErrorCounters c;
  for (int i = 0; i < 1000; ++i) c.on_no_acknowledge();
  EXPECT_EQ(c.tec, 128);
  EXPECT_EQ(c.state(), CanState::kErrorPassive);
  c.on_transmitted();
  EXPECT_EQ(c.tec, 127);
}

}  // namespace
}  // namespace vinv::transports
