// Auto tuning of the FR-E500 (Pr.96), and what make_inverter accepts.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using testing::HasSubstr;

TEST(AutoTuning, MeasuresTheStatorResistanceAtStandstill) {
  for (const char* machine : {"iec4p_0k75kW_400V", "iec4p_1k5kW_400V", "iec4p_2k2kW_400V"}) {
    Bench b(config_for("FR-E540-1.5K", machine));
    b.preset("Pr.80", 1.5);
    b.preset("Pr.96", 1);
    b.power_on();
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.frequency(20));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(0.5);
    EXPECT_EQ(b.raw(96), 2u);
    EXPECT_TRUE(refused(b.write_parameter(3, 6000), port::Refusal::kRunning));
    ASSERT_TRUE(b.run_until([&] { return b.raw(96) != 2; }, 10));
    EXPECT_EQ(b.raw(96), 3u);
    EXPECT_NEAR(b.signal("speed"), 0, 1);
    const double r1 = plant::find_machine(machine)->R_s_ohm;
    EXPECT_NEAR(b->get_parameter("Pr.90").value(), r1, 0.02 * r1) << machine;
    b.run(1);
    EXPECT_FALSE(b.port().status().running);  // waits for a new start
    ASSERT_TRUE(b.command({}));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(3);
    EXPECT_NEAR(b.output_hz(), 20, 3);
  }
}

TEST(AutoTuning, StoppedEarlyReads8AndKeepsPr90) {
  Bench b = fast({{"Pr.80", 1.5}, {"Pr.96", 1}});
  b.terminal("STF");
  b.run(0.5);
  b.terminal("STF", false);
  b.run(0.1);
  EXPECT_EQ(b.raw(96), 8u);
  EXPECT_EQ(b->get_parameter("Pr.90").value(), 9999);
}

TEST(AutoTuning, NeedsTheMotorCapacity) {
  Bench b = fast({{"Pr.96", 1}});
  b.terminal("RM");
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
}

// --- construction ---

TEST(MakeInverter, RefusesWithASentence) {
  EXPECT_EQ(make_inverter("fr-x", config_1k5()).error(), "there is no inverter family fr-x; there is fr-e500, fr-a700");
  EXPECT_THAT(make_inverter("fr-e500", config_for("FR-X", "iec4p_1k5kW_400V")).error(),
              HasSubstr("has no model FR-X; there are FR-E520-0.1K, "));
  InverterConfig c = config_1k5();
  c.motor.R_s_ohm = -1;
  EXPECT_THAT(make_inverter("fr-e500", c).error(), testing::StartsWith("motor: "));
  c = config_1k5();
  c.brake_resistance_ohm = -1;
  EXPECT_FALSE(make_inverter("fr-e500", c).has_value());
  c = config_1k5();
  c.mains = plant::MainsState{.voltage_v_rms = 1000};
  EXPECT_THAT(make_inverter("fr-e500", c).error(), HasSubstr("takes 0 to 600 V"));
}

TEST(MakeInverter, EveryModelStartsAndRunsItsMotor) {
  for (std::string_view model : models("fr-e500")) {
    const bool low = model.substr(0, 7) == "FR-E520";
    Bench b(config_for(std::string(model), low ? "iec4p_0k4kW_200V" : "iec4p_0k4kW_400V"));
    b.preset("Pr.7", 1);
    b.power_on();
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.frequency(30));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(3);
    // The two smallest are far too small for this motor: they may stall, they must not fall over.
    if (model != "FR-E520-0.1K" && model != "FR-E520-0.2K") {
      EXPECT_NEAR(b.output_hz(), 30, 0.1) << model << " " << b->alarm_cause();
      EXPECT_NEAR(b.signal("speed"), 880, 25) << model;
    }
  }
}

}  // namespace
}  // namespace vinv::inverter::test
