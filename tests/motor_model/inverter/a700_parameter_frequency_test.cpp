// What parameters of the FR-A700 do to the motor (frequency): set, and something a user can see must follow. Typical
// for the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

double running_hz(const Settings& settings, std::initializer_list<std::string_view> terminals) {
  Bench b = a700_with(settings);
  b.terminal("STF");
  for (std::string_view t : terminals) b.terminal(t);
  b.run(3);
  return b.output_hz();
}

TEST(A700Parameter, EachOfTheFifteenSpeedsHasItsParameter) {
  struct Case {
    std::string parameter;
    std::vector<std::string_view> on;
  };
  for (const Case& c : {Case{"Pr.4", {"RH"}},
                        {"Pr.5", {"RM"}},
                        {"Pr.6", {"RL"}},
                        {"Pr.24", {"RM", "RL"}},
                        {"Pr.25", {"RH", "RL"}},
                        {"Pr.26", {"RH", "RM"}},
                        {"Pr.27", {"RH", "RM", "RL"}},
                        {"Pr.232", {"JOG"}},
                        {"Pr.233", {"JOG", "RL"}},
                        {"Pr.234", {"JOG", "RM"}},
                        {"Pr.235", {"JOG", "RM", "RL"}},
                        {"Pr.236", {"JOG", "RH"}},
                        {"Pr.237", {"JOG", "RH", "RL"}},
                        {"Pr.238", {"JOG", "RH", "RM"}},
                        {"Pr.239", {"JOG", "RH", "RM", "RL"}}}) {
    Bench b = a700_with({{"Pr.185", 8}, {c.parameter, 17}});  // REX at terminal JOG
    b.terminal("STF");
    for (std::string_view t : c.on) b.terminal(t);
    b.run(1);
    EXPECT_NEAR(b.output_hz(), 17, 0.01) << c.parameter;
  }
}

TEST(A700Parameter, Pr1Pr2Pr13AndPr18LimitTheFrequency) {
  EXPECT_NEAR(running_hz({{"Pr.1", 33}, {"Pr.4", 40}}, {"RH"}), 33, 0.01);
  EXPECT_NEAR(running_hz({{"Pr.1", 33}, {"Pr.18", 130}, {"Pr.4", 40}}, {"RH"}), 40, 0.01);
  EXPECT_NEAR(running_hz({{"Pr.2", 12}}, {}), 12, 0.01);
  EXPECT_EQ(running_hz({{"Pr.13", 10}, {"Pr.4", 9}}, {"RH"}), 0);
  EXPECT_NEAR(running_hz({{"Pr.13", 10}, {"Pr.4", 11}}, {"RH"}), 11, 0.01);
}

TEST(A700Parameter, FrequenciesBetweenTheJumpsAreLeftOut) {
  const std::pair<std::string, std::string> bands[] = {{"Pr.31", "Pr.32"}, {"Pr.33", "Pr.34"}, {"Pr.35", "Pr.36"}};
  for (const auto& [a, b] : bands) {
    EXPECT_NEAR(running_hz({{a, 18}, {b, 22}, {"Pr.4", 20}}, {"RH"}), 18, 0.01);
    EXPECT_NEAR(running_hz({{a, 22}, {b, 18}, {"Pr.4", 20}}, {"RH"}), 22, 0.01);
  }
}

TEST(A700Parameter, Pr59MakesRhRmAndRlARemoteSetting) {
  for (int pr59 : {0, 1, 2, 3}) {
    Bench b = a700_with({{"Pr.59", static_cast<double>(pr59)}, {"Pr.44", 1}, {"Pr.4", 60}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.4);
    b.terminal("RH", false);
    b.run(1);
    EXPECT_NEAR(b.output_hz(), pr59 == 0 ? 0 : 20, 0.5) << pr59;
    b.terminal("RL");
    b.run(1);
    EXPECT_NEAR(b.output_hz(), pr59 == 0 ? 10 : 0, 0.5) << pr59;
  }
}

TEST(A700Parameter, CalibrationsShiftTheAnalogInputs) {
  const auto set = [](const Settings& settings, double volt_2, double ma_4) {
    Bench b = a700_with(settings);
    EXPECT_TRUE(b->set_analog("2", volt_2).has_value());
    EXPECT_TRUE(b->set_analog("4", ma_4).has_value());
    if (ma_4 > 0) b.terminal("AU");
    b.run(0.5);
    return b.signal("set_frequency");
  };
  EXPECT_NEAR(set({{"Pr.125", 40}}, 5, 0), 40, 0.02);
  EXPECT_NEAR(set({{"Pr.903.1", 40}}, 5, 0), 40, 0.02);
  EXPECT_NEAR(set({{"C4", 50}}, 2.5, 0), 60, 0.02);  // Pr.903
  EXPECT_NEAR(set({{"C2", 10}}, 0, 0), 10, 0.02);    // Pr.902
  EXPECT_NEAR(set({{"C3", 50}}, 2.5, 0), 0, 0.02);   // Pr.902
  EXPECT_NEAR(set({{"Pr.126", 30}}, 0, 20), 30, 0.02);
  EXPECT_NEAR(set({{"Pr.905.1", 30}}, 0, 20), 30, 0.02);
  EXPECT_NEAR(set({{"C7", 60}}, 0, 12), 60, 0.02);  // Pr.905
  EXPECT_NEAR(set({{"C5", 10}}, 0, 4), 10, 0.02);   // Pr.904
  EXPECT_NEAR(set({{"C6", 0}}, 0, 10), 30, 0.02);   // Pr.904
}

TEST(A700Parameter, Pr917AndPr918AreTheLineOfTerminalOne) {
  const auto set = [](const Settings& settings) {
    Bench b = a700_with(settings);
    EXPECT_TRUE(b->set_analog("1", 5).has_value());
    b.run(0.5);
    return b.signal("set_frequency");
  };
  EXPECT_NEAR(set({}), 30, 0.02);
  EXPECT_NEAR(set({{"Pr.917.1", 10}}), 35, 0.02);
  EXPECT_NEAR(set({{"Pr.917.2", 50}}), 0, 0.02);
  EXPECT_NEAR(set({{"Pr.918.1", 40}}), 20, 0.02);
  EXPECT_NEAR(set({{"Pr.918.2", 50}}), 60, 0.02);
  EXPECT_NEAR(set({{"Pr.868", 9999}}), 0, 0.02);
}

TEST(A700Parameter, Pr74FiltersTheInputs) {
  const auto after_20_ms = [](double pr74) {
    Bench b = a700_with({{"Pr.74", pr74}});
    EXPECT_TRUE(b->set_analog("2", 5).has_value());
    b.run(0.02);
    return b.signal("set_frequency");
  };
  EXPECT_GT(after_20_ms(0), 55);
  EXPECT_LT(after_20_ms(8), 5);
}

TEST(A700Parameter, Pr243AddsTerminalOneToTerminalFour) {
  Bench b = a700_with({{"Pr.243", 50}});
  b.terminal("AU");
  ASSERT_TRUE(b->set_analog("4", 12).has_value());
  ASSERT_TRUE(b->set_analog("1", 5).has_value());
  b.run(0.5);
  EXPECT_NEAR(b.signal("set_frequency"), 45, 0.05);
}

}  // namespace
}  // namespace vinv::inverter::test
