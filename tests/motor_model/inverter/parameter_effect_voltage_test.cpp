// Parameters that say what voltage the FR-E500 gives to the motor: V/f law, second functions, flux vector control, slip
// compensation, carrier. Expected values come from the law itself, with the measured current where it counts.
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

constexpr double kBaseVoltage_v = 380;  // Pr.19 = 8888: 95 percent of 400 V

struct Point {
  Settings settings;
  double hz;
  double volt;
  bool rt = false;  // MRS has the function RT
  bool reverse = false;
};

double law(double boost_percent, double part_of_base_hz, double base_v = kBaseVoltage_v) {
  return base_v * (boost_percent / 100 + (1 - boost_percent / 100) * part_of_base_hz);
}

TEST(ParameterEffect, VoltageFollowsTheVfParameters) {
  const Point points[] = {
      {{}, 10, law(4, 0.2)},  // the factory law of a 1.5K
      {{{"Pr.0", 10}}, 10, law(10, 0.2)},
      {{{"Pr.0", 0}}, 10, law(0, 0.2)},
      {{{"Pr.3", 100}}, 50, law(4, 0.5)},
      {{{"Pr.14", 1}}, 25, law(4, 0.25)},  // square
      {{{"Pr.14", 2}}, 10, law(4, 0.2)},   // boost forward only
      {{{"Pr.14", 2}}, 10, law(0, 0.2), false, true},
      {{{"Pr.14", 3}}, 10, law(0, 0.2)},  // boost reverse only
      {{{"Pr.14", 3}}, 10, law(4, 0.2), false, true},
      {{{"Pr.19", 300}}, 50, 300},
      {{{"Pr.19", 9999}}, 25, law(4, 0.5, 400)},
      {{{"Pr.46", 9}}, 10, law(9, 0.2), true},
      {{{"Pr.46", 9}}, 10, law(4, 0.2)},
      {{{"Pr.46", 9999}, {"Pr.0", 8}}, 10, law(8, 0.2), true},
      {{{"Pr.47", 100}}, 50, law(4, 0.5), true},
      {{{"Pr.47", 100}}, 50, kBaseVoltage_v},
  };
  for (const Point& p : points) {
    SCOPED_TRACE((p.settings.empty() ? "factory" : p.settings.front().first) + " at " + std::to_string(p.hz));
    Settings settings = p.settings;
    for (const char* ramp : {"Pr.7", "Pr.44"}) settings.emplace_back(ramp, 0.5);
    settings.emplace_back("Pr.183", 3);
    settings.emplace_back("Pr.6", p.hz);
    Bench b = drive_with(settings);
    b.terminal("MRS", p.rt);
    b.terminal("RL");
    b.terminal(p.reverse ? "STR" : "STF");
    ASSERT_TRUE(runs_at(b, p.hz)) << b->alarm_cause();
    EXPECT_NEAR(b.output_v(), p.volt, 0.3);
  }
}

TEST(ParameterEffect, FluxVectorControlAddsMostOfTheDropOfTheStatorResistance) {
  struct Case {
    Settings settings;
    double ohm;
    double base_v = 400, base_hz = 50;
  };
  const Case cases[] = {{{{"Pr.80", 1.5}}, 3.655},  // the standard motor of that capacity
                        {{{"Pr.80", 2.2}}, 2.514},
                        {{{"Pr.80", 1.5}, {"Pr.90", 1.5}}, 1.5},
                        {{{"Pr.80", 1.5}, {"Pr.83", 300}}, 3.655, 300},
                        {{{"Pr.80", 1.5}, {"Pr.84", 80}}, 3.655, 400, 80}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.settings.back().first + " = " + std::to_string(c.settings.back().second));
    Bench b = drive_with(c.settings, loaded(0, 4));
    start(b, 20);
    b.run(3);
    const double f = b.signal("output_frequency");
    const double expected = c.base_v * f / c.base_hz + 0.8 * std::sqrt(3) * c.ohm * b.signal("output_current");
    EXPECT_NEAR(b.signal("output_voltage"), expected, 0.01 * expected);
    EXPECT_GT(f, 20.3);  // slip compensation of the standard motor
  }
  Bench vf = drive_with({{"Pr.90", 1.5}, {"Pr.83", 300}, {"Pr.84", 80}}, loaded(0, 4));  // Pr.80 = 9999
  start(vf, 20);
  vf.run(3);
  EXPECT_NEAR(vf.output_v(), law(4, 0.4), 0.3);
  EXPECT_NEAR(vf.output_hz(), 20, 0.01);
}

// Output frequency above the set one under a load of 6 Nm.
double compensation_hz(const Settings& settings, double hz = 30, double after_s = 8) {
  Bench b = drive_with(settings, loaded(0));
  start(b, hz);
  b.run(3);
  plant::LoadSettings load;
  load.constant_nm = 6;
  b->set_load(load);
  b.run(after_s);
  EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
  return b.signal("output_frequency") - hz;
}

TEST(ParameterEffect, SlipCompensationFollowsItsParameters) {
  EXPECT_NEAR(compensation_hz({}), 0, 0.001);
  EXPECT_NEAR(compensation_hz({{"Pr.245", 0}}), 0, 0.001);
  const double at_4_percent = compensation_hz({{"Pr.245", 4}});
  EXPECT_GT(at_4_percent, 0.8);
  EXPECT_LT(at_4_percent, 2);
  EXPECT_NEAR(compensation_hz({{"Pr.245", 2}}), at_4_percent / 2, 0.05);
  // Pr.82: a larger no-load current leaves less torque current at the rated point (Pr.9 = 4 A, standard motor 1.91 A).
  EXPECT_NEAR(compensation_hz({{"Pr.245", 2}, {"Pr.82", 3}}) / compensation_hz({{"Pr.245", 2}}),
              std::sqrt(16 - 1.91 * 1.91) / std::sqrt(16 - 9), 0.02);
  // Pr.246: part of the final value one second after the load.
  for (const auto& [response_s, part] : {std::pair{0.5, 0.865}, {2.0, 0.393}, {8.0, 0.118}}) {
    const Settings settings{{"Pr.245", 4}, {"Pr.246", response_s}};
    EXPECT_NEAR(compensation_hz(settings, 30, 1) / at_4_percent, part, 0.06) << response_s;
  }
  // Pr.247 = 0: not above the base frequency.
  EXPECT_GT(compensation_hz({{"Pr.245", 4}, {"Pr.247", 9999}}, 60), 0.8);
  EXPECT_NEAR(compensation_hz({{"Pr.245", 4}, {"Pr.247", 0}}, 60), 0, 0.001);
  EXPECT_GT(compensation_hz({{"Pr.245", 4}, {"Pr.247", 0}}, 40), 0.8);
}

TEST(ParameterEffect, Pr72IsTheCarrierFrequency) {
  for (const auto& [pr72, hz] : {std::pair{0, 700}, {1, 1000}, {12, 12000}, {15, 14500}}) {
    Bench b = drive_with({{"Pr.72", pr72}});
    b.run(0.01);
    EXPECT_EQ(b.signal("carrier"), hz);
  }
}

TEST(ParameterEffect, Pr96ArmsAutoTuning) {
  for (double pr96 : {0.0, 1.0}) {
    Bench b = drive_with({{"Pr.80", 1.5}, {"Pr.96", pr96}});
    start(b, 20);
    b.run(1);
    EXPECT_EQ(b.raw(96), pr96 == 1 ? 2u : 0u);
    EXPECT_EQ(std::abs(b.signal("speed")) < 1, pr96 == 1);
    b.run(3);
    EXPECT_EQ(b->get_parameter("Pr.90").value() == 9999, pr96 == 0);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
