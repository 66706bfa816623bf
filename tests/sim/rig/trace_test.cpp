// Tables over time that a run is compared with.
#include "sim/rig/trace.hpp"

#include <gtest/gtest.h>

namespace vinv::rig {
namespace {

TEST(Trace, ReadsCommentsHeaderAndRows) {
  const auto t = parse_trace(
      "# where from\r\ntime_s,speed rpm,fan.torque Nm,run_state\r\n0,0,1,2\r\n0.5,100,3,2\r\n2,400,0,2\r\n");
  ASSERT_TRUE(t.has_value()) << t.error();
  ASSERT_EQ(t->columns.size(), 3u);
  const Trace::Column* speed = t->find("speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_EQ(speed->unit, "rpm");
  EXPECT_EQ(t->find("fan.torque")->unit, "Nm");
  EXPECT_EQ(t->find("run_state")->unit, "");
  EXPECT_EQ(t->find("torque"), nullptr);
  EXPECT_EQ(t->at(*speed, 0), 0);
  EXPECT_DOUBLE_EQ(t->at(*speed, 0.25), 50);
  EXPECT_DOUBLE_EQ(t->at(*speed, 0.5), 100);
  EXPECT_DOUBLE_EQ(t->at(*speed, 1), 200);
  EXPECT_DOUBLE_EQ(t->at(*speed, 2), 400);
  EXPECT_TRUE(t->covers(0));
  EXPECT_TRUE(t->covers(2));
  EXPECT_FALSE(t->covers(2.001));
}

TEST(Trace, WhatIsNoTableIsRefusedWithItsLine) {
  const auto error = [](const char* text) {
    const auto t = parse_trace(text);
    return t ? std::string("accepted") : t.error();
  };
  EXPECT_EQ(error(""), "has fewer than two rows.");
  EXPECT_EQ(error("speed rpm,time_s\n0,0\n"), "has no header that begins with \"time_s\".");
  EXPECT_EQ(error("time_s,a V,a V\n"), "has two columns \"a\".");
  EXPECT_EQ(error("time_s,a V\n0,1\n1,1,1\n"), "line 3 has 3 fields, the header 2.");
  EXPECT_EQ(error("time_s,a V\n0,1\n0,1\n"), "line 3 is not later than the one before.");
  EXPECT_EQ(error("time_s,a V\n0,1\n1,x\n"), "line 3 has a field that is no number.");
  EXPECT_EQ(error("time_s,a V\n0,1\n1,\n"), "line 3 has a field that is no number.");
  EXPECT_EQ(error("time_s,a V\n0,1\n"), "has fewer than two rows.");
  EXPECT_FALSE(load_trace("/nonexistent/trace.csv"));
  EXPECT_EQ(load_trace("/tmp").error(), "is a folder.");
  EXPECT_EQ(load_trace("/dev/zero").error(), "is larger than 64 MiB.");
}

}  // namespace
}  // namespace vinv::rig
