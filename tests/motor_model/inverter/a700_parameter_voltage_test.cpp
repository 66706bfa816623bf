// What parameters of the FR-A700 do to the motor (voltage): set, and something a user can see must follow. Typical for
// the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

// Output voltage while running at this frequency, with a light motor.
double volts_at(double hz, Settings settings, std::string_view terminal = "") {
  settings.emplace_back("Pr.4", hz);
  Bench b = a700_with(settings);
  b.terminal("STF");
  b.terminal("RH");
  if (!terminal.empty()) b.terminal(terminal);
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > hz - 0.01; }, 20)) << b->alarm_name();
  b.run(0.3);
  return b.output_v();
}

TEST(A700Parameter, VoltageFollowsTheVfParameters) {
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}}), 200, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 10}}), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.3", 100}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.19", 200}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.19", 8888}}), 190, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.14", 1}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 10}, {"Pr.14", 3}}), 200, 2);  // boost in reverse only
  EXPECT_NEAR(volts_at(25, {{"Pr.46", 10}, {"Pr.0", 0}}, "RT"), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.47", 100}, {"Pr.0", 0}}, "RT"), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.183", 9}, {"Pr.112", 10}, {"Pr.0", 0}}, "RT"), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.183", 9}, {"Pr.113", 100}, {"Pr.0", 0}}, "RT"), 100, 2);
}

TEST(A700Parameter, X17TakesTheHoistBoostOfPr14Away) {
  // X17 at terminal RT; 5 boosts the reverse direction only, with X17 both.
  const Settings hoist{{"Pr.0", 10}, {"Pr.14", 5}, {"Pr.183", 17}};
  EXPECT_NEAR(volts_at(25, hoist), 200, 2);
  EXPECT_NEAR(volts_at(25, hoist, "RT"), 220, 2);
}

TEST(A700Parameter, Pr71Is2MakesPr100ToPr109TheVfLaw) {
  const Settings law{{"Pr.71", 2},    {"Pr.19", 400},  {"Pr.0", 0},    {"Pr.100", 10},  {"Pr.101", 40},
                     {"Pr.102", 20},  {"Pr.103", 120}, {"Pr.104", 30}, {"Pr.105", 180}, {"Pr.106", 35},
                     {"Pr.107", 250}, {"Pr.108", 40},  {"Pr.109", 330}};
  EXPECT_NEAR(volts_at(10, law), 40, 2);
  EXPECT_NEAR(volts_at(15, law), 80, 2);
  EXPECT_NEAR(volts_at(30, law), 180, 2);
  EXPECT_NEAR(volts_at(35, law), 250, 3);
  EXPECT_NEAR(volts_at(40, law), 330, 3);
  Settings other = law;
  other[0].second = 0;
  EXPECT_NEAR(volts_at(10, other), 80, 2);
  // Pr.19 left to the supply: no adjustable law.
  other = law;
  other[1].second = 9999;
  EXPECT_NEAR(volts_at(10, other), 80, 2);
}

TEST(A700Parameter, Pr80AndPr81SwitchVectorControlOnWithPr83AndPr84) {
  const Settings vector{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.83", 400}, {"Pr.84", 50}};
  // The motor keeps its speed under load: slip is compensated.
  const auto speed = [](const Settings& settings, std::string_view terminal = "") {
    Bench b = a700_with(settings, loaded(0, 8, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    if (!terminal.empty()) b.terminal(terminal);
    b.run(5);
    return b.signal("speed");
  };
  Settings s = vector;
  s.emplace_back("Pr.4", 40);
  const double with = speed(s);
  EXPECT_NEAR(with, 1200, 15);
  EXPECT_LT(speed({{"Pr.4", 40}}), with - 15);
  s.emplace_back("Pr.183", 18);  // X18 at terminal RT: V/f control
  EXPECT_LT(speed(s, "RT"), with - 15);
  s[0].second = 9999;
  EXPECT_LT(speed(s), with - 15);
  // Pr.83 at Pr.84 is the V/f law's end.
  Settings low = vector;
  low[2].second = 300;
  EXPECT_NEAR(volts_at(25, low) / volts_at(25, vector), 0.75, 0.03);
}

TEST(A700Parameter, Pr245ToPr247CompensateTheSlipOfVfControl) {
  const auto speed = [](Settings settings, double hz) {
    settings.emplace_back("Pr.4", hz);
    Bench b = a700_with(settings, loaded(0, 6, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    b.run(5);
    return b.signal("speed");
  };
  const double without = speed({}, 40);
  EXPECT_GT(speed({{"Pr.245", 4}}, 40), without + 10);
  EXPECT_LT(speed({{"Pr.245", 4}, {"Pr.246", 10}}, 40), speed({{"Pr.245", 4}}, 40) - 5);
  EXPECT_GT(speed({{"Pr.245", 4}, {"Pr.247", 9999}}, 60), speed({{"Pr.245", 4}, {"Pr.247", 0}}, 60) + 10);
}

TEST(A700Parameter, Pr286ToPr288AreTheDroop) {
  const auto hz = [](Settings settings, double after_s = 5) {
    settings.emplace_back("Pr.80", 1.5);
    settings.emplace_back("Pr.81", 4);
    settings.emplace_back("Pr.84", 50);
    settings.emplace_back("Pr.9", 3.25);
    settings.emplace_back("Pr.245", 0);
    settings.emplace_back("Pr.4", 40);
    Bench b = a700_with(settings, loaded(0, 8, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    b.run(after_s);
    return b.output_hz();
  };
  EXPECT_NEAR(hz({}), 40, 0.05);
  // 8 Nm take 73 % of the rated torque current, and Pr.286 of 50 Hz is the droop at 100 %.
  EXPECT_NEAR(40 - hz({{"Pr.286", 10}, {"Pr.287", 0.1}}), 3.6, 0.2);
  EXPECT_NEAR(40 - hz({{"Pr.286", 5}, {"Pr.287", 0.1}, {"Pr.288", 1}}), 1.8, 0.1);
  // Pr.287 is its delay, Pr.288 = 1 lets it act in the ramps too.
  EXPECT_NEAR(hz({{"Pr.286", 10}, {"Pr.287", 1}}, 0.7), hz({{"Pr.286", 10}, {"Pr.287", 0.01}}, 0.7) + 2.2, 0.8);
  EXPECT_NEAR(hz({{"Pr.286", 10}, {"Pr.288", 0}, {"Pr.7", 5}}, 2), 20.4, 0.3);
  EXPECT_LT(hz({{"Pr.286", 10}, {"Pr.288", 1}, {"Pr.7", 5}}, 2), 18.5);
}

TEST(A700Parameter, Pr10ToPr12AreTheDcInjectionBrake) {
  const auto braking = [](const Settings& settings, bool x13 = false) {
    Settings all = settings;
    all.emplace_back("Pr.183", 13);
    all.emplace_back("Pr.4", 30);
    Bench b = a700_with(all);
    b.terminal("STF");
    b.terminal("RH");
    b.run(1.5);
    b.terminal("STF", false);
    if (x13) b.terminal("RT");
    struct {
      double seconds = 0, volts = 0, from_hz = 0;
    } seen;
    for (int i = 0; i < 3000; ++i) {
      if (seen.seconds == 0) seen.from_hz = b.output_hz();
      b.tick();
      if (b.signal("run_state") != kStateDcBraking) continue;
      seen.seconds += 0.001;
      seen.volts = b.output_v();
    }
    return seen;
  };
  EXPECT_NEAR(braking({}).seconds, 0.5, 0.01);
  EXPECT_NEAR(braking({{"Pr.11", 1}}).seconds, 1.0, 0.01);
  EXPECT_EQ(braking({{"Pr.12", 0}}).seconds, 0);
  EXPECT_GT(braking({{"Pr.12", 8}}).volts, 1.5 * braking({}).volts);
  EXPECT_EQ(braking({{"Pr.11", 8888}}).seconds, 0);
  EXPECT_GT(braking({{"Pr.11", 8888}}, true).seconds, 2);  // while X13 is on
  EXPECT_NEAR(braking({}).from_hz, 3, 0.2);
  EXPECT_NEAR(braking({{"Pr.10", 8}}).from_hz, 8, 0.2);
  EXPECT_NEAR(braking({{"Pr.10", 9999}, {"Pr.13", 2}}).from_hz, 2, 0.2);
}

}  // namespace
}  // namespace vinv::inverter::test
