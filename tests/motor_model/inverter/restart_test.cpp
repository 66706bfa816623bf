// Output on into a turning motor: MRS released, retry after an alarm, restart after a power failure, reset and start.
// With its rotor flux decayed a motor is caught; with the flux of a moment ago the voltage may meet it out of phase.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

struct Machine {
  std::string_view model;
  std::string_view machine;
  double nominal_v = 400;
};
constexpr Machine kMachines[] = {{"FR-E540-0.4K", "iec4p_0k4kW_400V"},
                                 {"FR-E540-1.5K", "iec4p_1k5kW_400V"},
                                 {"FR-E520-3.7K", "iec4p_3k7kW_200V", 200},
                                 {"FR-E540-7.5K", "iec4p_7k5kW_400V"}};

InverterConfig machine(const Machine& m, double inertia_ratio) {
  InverterConfig c = config_for(std::string(m.model), m.machine);
  c.load.inertia_kg_m2 = (inertia_ratio - 1) * c.motor.inertia_kg_m2;
  return c;
}

double rotor_hz(Bench& b) { return b.signal("speed") / 60 * b->plant().config().machine.pole_pairs; }

// Running at 50 Hz.
void bring_up(Bench& b) {
  b.preset("Pr.4", 50);
  b.preset("Pr.7", 3);
  b.power_on();
  b.terminal("RH");
  b.terminal("STF");
  ASSERT_TRUE(b.run_until([&] { return rotor_hz(b) > 48; }, 8)) << b->alarm_cause();
}
bool comes_back(Bench& b) {
  return b.run_until([&] { return !b->alarm_name().empty() || (b.output_hz() == 50 && rotor_hz(b) > 48); }, 20) &&
         b->alarm_name().empty();
}

TEST(Restart, MrsReleasedAfterTheFluxHasDecayedCatchesTheMotor) {
  for (const Machine& m : kMachines) {
    for (const double ratio : {2.0, 5.0}) {
      for (const double off_s : {0.5, 1.0, 3.0}) {
        SCOPED_TRACE(testing::Message() << m.model << " inertia " << ratio << " off " << off_s);
        Bench b(machine(m, ratio));
        bring_up(b);
        b.terminal("MRS");
        b.run(off_s);
        EXPECT_FALSE(b.port().status().running);
        b.terminal("MRS", false);
        b.run(0.01);
        EXPECT_TRUE(b.port().status().running);
        EXPECT_TRUE(comes_back(b)) << b->alarm_cause();
      }
    }
  }
}

// It starts from 0.5 Hz, as this family does: a flywheel is braked at the current limit, for longer than that allows.
TEST(Restart, MrsReleasedWithAFlywheelTurningEndsInTheDrivesOverload) {
  Bench b(machine(kMachines[3], 40));
  bring_up(b);
  b.terminal("MRS");
  b.run(1);
  b.terminal("MRS", false);
  EXPECT_FALSE(comes_back(b));
  EXPECT_TRUE(b.alarm("E.THT")) << b->alarm_cause();
}

TEST(Restart, IntoTheFluxOfAMomentAgoMayBeOverCurrentOfALargeMotor) {
  Bench small(machine(kMachines[0], 5));
  bring_up(small);
  Bench large(machine(kMachines[3], 5));
  bring_up(large);
  for (Bench* b : {&small, &large}) {
    b->terminal("MRS");
    b->run(0.1);
    b->terminal("MRS", false);
    b->run(0.1);
  }
  EXPECT_EQ(small->alarm_name(), "");
  EXPECT_EQ(large->alarm_name(), "E.OC1");
}

TEST(Restart, AfterAPowerFailureTheMotorIsCaughtWithoutJolt) {
  for (const Machine& m : kMachines) {
    for (const double ratio : {2.0, 5.0, 20.0}) {
      for (const auto& [wait_s, cushion_s] : {std::pair{0.0, 1.0}, {0.5, 1.0}, {2.0, 1.0}, {1.0, 0.0}}) {
        // Without the cushion the inrush of flux may trip a large machine with a flywheel, as it does real ones.
        if (cushion_s == 0 && ratio > 5) continue;
        for (const double longer_s : {0.02, 0.1}) {
          SCOPED_TRACE(testing::Message() << m.model << " inertia " << ratio << " Pr.57 = " << wait_s
                                          << " Pr.58 = " << cushion_s << " longer " << longer_s);
          Bench b(machine(m, ratio));
          b.preset("Pr.57", wait_s);
          b.preset("Pr.58", cushion_s);
          bring_up(b);
          b->set_mains({.voltage_v_rms = 0});
          ASSERT_TRUE(b.run_until([&] { return b.port().status().power_failure; }, 1));
          b.run(longer_s);
          b->set_mains({.voltage_v_rms = m.nominal_v});
          ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 4));
          const double rotor = rotor_hz(b);
          EXPECT_NEAR(b.output_hz(), rotor, 1);  // at the motor's speed
          double highest_a = 0;
          double lowest_hz = rotor;
          for (int i = 0; i < 1000; ++i) {
            b.tick();
            highest_a = std::max(highest_a, b->plant().measurements().output_current_a_rms);
            lowest_hz = std::min(lowest_hz, rotor_hz(b));
          }
          EXPECT_TRUE(comes_back(b)) << b->alarm_cause();
          // The cushion is what keeps the current low.
          if (cushion_s > 0) {
            EXPECT_LT(highest_a, 1.3 * b->plant().config().machine.rated_current_a_rms);
            EXPECT_GT(lowest_hz, 0.85 * rotor);
          }
        }
      }
    }
  }
}

TEST(Restart, RetryStartsTheTurningMotorAgain) {
  for (const Machine& m : kMachines) {
    SCOPED_TRACE(m.model);
    Bench b(machine(m, 5));
    b.preset("Pr.67", 2);
    b.preset("Pr.68", 1);
    bring_up(b);
    ASSERT_TRUE(b->inject_fault("E.OC2", true).has_value());
    b.run(0.5);
    EXPECT_FALSE(b.port().status().running);
    EXPECT_GT(rotor_hz(b), 20);
    ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 1));
    EXPECT_TRUE(comes_back(b)) << b->alarm_cause();
  }
}

TEST(Restart, ResetWhileTheMotorTurnsAndTheStartSignalStaysStartsItAgain) {
  for (const Machine& m : kMachines) {
    SCOPED_TRACE(m.model);
    Bench b(machine(m, 5));
    bring_up(b);
    b.terminal("RES");
    b.run(0.2);
    b.terminal("RES", false);
    EXPECT_FALSE(b.port().status().running);
    ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 2));
    EXPECT_GT(rotor_hz(b), 15);
    EXPECT_TRUE(comes_back(b)) << b->alarm_cause();
  }
}

}  // namespace
}  // namespace vinv::inverter::test
