#include "sim/rig/words.hpp"

#include <gtest/gtest.h>

#include "sim/rig/quantity.hpp"

namespace vinv::rig {
namespace {

TEST(Words, TheNearestWordForgivesCaseSwapsAndShortening) {
  const std::vector<std::string_view> known{"inertia_kg_m2", "torque", "friction"};
  EXPECT_EQ(nearest("Torque", known), "torque");
  EXPECT_EQ(nearest("troque", known), "torque");
  EXPECT_EQ(nearest("inertia", known), "inertia_kg_m2");
  EXPECT_EQ(nearest("colour", known), "");
  EXPECT_EQ(nearest("", known), "");
}

TEST(Words, LongListsAreCutWithTheirLength) {
  EXPECT_EQ(join({"a", "b", "c"}, 2), "a, b, ... (3 in all)");
  EXPECT_EQ(join({"a", "b"}, 2), "a, b");
}

TEST(Words, NumbersAreDecimalAndWhole) {
  double v = 0;
  EXPECT_TRUE(parse_number("-1.5e2", v));
  EXPECT_DOUBLE_EQ(v, -150);
  EXPECT_TRUE(parse_number("+0.5", v));
  EXPECT_TRUE(parse_number("0", v));
  for (const char* bad : {"", "-", "inf", "nan", "0x10", "010", "1,5", "1.5 s", "5s", "--1", "1e999"})
    EXPECT_FALSE(parse_number(bad, v)) << bad;
}

TEST(Quantity, ValuesAreTakenInTheirOwnUnit) {
  EXPECT_DOUBLE_EQ(*parse_quantity("12 Nm", Dimension::kTorque), 12);
  EXPECT_DOUBLE_EQ(*parse_quantity("40Hz", Dimension::kFrequency), 40);
  EXPECT_DOUBLE_EQ(*parse_quantity("200 ms", Dimension::kTime), 0.2);
  EXPECT_DOUBLE_EQ(*parse_quantity("2 min", Dimension::kTime), 120);
  EXPECT_DOUBLE_EQ(*parse_quantity("40 %", Dimension::kFraction), 0.4);
  EXPECT_DOUBLE_EQ(*parse_quantity("12 mA", Dimension::kCurrent), 12);
  EXPECT_DOUBLE_EQ(*parse_quantity("-5 C", Dimension::kTemperature), -5);
  EXPECT_DOUBLE_EQ(*parse_quantity("50 \u00b0C", Dimension::kTemperature), 50);
  EXPECT_DOUBLE_EQ(*parse_quantity("0.5 kg m2", Dimension::kInertia), 0.5);
}

TEST(Quantity, AWrongUnitIsRefusedWithTheAllowedOnes) {
  EXPECT_EQ(parse_quantity("12 Hz", Dimension::kTorque).error(),
            "\"12 Hz\" has the wrong unit; write a number and one of these units: Nm, mNm, kNm, for example \"5 Nm\".");
  EXPECT_EQ(parse_quantity("12", Dimension::kVoltage).error(),
            "\"12\" has no unit; write a number and one of these units: V, mV, kV, for example \"5 V\".");
  EXPECT_EQ(parse_quantity("fast", Dimension::kTime).error(),
            "\"fast\" does not begin with a number; write a number and one of these units: s, ms, us, min, for example "
            "\"5 s\".");
  EXPECT_FALSE(parse_quantity("5 nm", Dimension::kTorque));
  EXPECT_FALSE(parse_quantity("", Dimension::kTorque));
}

}  // namespace
}  // namespace vinv::rig
