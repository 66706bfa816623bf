// What parameters of the FR-A700 do to the motor (ramps): set, and something a user can see must follow. Typical for
// the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

// Seconds from a start by RH to its frequency, and back to standstill.
std::pair<double, double> ramps(Settings settings, std::string_view terminal = "", double hz = 50) {
  settings.emplace_back("Pr.11", 0);
  settings.emplace_back("Pr.4", hz);
  Bench b = a700_with(settings);
  b.terminal("RH");
  if (!terminal.empty()) b.terminal(terminal);
  b.terminal("STF");
  const double up = seconds_to_reach(b, hz);
  b.run(0.1);
  b.terminal("STF", false);
  return {up, seconds_to_stop(b)};
}

TEST(A700Parameter, RampTimesAndThirdFunctions) {
  const auto near = [](std::pair<double, double> got, double up, double down) {
    EXPECT_NEAR(got.first, up, 0.03);
    EXPECT_NEAR(got.second, down, 0.05);
  };
  near(ramps({{"Pr.7", 1}, {"Pr.8", 2}}), 0.99, 1.99);
  near(ramps({{"Pr.7", 1}, {"Pr.8", 2}, {"Pr.20", 100}}), 0.5, 1.0);
  near(ramps({{"Pr.21", 1}, {"Pr.7", 0.75}, {"Pr.8", 0.75}}), 0.75, 0.75);
  near(ramps({{"Pr.44", 2}}, "RT"), 1.98, 1.98);
  near(ramps({{"Pr.44", 2}, {"Pr.45", 1}}, "RT"), 1.98, 0.99);
  // X9 at terminal RT.
  near(ramps({{"Pr.183", 9}, {"Pr.110", 1.5}}, "RT"), 1.48, 1.48);
  near(ramps({{"Pr.183", 9}, {"Pr.110", 1.5}, {"Pr.111", 1}}, "RT"), 1.48, 0.99);
  near(ramps({{"Pr.183", 9}, {"Pr.110", 9999}, {"Pr.111", 1}}, "RT"), 0.5, 0.5);
}

TEST(A700Parameter, Pr16IsTheRampOfTheJogOperation) {
  Bench b = a700_with({{"Pr.15", 20}, {"Pr.16", 2}});
  b.terminal("JOG");
  b.terminal("STF");
  EXPECT_NEAR(seconds_to_reach(b, 20), 0.8, 0.05);
}

TEST(A700Parameter, Pr155Is10LetsRtActAtConstantSpeedOnly) {
  for (int pr155 : {0, 10}) {
    Bench b = a700_with({{"Pr.155", static_cast<double>(pr155)}, {"Pr.44", 5}, {"Pr.4", 50}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.2);
    b.terminal("RT");
    EXPECT_NEAR(seconds_to_reach(b, 50), pr155 == 10 ? 0.3 : 3.1, 0.2);
  }
}

TEST(A700Parameter, Pr29ShapesTheRamp) {
  const auto at_quarter = [](int pr29) {
    Bench b = a700_with({{"Pr.29", static_cast<double>(pr29)}, {"Pr.7", 2}, {"Pr.4", 50}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.5);
    return b.output_hz();
  };
  EXPECT_NEAR(at_quarter(0), 12.9, 0.3);
  EXPECT_LT(at_quarter(1), 12);
  EXPECT_LT(at_quarter(2), 9);
}

TEST(A700Parameter, Pr29Is3StopsTheRampsAsPr140ToPr143Say) {
  const Settings backlash{{"Pr.29", 3}, {"Pr.140", 5}, {"Pr.141", 1}, {"Pr.142", 8}, {"Pr.143", 0.8}};
  const auto [up, down] = ramps(backlash);
  EXPECT_NEAR(up, 1.5, 0.05);
  EXPECT_NEAR(down, 1.3, 0.05);
  Bench b = a700_with({{"Pr.29", 3}, {"Pr.140", 5}, {"Pr.141", 1}, {"Pr.4", 50}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 5, 0.01);
  Bench c = a700_with({{"Pr.29", 3}, {"Pr.142", 8}, {"Pr.143", 1}, {"Pr.4", 50}});
  c.terminal("STF");
  c.terminal("RH");
  c.run(3);
  c.terminal("STF", false);
  c.run(1);
  EXPECT_NEAR(c.output_hz(), 8, 0.01);
}

TEST(A700Parameter, Pr29Is4AddsTheSPartsOfPr380ToPr383) {
  Settings s{{"Pr.29", 4}, {"Pr.7", 2}, {"Pr.8", 1}, {"Pr.380", 50}, {"Pr.381", 20}, {"Pr.382", 10}, {"Pr.383", 50}};
  const auto [up, down] = ramps(s);
  EXPECT_NEAR(up, 3.0, 0.1);
  EXPECT_NEAR(down, 1.2, 0.1);
  s.emplace_back("Pr.183", 20);  // X20 at terminal RT
  const auto [up_2, down_2] = ramps(s, "RT");
  EXPECT_NEAR(up_2, 2.2, 0.1);
  EXPECT_NEAR(down_2, 1.5, 0.1);
}

TEST(A700Parameter, Pr571HoldsTheStartFrequency) {
  Bench b = a700_with({{"Pr.571", 1}, {"Pr.13", 3}, {"Pr.4", 50}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(0.9);
  EXPECT_NEAR(b.output_hz(), 3, 0.01);
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 50, 0.01);
}

TEST(A700Parameter, Pr250CoastsOrMakesStrTheDirection) {
  Bench b = a700_with({{"Pr.250", 0.5}, {"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(1);
  b.terminal("STF", false);
  EXPECT_NEAR(seconds_to_stop(b), 0.5, 0.02);
  Bench c = a700_with({{"Pr.250", 8888}, {"Pr.4", 30}});
  c.terminal("STF");
  c.terminal("STR");
  c.terminal("RH");
  c.run(1);
  EXPECT_TRUE(c.port().status().reverse);
}

TEST(A700Parameter, Pr78ForbidsADirection) {
  for (int pr78 : {0, 1, 2}) {
    for (const char* terminal : {"STF", "STR"}) {
      Bench b = a700_with({{"Pr.78", static_cast<double>(pr78)}, {"Pr.4", 30}});
      b.terminal(terminal);
      b.terminal("RH");
      b.run(0.5);
      const bool forward = std::string_view(terminal) == "STF";
      EXPECT_EQ(b.port().status().running, pr78 == 0 || (pr78 == 1) == forward);
    }
  }
}

}  // namespace
}  // namespace vinv::inverter::test
