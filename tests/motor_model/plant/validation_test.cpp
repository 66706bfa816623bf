// Bad settings are refused with a sentence that names the value and what is allowed; the shipped machines are all good.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/motor_model/plant/plants.hpp"

namespace vinv::plant::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Settings>
struct Mistake {
  const char* name;
  void (*make)(Settings&);
  const char* names_value;
  const char* names_range;
};

template <class Settings, std::size_t N>
void expect_refused(const Mistake<Settings> (&mistakes)[N], const Settings& good) {
  ASSERT_TRUE(validate(good)) << validate(good).error();
  for (const auto& mistake : mistakes) {
    Settings bad = good;
    mistake.make(bad);
    const auto outcome = validate(bad);
    ASSERT_FALSE(outcome) << mistake.name;
    EXPECT_THAT(outcome.error(), AllOf(HasSubstr(mistake.names_value), HasSubstr(mistake.names_range))) << mistake.name;
  }
}

TEST(Machines, EveryShippedMachineIsValidAndFoundByName) {
  const auto names = machine_names();
  EXPECT_EQ(names.size(), 34u);
  for (const auto name : names) {
    const MachineParameters* machine = find_machine(name);
    ASSERT_NE(machine, nullptr) << name;
    EXPECT_EQ(machine->name, name);
    const auto outcome = validate(*machine);
    EXPECT_TRUE(outcome) << name << ": " << (outcome ? "" : outcome.error());
    PlantConfig config;
    config.machine = *machine;
    config.losses = typical_losses(*machine);
    config.nominal_mains_v_rms = config.mains.voltage_v_rms = machine->rated_voltage_v_rms;
    const auto whole = validate(config);
    EXPECT_TRUE(whole) << name << ": " << (whole ? "" : whole.error());
  }
  EXPECT_EQ(find_machine("no_such_machine"), nullptr);
  const MachineParameters& m = *find_machine("iec4p_1k5kW_400V");
  EXPECT_EQ(m.pole_pairs, 2);
  EXPECT_EQ(m.rated_power_w, 1500);
  EXPECT_EQ(m.R_s_ohm, 3.655);
  EXPECT_EQ(m.rated_speed_rpm, 1445);
}

TEST(Validation, MachinesThatNobodyBuildsAreRefusedWithTheReason) {
  using M = MachineParameters;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Mistake<M> mistakes[] = {
      {"no stator resistance", [](M& m) { m.R_s_ohm = 0; }, "R_s_ohm is 0 ohm", "between 1e-05 and 1000 ohm"},
      {"negative rotor resistance", [](M& m) { m.R_r_ohm = -2; }, "R_r_ohm is -2 ohm", "between"},
      {"not a number", [](M& m) { m.R_s_ohm = kNan; }, "R_s_ohm is nan", "between"},
      {"infinite", [](M& m) { m.inertia_kg_m2 = INFINITY; }, "inertia_kg_m2 is inf", "between"},
      {"no stator leakage", [](M& m) { m.L_ls_h = 0; }, "L_ls_h is 0 H", "between"},
      {"no rotor leakage", [](M& m) { m.L_lr_h = 0; }, "L_lr_h is 0 H", "between"},
      {"no magnetising inductance", [](M& m) { m.L_m_h = 0; }, "L_m_h is 0 H", "between"},
      {"leakage above magnetising", [](M& m) { m.L_ls_h = 2 * m.L_m_h; }, "L_ls_h 0.46", "below half"},
      {"millihenry for henry", [](M& m) { m.L_m_h = 234; }, "L_m_h is 234 H", "between"},
      {"no pole pairs", [](M& m) { m.pole_pairs = 0; }, "pole_pairs is 0", "between 1 and 24"},
      {"poles for pole pairs", [](M& m) { m.pole_pairs = 4; }, "rated_speed_rpm is 1439 rpm", "750 rpm"},
      {"no inertia", [](M& m) { m.inertia_kg_m2 = 0; }, "inertia_kg_m2 is 0", "between"},
      {"no power", [](M& m) { m.rated_power_w = 0; }, "rated_power_w is 0 W", "between"},
      {"kilowatts", [](M& m) { m.rated_power_w = 22000; }, "rated_power_w is 22000 W", "below 3811 W"},
      {"no voltage", [](M& m) { m.rated_voltage_v_rms = 0; }, "rated_voltage_v_rms is 0 V", "between"},
      {"delta values", [](M& m) { m.rated_voltage_v_rms = 690; }, "no-load current is 5.17 A",
       "below rated_current_a_rms 5 A"},
      {"no frequency", [](M& m) { m.rated_frequency_hz = 0; }, "rated_frequency_hz is 0 Hz", "between"},
      {"no current", [](M& m) { m.rated_current_a_rms = 0; }, "rated_current_a_rms is 0 A", "between"},
      {"synchronous speed", [](M& m) { m.rated_speed_rpm = 1500; }, "rated_speed_rpm is 1500 rpm", "just below 1500"},
      {"above synchronous", [](M& m) { m.rated_speed_rpm = 1700; }, "rated_speed_rpm is 1700 rpm", "between"},
      {"implausible slip", [](M& m) { m.rated_speed_rpm = 900; }, "rated_speed_rpm is 900 rpm", "1050"},
      {"too weak", [](M& m) { m.R_s_ohm = 60; }, "breakdown torque", "above 1.1 times the rated torque"},
  };
  expect_refused(mistakes, *find_machine("motulator_2k2"));
}

TEST(Validation, LoadsThatMeanNothingAreRefusedWithTheReason) {
  using L = LoadSettings;
  const Mistake<L> mistakes[] = {
      {"negative inertia", [](L& l) { l.inertia_kg_m2 = -1; }, "inertia_kg_m2 is -1", "between 0"},
      {"driving constant", [](L& l) { l.constant_nm = -5; }, "constant_nm", "use hoist_nm"},
      {"negative linear", [](L& l) { l.linear_nm_s = -1; }, "linear_nm_s is -1", "between 0"},
      {"negative quadratic", [](L& l) { l.quadratic_nm_s2 = -1; }, "quadratic_nm_s2 is -1", "between 0"},
      {"infinite hoist", [](L& l) { l.hoist_nm = INFINITY; }, "hoist_nm is inf", "between"},
      {"table before start",
       [](L& l) {
         l.table = {{-1, 0}};
       },
       "table point 1: time_s is -1 s", "between 0"},
      {"table backwards",
       [](L& l) {
         l.table = {{2, 0}, {1, 0}};
       },
       "table point 2: time_s is 1 s", "between 2"},
      {"table with three at once",
       [](L& l) {
         l.table = {{1, 0}, {1, 1}, {1, 2}};
       },
       "points 1 to 3", "two points"},
      {"table without torque",
       [](L& l) {
         l.table = {{1, NAN}};
       },
       "torque_nm is nan", "between"},
  };
  L good;
  good.table = {{0, 1}, {1, 1}, {1, 5}, {2, -5}};
  expect_refused(mistakes, good);
}

TEST(Validation, PlantsThatCannotWorkAreRefusedWithTheReason) {
  using C = PlantConfig;
  const Mistake<C> mistakes[] = {
      {"machine", [](C& c) { c.machine.R_s_ohm = 0; }, "R_s_ohm is 0", "between"},
      {"load", [](C& c) { c.load.constant_nm = -1; }, "constant_nm", "hoist_nm"},
      {"iron", [](C& c) { c.losses.iron_loss_w_at_rated = 2000; }, "iron_loss_w_at_rated is 2000 W", "1100 W"},
      {"inverter", [](C& c) { c.losses.inverter_loss_fraction = 3; }, "inverter_loss_fraction is 3", "0.5"},
      {"switching", [](C& c) { c.losses.inverter_switching_share = 2; }, "inverter_switching_share is 2", "between"},
      {"standby", [](C& c) { c.losses.standby_w = -1; }, "standby_w is -1 W", "between"},
      {"viscous", [](C& c) { c.losses.viscous_nm_s = 5; }, "viscous_nm_s is 5", "between"},
      {"coulomb", [](C& c) { c.losses.coulomb_nm = 50; }, "coulomb_nm is 50 Nm", "between"},
      {"no capacitor", [](C& c) { c.dc_link.capacitance_f = 0; }, "capacitance_f is 0 F", "between"},
      {"microfarads", [](C& c) { c.dc_link.capacitance_f = 235; }, "capacitance_f is 235 F", "between"},
      {"no source", [](C& c) { c.dc_link.source_resistance_ohm = 0; }, "source_resistance_ohm is 0", "0.001"},
      {"relay", [](C& c) { c.dc_link.bypass_opens_fraction = 0.9; }, "bypass_opens_fraction is 0.9", "below"},
      {"resistor", [](C& c) { c.dc_link.brake_resistance_ohm = -1; }, "brake_resistance_ohm", "0 for none"},
      {"levels",
       [](C& c) {
         c.comparators = {0, 300, 345, 380};
       },
       "under_voltage_v 345 V", "below over_voltage_v 300"},
      {"mains", [](C& c) { c.mains.voltage_v_rms = 4000; }, "voltage_v_rms is 4000 V", "800 V"},
      {"ambient", [](C& c) { c.ambient_c = 1000; }, "ambient_c is 1000", "120"},
      {"thermal", [](C& c) { c.thermal.winding_time_constant_s = 0; }, "winding_time_constant_s is 0", "between"},
  };
  expect_refused(mistakes, real_2k2());
}

}  // namespace
}  // namespace vinv::plant::test
