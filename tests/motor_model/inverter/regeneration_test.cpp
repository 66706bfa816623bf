// Loads that drive the motor: hoist lowering with and without brake resistor, and the DC injection brake.
#include <numbers>

#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

double rotor_hz(Bench& b) { return b.signal("speed") / 60 * b->plant().config().machine.pole_pairs; }
double rated_torque_nm(const plant::MachineParameters& m) {
  return m.rated_power_w / (m.rated_speed_rpm * std::numbers::pi / 30);
}

struct Lowering {
  std::string_view name;
  double brake_ohm = 0;
  double pr30 = 0;
  double pr70 = 0;
  double hz = 30;
  double load_of_rated = 0.8;
  std::string_view alarm = "";  // within two minutes; empty: none
  double at_least_s = 0;        // how long it goes well
};
std::ostream& operator<<(std::ostream& out, const Lowering& l) { return out << l.name; }

constexpr Lowering kLowerings[] = {
    {.name = "WithoutResistor", .alarm = "E.OV1", .at_least_s = 0.2},
    {.name = "AlmostNoLoadIsBorneByTheLosses", .load_of_rated = 0.1},
    // Three seconds in a hundred: the budget of the model lasts some seconds.
    {.name = "ModelDutyIsUsedUp", .brake_ohm = 400, .alarm = "E.OV2", .at_least_s = 5},
    {.name = "DutyBelowThatOfTheLoad", .brake_ohm = 400, .pr30 = 1, .pr70 = 20, .alarm = "E.OV2", .at_least_s = 60},
    {.name = "EnoughDuty", .brake_ohm = 150, .pr30 = 1, .pr70 = 30},
    {.name = "SlowLoweringNeedsLess", .brake_ohm = 400, .pr30 = 1, .pr70 = 20, .hz = 10},
    {.name = "DutyZeroIsNoChopper", .brake_ohm = 150, .pr30 = 1, .alarm = "E.OV1", .at_least_s = 0.2},
    {.name = "ResistorTooLarge", .brake_ohm = 2000, .pr30 = 1, .pr70 = 30, .alarm = "E.OV1", .at_least_s = 0.5},
};

// The holding brake lets go once the motor has flux, as on every hoist.
void lower(Bench& b, double hz) {
  b.preset("Pr.4", hz);
  b.preset("Pr.10", 0);
  b.power_on();
  b->set_shaft_locked(true);
  b.terminal("RH");
  b.terminal("STR");
  b.run(0.6);
  b->set_shaft_locked(false);
}

InverterConfig hoist(double load_of_rated, double brake_ohm) {
  InverterConfig c = config_1k5();
  c.load.inertia_kg_m2 = c.motor.inertia_kg_m2;
  c.load.hoist_nm = load_of_rated * rated_torque_nm(c.motor);
  c.brake_resistance_ohm = brake_ohm;
  return c;
}

class HoistLowering : public testing::TestWithParam<Lowering> {};

TEST_P(HoistLowering, EndsAsDutyAndResistorAllow) {
  const Lowering& l = GetParam();
  Bench b(hoist(l.load_of_rated, l.brake_ohm));
  b.preset("Pr.30", l.pr30);
  b.preset("Pr.70", l.pr70);
  lower(b, l.hz);
  const double begin_s = b.now_s();
  double on_s = 0;
  double highest_v = 0;
  const auto alarmed = [&] {
    on_s += b->plant().measurements().chopper_on ? 1e-3 : 0;
    highest_v = std::max(highest_v, b.signal("dc_link"));
    return !b->alarm_name().empty();
  };
  b.run_until(alarmed, 120);
  EXPECT_EQ(b->alarm_name(), l.alarm) << b->alarm_cause();
  EXPECT_GE(b.now_s() - begin_s, l.at_least_s);
  if (!l.alarm.empty()) return;

  EXPECT_NEAR(rotor_hz(b), -l.hz, 1.6);  // faster than the field while it regenerates
  if (l.load_of_rated < 0.5) {
    EXPECT_LT(highest_v, 600);
    EXPECT_EQ(on_s, 0);
    return;
  }
  EXPECT_LT(highest_v, 745);
  // The chopper's share of the time is the power that comes back, over what the resistor takes.
  const double resistor_w = 732.0 * 732.0 / l.brake_ohm;
  EXPECT_NEAR(on_s / 120, b->plant().energy().brake_j / 120 / resistor_w, 0.01 * on_s / 120);
  const double shaft_w = l.load_of_rated * rated_torque_nm(b->plant().config().machine) * 2 * std::numbers::pi *
                         -rotor_hz(b) / b->plant().config().machine.pole_pairs;
  EXPECT_LT(b->plant().energy().brake_j / 120, shaft_w);
  EXPECT_GT(b->plant().energy().brake_j / 120, 0.35 * shaft_w);  // copper takes a larger part at low speed
}

INSTANTIATE_TEST_SUITE_P(Table, HoistLowering, testing::ValuesIn(kLowerings),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Regeneration, ADefectiveBrakeTransistorEndsTheLoweringInItsAlarm) {
  Bench b(hoist(0.8, 150));
  b.preset("Pr.30", 1);
  b.preset("Pr.70", 30);
  lower(b, 30);
  b.run(10);
  ASSERT_EQ(b->alarm_name(), "") << b->alarm_cause();
  ASSERT_TRUE(b->inject_fault("brake_transistor", true).has_value());
  b.run(0.3);  // until the chopper turns on again
  EXPECT_TRUE(b.alarm("E.BE"));
  EXPECT_FALSE(b.port().status().running);
  const double brake_j = b->plant().energy().brake_j;
  b.run(0.2);
  EXPECT_NEAR(b->plant().energy().brake_j, brake_j, 10);  // the transistor is off
}

TEST(Regeneration, LiftingTakesPowerWhereLoweringGivesItBack) {
  Bench b(hoist(0.8, 150));
  b.preset("Pr.30", 1);
  b.preset("Pr.70", 30);
  lower(b, 20);
  b.run(8);
  EXPECT_LT(b.signal("output_power"), -100);
  EXPECT_NEAR(b.signal("torque"), 0.8 * rated_torque_nm(b->plant().config().machine), 1);
  b.terminal("STR", false);
  b.terminal("STF");
  b.run(10);
  EXPECT_GT(rotor_hz(b), 18);
  EXPECT_GT(b.signal("output_power"), 300);
  EXPECT_NEAR(b.signal("torque"), 0.8 * rated_torque_nm(b->plant().config().machine), 1);
  EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
}

// --- DC injection ---

struct Injection {
  double current_a_peak = 0;
  double most_nm = 0;
  double most_at_rad_s = 0;  // electrical
};
// Stator at 0 Hz: I = U / Rs; the torque of a turning rotor is 1.5 p Lm^2 I^2 w Rr / (Rr^2 + (w Lr)^2).
Injection injection(const plant::MachineParameters& m, double voltage_percent) {
  const double peak_v = m.rated_voltage_v_rms * std::sqrt(2.0 / 3) * voltage_percent / 100 * 0.95;  // Pr.19 = 8888
  const double l_r = m.L_lr_h + m.L_m_h;
  Injection out;
  out.current_a_peak = peak_v / m.R_s_ohm;
  out.most_nm = 1.5 * m.pole_pairs * m.L_m_h * m.L_m_h * out.current_a_peak * out.current_a_peak / (2 * l_r);
  out.most_at_rad_s = m.R_r_ohm / l_r;
  return out;
}

TEST(DcInjection, BrakesATurningRotorAndDoesNotHoldAStandingOne) {
  for (const double voltage : {2.0, 4.0, 6.0}) {
    SCOPED_TRACE(voltage);
    InverterConfig c = config_1k5();
    c.losses = plant::LossSettings{};
    const Injection expected = injection(c.motor, voltage);
    // A load below the most that it can brake creeps at the speed where the torque is that of the load.
    c.load.hoist_nm = 0.4 * expected.most_nm;
    Bench b(c);
    b.preset("Pr.4", 10);
    b.preset("Pr.12", voltage);
    b.preset("Pr.11", 10);
    b.preset("Pr.8", 0.5);
    b.power_on();
    b->set_shaft_locked(true);
    b.terminal("RH");
    b.terminal("STF");
    b.run(0.5);
    b->set_shaft_locked(false);
    b.run(3);
    b.terminal("STF", false);
    b.run(6);
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    EXPECT_NEAR(b->plant().measurements().current_peak_a, expected.current_a_peak, 0.02 * expected.current_a_peak);
    const double x = (1 - std::sqrt(1 - 0.4 * 0.4)) / 0.4;  // 2 x / (1 + x^2) = 0.4
    const double creep_rad_s = x * expected.most_at_rad_s;
    EXPECT_NEAR(-rotor_hz(b) * 2 * std::numbers::pi, creep_rad_s, 0.03 * creep_rad_s);
    EXPECT_NEAR(b.signal("torque"), c.load.hoist_nm, 0.02 * c.load.hoist_nm);
  }
}

TEST(DcInjection, ALoadBeyondItsTorqueRunsAway) {
  InverterConfig c = config_1k5();
  c.load.hoist_nm = 1.3 * injection(c.motor, 4).most_nm;
  Bench b(c);
  b.preset("Pr.4", 10);
  b.preset("Pr.12", 4);
  b.preset("Pr.11", 10);
  b.preset("Pr.8", 0.5);
  b.power_on();
  b->set_shaft_locked(true);
  b.terminal("RH");
  b.terminal("STF");
  b.run(0.5);
  b->set_shaft_locked(false);
  b.run(3);
  ASSERT_GT(rotor_hz(b), 8);
  b.terminal("STF", false);
  b.run(3);
  EXPECT_LT(rotor_hz(b), -10);
}

TEST(DcInjection, StopsACoastingInertiaWhichWithoutItTakesLonger) {
  const auto rest_s = [](double voltage) {
    InverterConfig c = config_1k5();
    c.load.inertia_kg_m2 = 10 * c.motor.inertia_kg_m2;
    Bench b(c);
    b.preset("Pr.4", 20);
    b.preset("Pr.8", 2);
    b.preset("Pr.10", 8);
    b.preset("Pr.11", 2);
    b.preset("Pr.12", voltage);
    b.power_on();
    b.terminal("RH");
    b.terminal("STF");
    b.run(4);
    b.terminal("STF", false);
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() <= 8 || !b.port().status().running; }, 3));
    const double begin_s = b.now_s();
    EXPECT_TRUE(b.run_until([&] { return b.signal("speed") < 1; }, 20));
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    return b.now_s() - begin_s;
  };
  // Voltage 0 switches it off: the motor is ramped down to 0.5 Hz and coasts from there.
  const double weak = rest_s(3);
  const double strong = rest_s(8);
  const double without = rest_s(0);
  EXPECT_LT(strong, weak);
  EXPECT_LT(weak, without);
}

}  // namespace
}  // namespace vinv::inverter::test
