// PowerPlant as its owner uses it: inputs, then 1 ms ticks. Charging, mains, chopper, comparators, inputs,
// temperatures.
#include "motor_model/plant/power_plant.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/motor_model/plant/plants.hpp"
#include "tests/motor_model/plant/reference_table.hpp"

namespace vinv::plant::test {
namespace {

constexpr double kRpm = 30 / std::numbers::pi;

TEST(PowerPlantTrace, RampInTicksFollowsTheContinuousTrajectoryB) {
  const ReferenceTable data("b_vf_ramp_fan_2k2.csv.gz");
  PlantConfig config = lossless_2k2();
  config.load.quadratic_nm_s2 = 0.000591715712471;
  config.nominal_mains_v_rms = config.mains.voltage_v_rms = 480;  // the trace has an ideal source: no voltage limit
  PowerPlant plant(config);
  charge(plant);
  plant.set_stage(vf(0));  // the trace starts at 0 Hz and boost voltage
  plant.advance(Duration{1});
  const auto times = data.numbers("t_s"), omega = data.numbers("omega_rad_s"), torque = data.numbers("Te_Nm");
  std::size_t row = 1;
  for (int tick = 1; tick <= 6000; ++tick) {
    plant.set_stage(vf(std::min(50.0, tick * 0.01)));
    plant.advance(1ms);
    if (tick % 2 != 0) continue;
    ASSERT_NEAR(times[row], tick * 1e-3, 1e-9);
    ASSERT_NEAR(plant.measurements().speed_rpm / kRpm, omega[row], 1e-3 * 151.17) << times[row];
    ASSERT_NEAR(plant.measurements().torque_nm, torque[row], 1e-3 * 13.92) << times[row];
    ++row;
  }
}

TEST(PowerPlantTrace, DecelerationTripsOnOverVoltageWhenTrajectoryDDoes) {
  PlantConfig config = lossless_2k2(0.15);
  config.comparators.over_voltage_v = 800;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 10s);
  run(plant, 3s);
  ASSERT_NEAR(plant.measurements().speed_rpm, 1500, 0.01);
  ASSERT_NEAR(plant.measurements().dc_link_v, 565.333158, 0.01);
  const Duration start = plant.time();
  const auto events = ramp(plant, 50, 0, 1s);
  ASSERT_EQ(events.count, 1u);
  EXPECT_EQ(events.items[0].kind, PlantEventKind::kOverVoltage);
  EXPECT_NEAR(events.items[0].value, 800, 0.01);
  const Duration at = plant.time() - 1ms + events.items[0].after - start;
  EXPECT_NEAR(to_seconds(at), 0.049579121, 1e-4);
}

TEST(DcLink, PrechargeLimitsTheInrushAndIsBypassedAtItsLevel) {
  PowerPlant plant(lossless_2k2());
  plant.advance(Duration{1000});
  // 565.7 V over 2 + 50 ohm
  EXPECT_NEAR(plant.measurements().input_power_w / 565.685, 10.88, 0.02);
  double bypassed_at = 0;
  while (bypassed_at == 0 && plant.time() < 1s) {
    plant.advance(100us);
    if (plant.measurements().precharge_bypassed) bypassed_at = to_seconds(plant.time());
  }
  // v = V (1 - exp(-t / RC)) reaches 80 % at RC ln 5
  EXPECT_NEAR(bypassed_at, 52 * 235e-6 * std::log(5.0), 1.1e-4);
  plant.advance(100ms);
  EXPECT_NEAR(plant.measurements().dc_link_v, 565.685, 0.05);
}

TEST(DcLink, LosesItsChargeQuicklyToTheSupplyThenSlowlyWhenTheMainsIsOff) {
  PowerPlant plant(real_2k2());
  charge(plant);
  plant.set_mains({0, {false, false, false}});
  plant.advance(3s);
  const double after_supply = plant.measurements().dc_link_v;
  EXPECT_LT(after_supply, 0.4 * 565);
  EXPECT_GT(after_supply, 0.2 * 565);
  EXPECT_FALSE(plant.measurements().precharge_bypassed);
  plant.advance(60s);
  EXPECT_LT(plant.measurements().dc_link_v, 0.8 * after_supply);
  EXPECT_GT(plant.measurements().dc_link_v, 0.2 * after_supply);
  plant.advance(3600s);
  EXPECT_GE(plant.measurements().dc_link_v, 0);
  EXPECT_LT(plant.measurements().dc_link_v, 1);
}

TEST(DcLink, MainsDipTripsUnderVoltageAfterTheHoldUpTime) {
  PlantConfig config = real_2k2();
  config.comparators = {0, 800, 345, 380};
  config.load.constant_nm = 14.6;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  const double power = plant.measurements().input_power_w;
  const double v0 = plant.measurements().dc_link_v;
  plant.set_mains({0, {true, true, true}});
  const Duration start = plant.time();
  const auto events = run(plant, 100ms);
  ASSERT_EQ(events.count, 1u);
  EXPECT_EQ(events.items[0].kind, PlantEventKind::kUnderVoltage);
  EXPECT_NEAR(events.items[0].value, 345, 0.01);
  // C (V0^2 - Vuv^2) / 2P at constant power; longer because the voltage limit falls with the link and the flux, which
  // follows slowly, then feeds back.
  const double hold_up = 235e-6 * (v0 * v0 - 345 * 345) / (2 * power);
  const double at = to_seconds(plant.time() - start);
  EXPECT_GT(at, 0.9 * hold_up);
  EXPECT_LT(at, 3 * hold_up);
  EXPECT_FALSE(plant.measurements().gates_on);
  EXPECT_EQ(plant.measurements().output_current_a_rms, 0);
}

TEST(DcLink, SagWithoutTripClampsTheOutputAndRecoveryRecharges) {
  PlantConfig config = real_2k2();
  config.comparators = {0, 800, 345, 380};
  config.load.constant_nm = 14.6;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  const double speed = plant.measurements().speed_rpm;
  plant.set_mains({340, {true, true, true}});  // 15 %
  EXPECT_EQ(run(plant, 1s).count, 0u);
  EXPECT_NEAR(plant.measurements().output_voltage_v_rms, plant.measurements().dc_link_v / std::numbers::sqrt2, 1e-6);
  EXPECT_LT(plant.measurements().dc_link_v, 481);
  EXPECT_LT(plant.measurements().speed_rpm, speed - 10);
  const double input_before = plant.measurements().input_power_w;
  plant.set_mains({400, {true, true, true}});
  plant.advance(100us);
  EXPECT_GT(plant.measurements().input_power_w, 5 * input_before);
  EXPECT_EQ(run(plant, 1s).count, 0u);
  EXPECT_NEAR(plant.measurements().speed_rpm, speed, 1);
}

TEST(DcLink, TwoPhasesGiveLowerMeanVoltageAndMoreRippleUnderLoad) {
  PlantConfig config = real_2k2();
  config.load.constant_nm = 7;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  const auto before = plant.measurements();
  plant.set_mains({400, {true, false, true}});
  run(plant, 1s);
  const auto after = plant.measurements();
  EXPECT_LT(after.dc_link_v, before.dc_link_v - 30);
  EXPECT_GT(after.dc_link_v, 0.9 * 400 - 100);
  EXPECT_GT(after.dc_link_ripple_v, 2.5 * before.dc_link_ripple_v);
  // Still the same physics: the input delivers what the drive takes.
  EXPECT_NEAR(after.input_power_w, before.input_power_w, 0.2 * before.input_power_w);
  plant.set_mains({400, {true, false, false}});
  plant.advance(1ms);
  EXPECT_EQ(plant.measurements().input_power_w, 0);
}

TEST(DcLink, ChopperHoldsTheLinkBetweenItsLevels) {
  PlantConfig config = real_2k2(0.15);
  config.dc_link.brake_resistance_ohm = 100;
  config.comparators = {0, 800, 345, 380};
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 5s);
  bool chopped = false;
  for (int tick = 1; tick <= 1000; ++tick) {
    StageInput stage = vf(50 - 0.05 * tick);
    stage.chopper_enabled = true;
    stage.chopper_on_v = 740;
    stage.chopper_off_v = 725;
    plant.set_stage(stage);
    ASSERT_EQ(plant.advance(1ms).count, 0u) << tick;
    ASSERT_LE(plant.measurements().dc_link_v, 740.01) << tick;
    chopped = chopped || plant.measurements().chopper_on;
    if (plant.measurements().chopper_on) {
      ASSERT_NEAR(plant.measurements().brake_power_w, std::pow(plant.measurements().dc_link_v, 2) / 100, 1e-6);
      ASSERT_GE(plant.measurements().dc_link_v, 724.99);
    }
  }
  EXPECT_TRUE(chopped);
  EXPECT_GT(plant.energy().brake_j, 500);  // of the 1850 J of the rotor
}

TEST(DcLink, DisabledChopperOrMissingResistorDoesNotBrake) {
  for (const double resistance : {0.0, 100.0}) {
    PlantConfig config = real_2k2(0.15);
    config.dc_link.brake_resistance_ohm = resistance;
    config.comparators = {0, 800, 345, 380};
    PowerPlant plant(config);
    charge(plant);
    ramp(plant, 0, 50, 5s);
    PowerPlant::Events events;
    for (int tick = 1; tick <= 1000 && events.count == 0; ++tick) {
      StageInput stage = vf(50 - 0.05 * tick);
      stage.chopper_enabled = resistance == 0;
      stage.chopper_on_v = 740;
      stage.chopper_off_v = 725;
      plant.set_stage(stage);
      events = plant.advance(1ms);
    }
    ASSERT_EQ(events.count, 1u);
    EXPECT_EQ(events.items[0].kind, PlantEventKind::kOverVoltage);
    EXPECT_EQ(plant.energy().brake_j, 0);
  }
}

class Comparator : public testing::TestWithParam<SolverChoice> {
 protected:
  SolverSettings solver() const {
    SolverSettings s;
    s.choice = GetParam();
    return s;
  }
};

// Full voltage on the standing machine: the current passes 20 A in the first milliseconds.
TEST_P(Comparator, OverCurrentHasItsOwnTimeAndShutsTheGatesThere) {
  PlantConfig config = real_2k2();
  config.comparators.over_current_a_peak = 20;
  // The same machine without comparator, in steps of 10 us, tells when 20 A are passed.
  PlantConfig free_config = config;
  free_config.comparators.over_current_a_peak = 0;
  PowerPlant free(free_config, solver());
  charge(free);
  free.set_stage(vf(50));
  const Duration start = free.time();
  while (free.measurements().current_peak_a < 20) free.advance(10us);
  const Duration expected = free.time() - start;

  PowerPlant plant(config, solver());
  charge(plant);
  plant.set_stage(vf(50));
  const auto events = plant.advance(5ms);
  ASSERT_EQ(events.count, 1u);
  EXPECT_EQ(events.items[0].kind, PlantEventKind::kOverCurrent);
  EXPECT_NEAR(events.items[0].value, 20, 0.01);
  EXPECT_NEAR(to_seconds(events.items[0].after), to_seconds(expected), 12e-6);
  EXPECT_FALSE(plant.measurements().gates_on);
  EXPECT_EQ(plant.measurements().current_peak_a, 0);
  EXPECT_EQ(plant.measurements().torque_nm, 0);
}

TEST_P(Comparator, GatesStayShutUntilTheCommandWasTakenAway) {
  PlantConfig config = real_2k2();
  config.comparators.over_current_a_peak = 20;
  PowerPlant plant(config, solver());
  charge(plant);
  plant.set_stage(vf(50));
  ASSERT_EQ(plant.advance(5ms).count, 1u);
  plant.set_stage(vf(5));
  EXPECT_EQ(plant.advance(5ms).count, 0u);
  EXPECT_FALSE(plant.measurements().gates_on);
  plant.set_stage({});
  plant.advance(1ms);
  plant.set_stage(vf(5));
  EXPECT_EQ(plant.advance(5ms).count, 0u);
  EXPECT_TRUE(plant.measurements().gates_on);
  EXPECT_GT(plant.measurements().current_peak_a, 0.1);
}

TEST_P(Comparator, OverVoltageIsReportedOnceAndAgainOnlyAfterTheLinkHasFallen) {
  PlantConfig config = lossless_2k2(0.15);
  config.comparators.over_voltage_v = 800;
  PowerPlant plant(config, solver());
  charge(plant);
  ramp(plant, 0, 50, 10s);
  ASSERT_EQ(ramp(plant, 50, 0, 1s).count, 1u);
  EXPECT_EQ(run(plant, 50ms).count, 0u);
  EXPECT_NEAR(plant.measurements().dc_link_v, 800, 0.01);  // nothing discharges a lossless link
  // Taken away and given again: the link is still too high, the comparator acts at once.
  plant.set_stage({});
  plant.advance(1ms);
  plant.set_stage(vf(40));
  const auto again = plant.advance(1ms);
  ASSERT_EQ(again.count, 1u);
  EXPECT_EQ(again.items[0].kind, PlantEventKind::kOverVoltage);
  EXPECT_EQ(again.items[0].after, Duration{});
  EXPECT_FALSE(plant.measurements().gates_on);
}

TEST_P(Comparator, UnderVoltageIsArmedOnlyOnceTheLinkHasBeenUp) {
  PlantConfig config = real_2k2();
  config.comparators = {0, 800, 345, 380};
  config.mains.voltage_v_rms = 200;  // 283 V: below
  PowerPlant plant(config, solver());
  EXPECT_EQ(run(plant, 500ms).count, 0u);
  plant.set_mains({400, {true, true, true}});
  EXPECT_EQ(run(plant, 500ms).count, 0u);
  plant.set_mains({0, {true, true, true}});
  const auto events = run(plant, 3s);
  ASSERT_EQ(events.count, 1u);
  EXPECT_EQ(events.items[0].kind, PlantEventKind::kUnderVoltage);
  EXPECT_EQ(run(plant, 3s).count, 0u);
}

TEST_P(Comparator, AfterTheTripTheMotorCoastsAndItsRotorFluxDecays) {
  PlantConfig config = lossless_2k2();
  config.comparators.over_current_a_peak = 30;
  PowerPlant plant(config, solver());
  charge(plant);
  ramp(plant, 0, 50, 5s);
  const double speed = plant.measurements().speed_rpm;
  plant.set_stage({});
  plant.advance(1ms);
  const double stored = plant.stored_energy_j();
  plant.advance(107ms);  // L_r / R_r
  EXPECT_NEAR(plant.measurements().speed_rpm, speed, 0.001);
  const double lost = stored - plant.stored_energy_j();
  plant.advance(10s);
  const double all = stored - plant.stored_energy_j();
  // Field energy goes with the square of the flux: 1 - exp(-2) of it is gone after one time constant.
  EXPECT_NEAR(lost / all, 1 - std::exp(-2.0), 0.01);
}

std::string solver_name(const testing::TestParamInfo<SolverChoice>& parameter) {
  switch (parameter.param) {
    case SolverChoice::kErk: return "Erk";
    case SolverChoice::kCvodeBdf: return "CvodeBdf";
    case SolverChoice::kRk4: return "Rk4";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Solvers, Comparator,
                         testing::Values(SolverChoice::kErk, SolverChoice::kCvodeBdf, SolverChoice::kRk4), solver_name);

TEST(Inputs, RampsDoNotRestartTheSolverAndJumpsDo) {
  PowerPlant plant(real_2k2());
  charge(plant);
  plant.set_stage(vf(0));
  run(plant, 100ms);
  const auto before = plant.reinitialisations();
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  // Nothing but the shaft breaking away from dry friction.
  EXPECT_EQ(plant.reinitialisations(), before + 1);
  plant.set_stage(vf(45));
  plant.advance(1ms);
  EXPECT_EQ(plant.reinitialisations(), before + 2);
  LoadSettings load = plant.load();
  plant.set_load(load);
  plant.set_mains(plant.mains());
  plant.advance(1ms);
  EXPECT_EQ(plant.reinitialisations(), before + 2);
  load.constant_nm = 7;
  plant.set_load(load);
  plant.advance(1ms);
  EXPECT_EQ(plant.reinitialisations(), before + 3);
}

// One long advance equals many short ones: what a look-ahead needs.
TEST(Inputs, LongAdvanceEqualsManyTicks) {
  for (const auto choice : {SolverChoice::kErk, SolverChoice::kCvodeBdf, SolverChoice::kRk4}) {
    SolverSettings settings;
    settings.choice = choice;
    PowerPlant ticks(real_2k2(), settings), leap(real_2k2(), settings);
    for (auto* plant : {&ticks, &leap}) {
      charge(*plant);
      ramp(*plant, 0, 50, 1s);
      LoadSettings load = plant->load();
      load.constant_nm = 14.6;
      plant->set_load(load);
    }
    run(ticks, 237ms);
    leap.advance(237ms);
    EXPECT_EQ(ticks.time(), leap.time());
    EXPECT_NEAR(ticks.measurements().speed_rpm, leap.measurements().speed_rpm, 0.05);
    EXPECT_NEAR(ticks.measurements().torque_nm, leap.measurements().torque_nm, 0.015);
    EXPECT_NEAR(ticks.measurements().dc_link_v, leap.measurements().dc_link_v, 0.1);
    EXPECT_NEAR(ticks.energy().from_mains_j, leap.energy().from_mains_j, 1e-4 * ticks.energy().from_mains_j);
    // Odd lengths, down to single nanoseconds.
    for (const auto dt : {Duration{1}, Duration{3}, Duration{999'999}, Duration{0}}) leap.advance(dt);
    EXPECT_NEAR(leap.measurements().speed_rpm, ticks.measurements().speed_rpm, 1);
  }
}

TEST(Inputs, SmallTickStepsOfAnyLengthArriveAtTheTickEnd) {
  PowerPlant plant(lossless_2k2());
  charge(plant);
  plant.set_stage(vf(10));
  plant.advance(1ms);
  plant.set_stage(vf(10.1));
  plant.advance(250us);
  EXPECT_NEAR(plant.measurements().output_voltage_v_rms, vf(10.1).voltage_peak_v * std::sqrt(1.5), 1e-9);
  plant.set_stage(vf(10.2));
  plant.advance(10ms);
  EXPECT_NEAR(plant.measurements().output_voltage_v_rms, vf(10.2).voltage_peak_v * std::sqrt(1.5), 1e-9);
}

TEST(Thermal, TemperaturesApproachTheirSteadyStateExponentially) {
  PlantConfig config = real_2k2();
  config.ambient_c = 30;
  config.thermal.heat_sink_time_constant_s = 3;
  config.thermal.winding_time_constant_s = 9;
  config.load.constant_nm = 10;
  PowerPlant plant(config);
  charge(plant);
  EXPECT_NEAR(plant.measurements().heat_sink_c, 30, 1e-6);
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  const auto m0 = plant.measurements();
  const double inverter_w = 0.03 * std::numbers::sqrt3 * m0.output_voltage_v_rms * m0.output_current_a_rms;
  const double winding_end = 30 + 80 * std::pow(m0.output_current_a_rms / 5.0, 2);
  plant.advance(3s);
  const auto m1 = plant.measurements();
  const double heat_sink_end = 30 + 0.5 * inverter_w;
  EXPECT_NEAR(m1.heat_sink_c, heat_sink_end + (m0.heat_sink_c - heat_sink_end) * std::exp(-1.0), 0.05);
  EXPECT_NEAR(m1.winding_c, winding_end + (m0.winding_c - winding_end) * std::exp(-3.0 / 9), 0.1);
  plant.set_ambient(50);
  plant.advance(60s);
  EXPECT_NEAR(plant.measurements().heat_sink_c, heat_sink_end + 20, 0.05);
}

}  // namespace
}  // namespace vinv::plant::test
