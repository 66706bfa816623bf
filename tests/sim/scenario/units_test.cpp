// Quantities and variables.
#include "sim/scenario/units.hpp"

#include <gtest/gtest.h>

#include "sim/scenario/variables.hpp"

namespace vinv::scenario {
namespace {

TEST(Units, AValueIsReadInTheUnitOfItsSignal) {
  EXPECT_DOUBLE_EQ(parse_value("1.2 kHz", "Hz").value(), 1200);
  EXPECT_DOUBLE_EQ(parse_value("500 mA", "A").value(), 0.5);
  EXPECT_DOUBLE_EQ(parse_value("3 A", "A").value(), 3);
  EXPECT_DOUBLE_EQ(parse_value("40 %", "%").value(), 40);
  EXPECT_DOUBLE_EQ(parse_value("-3 C", "degC").value(), -3);
  EXPECT_DOUBLE_EQ(parse_value("1.5 kW", "W").value(), 1500);
  EXPECT_DOUBLE_EQ(parse_value("1440 rpm", "rpm").value(), 1440);
  EXPECT_DOUBLE_EQ(parse_value("7", "-").value(), 7);
  EXPECT_DOUBLE_EQ(parse_value("0xA3", "-").value(), 163) << "a code as manuals print it";
  EXPECT_DOUBLE_EQ(parse_value("2.5 bar", "bar").value(), 2.5) << "a unit that nobody foresaw";
}

TEST(Units, AMissingOrWrongUnitIsRefused) {
  EXPECT_FALSE(parse_value("40", "Hz"));
  EXPECT_FALSE(parse_value("40 A", "Hz"));
  EXPECT_FALSE(parse_value("7 Hz", "-"));
  EXPECT_FALSE(parse_value("0x", "-"));
  EXPECT_FALSE(parse_value("0xG1", "-"));
  EXPECT_FALSE(parse_value("0x10", "A"));
  EXPECT_FALSE(parse_value("2.5", "bar"));
  EXPECT_FALSE(parse_value("", "Hz"));
}

TEST(Units, ValuesAndTimesAreShownShort) {
  EXPECT_EQ(show_value(48.25, "Hz"), "48.25 Hz");
  EXPECT_EQ(show_value(-1e-9, "Nm"), "0 Nm");
  EXPECT_EQ(show_value(25, "degC"), "25 C");
  EXPECT_EQ(show_value(3, "-"), "3");
  EXPECT_EQ(show_duration(std::chrono::milliseconds(1500)), "1.5 s");
  EXPECT_EQ(show_duration(std::chrono::microseconds(2500)), "2.5 ms");
  EXPECT_EQ(show_duration(std::chrono::nanoseconds(1500)), "1.5 us");
  EXPECT_EQ(show_duration(Duration{}), "0 s");
}

TEST(Variables, NamesAndExpressionsAreReplacedInsideText) {
  const Variables v{{"f", "40 Hz"}, {"t", "1.5 s"}, {"n", "3"}, {"model", "FR-E540-1.5K"}, {"share", "10 %"}};
  const auto text = [&](const char* s) { return substitute(s, v).value(); };
  EXPECT_EQ(text("no variable"), "no variable");
  EXPECT_EQ(text("$f +- 1 Hz"), "40 Hz +- 1 Hz");
  EXPECT_EQ(text("${model}"), "FR-E540-1.5K");
  EXPECT_EQ(text("${t + 200 ms}"), "1.7 s");
  EXPECT_EQ(text("${t * n - 0.5 s}"), "4 s");
  EXPECT_EQ(text("${f / 4}"), "10 Hz");
  EXPECT_EQ(text("${(f + 10 Hz) * 2}"), "100 Hz");
  EXPECT_EQ(text("${f * share}"), "4 Hz");
  EXPECT_EQ(text("${f / 10 Hz}"), "4");
  EXPECT_EQ(text("${-n + 1}"), "-2");
  EXPECT_EQ(text("${0.02 kg m2 * 2}"), "0.04 kg m2");
}

TEST(Variables, WhatCannotBeComputedIsRefused) {
  const Variables v{{"f", "40 Hz"}, {"t", "1.5 s"}, {"model", "FR-E540-1.5K"}};
  const auto error = [&](const char* s) {
    const auto r = substitute(s, v);
    return r ? "accepted: " + *r : r.error();
  };
  EXPECT_EQ(error("$speed"), "there is no variable \"speed\"; allowed: f, model, t.");
  EXPECT_EQ(error("${f + t}"), "${f + t}: 40 Hz and 1.5 s are of different kinds.");
  EXPECT_EQ(error("${f * t}"), "${f * t}: 40 Hz times 1.5 s is no quantity.");
  EXPECT_EQ(error("${f / t}"), "${f / t}: 40 Hz cannot be divided by 1.5 s.");
  EXPECT_EQ(error("${f / 0}"), "${f / 0}: division by zero.");
  EXPECT_EQ(error("${model + 1}"), "${model + 1}: model is \"FR-E540-1.5K\", with which nothing can be computed.");
  EXPECT_EQ(error("${(f}"), "${(f}: a closing parenthesis is missing.");
  EXPECT_EQ(error("${f"), "\"${\" has no closing brace.");
  EXPECT_EQ(error("${f +}"), "${f +}: a value is missing at its end.");
  EXPECT_EQ(error("${f t}"), "${f t}: \"t\" is too much.");
  EXPECT_EQ(error("${5 parsec}"), "${5 parsec}: \"5 parsec\" is neither a number nor a quantity.");
  EXPECT_EQ(error("a $ b"), "\"$\" begins a variable, as $name or ${name + 1 s}.");
  EXPECT_EQ(error(("${" + std::string(100, '(') + "1" + std::string(100, ')') + "}").c_str()).find("too many") ==
                std::string::npos,
            false);
}

}  // namespace
}  // namespace vinv::scenario
