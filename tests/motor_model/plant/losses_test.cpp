// Losses: typical sizes, and a power balance that closes. What comes from the mains is either lost somewhere that is
// counted, delivered to the load, or stored.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/motor_model/plant/plants.hpp"

namespace vinv::plant::test {
namespace {

double spent(const EnergyCounters& e) {
  return e.stator_copper_j + e.rotor_copper_j + e.iron_j + e.inverter_j + e.standby_j + e.source_resistance_j +
         e.brake_j + e.friction_j + e.load_j;
}

// Part of the energy from the mains that is unaccounted for.
double imbalance(const PowerPlant& plant) {
  return std::abs(plant.energy().from_mains_j - spent(plant.energy()) - plant.stored_energy_j()) /
         plant.energy().from_mains_j;
}

class PowerBalance : public testing::TestWithParam<SolverChoice> {
 protected:
  PowerPlant make(PlantConfig config) const {
    SolverSettings settings;
    settings.choice = GetParam();
    return PowerPlant(std::move(config), settings);
  }
};

TEST_P(PowerBalance, ClosesOverChargingRampLoadStepAndBraking) {
  PlantConfig config = real_2k2(0.06);
  config.dc_link.brake_resistance_ohm = 100;
  config.load.quadratic_nm_s2 = 1e-4;
  config.load.linear_nm_s = 0.005;
  PowerPlant plant = make(config);
  charge(plant);
  EXPECT_LT(imbalance(plant), 1e-3);
  ramp(plant, 0, 50, 3s);
  EXPECT_LT(imbalance(plant), 1e-3);
  LoadSettings load = config.load;
  load.constant_nm = 10;
  plant.set_load(load);
  run(plant, 2s);
  EXPECT_LT(imbalance(plant), 1e-3);
  const double before = plant.energy().brake_j;
  for (int tick = 1; tick <= 500; ++tick) {
    StageInput stage = vf(50 - 0.1 * tick);
    stage.chopper_enabled = true;
    stage.chopper_on_v = 740;
    stage.chopper_off_v = 725;
    plant.set_stage(stage);
    ASSERT_EQ(plant.advance(1ms).count, 0u);
  }
  EXPECT_GT(plant.energy().brake_j, before + 20);
  EXPECT_LT(imbalance(plant), 1e-3);
  // Each counter has counted.
  const auto& e = plant.energy();
  for (const double joules : {e.stator_copper_j, e.rotor_copper_j, e.iron_j, e.inverter_j, e.standby_j,
                              e.source_resistance_j, e.brake_j, e.friction_j, e.load_j}) {
    EXPECT_GT(joules, 1);
  }
}

TEST_P(PowerBalance, ClosesOverTripLockedShaftAndTwoPhases) {
  PlantConfig config = real_2k2();
  config.comparators = {20, 800, 345, 380};
  PowerPlant plant = make(config);
  charge(plant);
  ramp(plant, 0, 30, 1s);
  plant.set_shaft_locked(true);
  bool tripped = false;
  for (int tick = 0; tick < 300; ++tick) tripped = plant.advance(1ms).count > 0 || tripped;
  EXPECT_TRUE(tripped);
  EXPECT_LT(imbalance(plant), 1e-3);
  plant.set_shaft_locked(false);
  plant.set_stage({});
  run(plant, 500ms);
  plant.set_mains({400, {false, true, true}});
  ramp(plant, 0, 30, 3s);
  EXPECT_GT(plant.measurements().speed_rpm, 850);
  EXPECT_LT(imbalance(plant), 1e-3);
}

// The same in powers at a working point, which the drive shows its user.
TEST_P(PowerBalance, MeasuredPowersAgreeInSteadyState) {
  PlantConfig config = real_2k2();
  config.load.constant_nm = 10;
  PowerPlant plant = make(config);
  charge(plant);
  ramp(plant, 0, 50, 2s);
  run(plant, 2s);
  const auto& m = plant.measurements();
  const auto before = plant.energy();
  const double stored = plant.stored_energy_j();
  run(plant, 1s);
  EXPECT_NEAR(plant.stored_energy_j(), stored, 1e-2);
  EXPECT_NEAR(plant.energy().from_mains_j - before.from_mains_j, m.input_power_w, 1e-4 * m.input_power_w);
  EXPECT_NEAR(m.shaft_power_w, 10 * m.speed_rpm * std::numbers::pi / 30, 1e-3 * m.shaft_power_w);
  EXPECT_NEAR(m.output_power_w, std::sqrt(3) * m.output_voltage_v_rms * m.active_current_a_rms,
              1e-9 * m.output_power_w);
  const double copper =
      plant.energy().stator_copper_j - before.stator_copper_j + plant.energy().rotor_copper_j - before.rotor_copper_j;
  const double friction = plant.energy().friction_j - before.friction_j;
  EXPECT_NEAR(m.output_power_w, m.shaft_power_w + copper + friction, 1e-3 * m.output_power_w);
}

TEST_P(PowerBalance, ClosesWhereCarrierAndCoolingChange) {
  PlantConfig config = real_2k2();
  config.load.constant_nm = 10;
  PowerPlant plant = make(config);
  charge(plant);
  ramp(plant, 0, 50, 2s);
  run(plant, 1s);
  const auto loss_w = [&] {
    const double before = plant.energy().inverter_j;
    run(plant, 1s);
    return plant.energy().inverter_j - before;
  };
  const double at_1_khz = loss_w();
  plant.set_cooling(3);
  plant.set_carrier(14'500);
  EXPECT_NEAR(loss_w(), 2.35 * at_1_khz, 0.01 * at_1_khz);
  EXPECT_LT(imbalance(plant), 1e-3);
  plant.set_carrier(700);
  EXPECT_NEAR(loss_w(), 0.97 * at_1_khz, 0.01 * at_1_khz);
  EXPECT_LT(imbalance(plant), 1e-3);
}

std::string solver_name(const testing::TestParamInfo<SolverChoice>& parameter) {
  switch (parameter.param) {
    case SolverChoice::kErk: return "Erk";
    case SolverChoice::kCvodeBdf: return "CvodeBdf";
    case SolverChoice::kRk4: return "Rk4";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Solvers, PowerBalance,
                         testing::Values(SolverChoice::kErk, SolverChoice::kCvodeBdf, SolverChoice::kRk4), solver_name);

// The over-voltage sweep trips here at 1.01 s without losses; a real motor absorbs this little power.
TEST(Deceleration, SlowUnloadedRampTripsOnlyWithoutLosses) {
  for (const bool losses : {false, true}) {
    PlantConfig config = losses ? real_2k2(0.06) : lossless_2k2(0.06);
    config.comparators.over_voltage_v = 800;
    PowerPlant plant(config);
    charge(plant);
    ramp(plant, 0, 50, 10s);
    run(plant, 1s);
    const auto events = ramp(plant, 50, 0, 10s);
    EXPECT_EQ(events.count, losses ? 0u : 1u);
    if (losses) {
      run(plant, 1s);
      EXPECT_EQ(plant.measurements().speed_rpm, 0);
    }
  }
}

// Losses do not make a fast stop of a large inertia harmless.
TEST(Deceleration, FastStopOfLargeInertiaStillTrips) {
  PlantConfig config = real_2k2(0.15);
  config.comparators.over_voltage_v = 800;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 5s);
  run(plant, 1s);
  const Duration start = plant.time();
  ASSERT_EQ(ramp(plant, 50, 0, 1s).count, 1u);
  EXPECT_GT(to_seconds(plant.time() - start), 0.0496);  // later than without losses
  EXPECT_LT(to_seconds(plant.time() - start), 0.1);
}

TEST(TypicalLosses, LieInTheBandsOfRealDrives) {
  for (const auto name : machine_names()) {
    const MachineParameters& machine = *find_machine(name);
    const LossSettings losses = typical_losses(machine);
    const double omega = machine.rated_speed_rpm * std::numbers::pi / 30;
    const double friction_w = (losses.viscous_nm_s * omega + losses.coulomb_nm) * omega;
    const double constant = (losses.iron_loss_w_at_rated + friction_w) / machine.rated_power_w;
    EXPECT_GT(constant, 0.004) << name;
    EXPECT_LT(constant, 0.16) << name;
    EXPECT_GE(losses.inverter_loss_fraction, 0.02);
    EXPECT_LE(losses.inverter_loss_fraction, 0.04);
    EXPECT_GE(losses.standby_w, 20);
    EXPECT_LE(losses.standby_w, 40);
  }
  // The measured 18.5 kW motor: 410 W iron, 180 W friction.
  const LossSettings measured = typical_losses(*find_machine("modelica_imc_18k5"));
  EXPECT_NEAR(measured.iron_loss_w_at_rated, 410, 0.25 * 410);
}

TEST(HeatSink, WithoutFanItIsHotterAndCoolsSlowerByTheSameFactor) {
  PlantConfig config = lossless_2k2();
  config.losses.inverter_loss_fraction = 0.03;
  config.thermal.heat_sink_k_per_w = 0.3;
  config.thermal.heat_sink_time_constant_s = 5;
  config.load.constant_nm = 10;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 1s);
  const auto& m = plant.measurements();
  run(plant, 60s);
  const double rise_k = m.heat_sink_c - 25;
  EXPECT_GT(rise_k, 10);
  const auto restarts = plant.reinitialisations();
  plant.set_cooling(3);
  run(plant, 15s);
  EXPECT_NEAR(m.heat_sink_c - 25, rise_k * (3 - 2 / std::numbers::e), 0.02 * rise_k);
  EXPECT_EQ(plant.reinitialisations(), restarts);
  plant.set_stage({});
  const double hot_k = m.heat_sink_c - 25;
  run(plant, 15s);
  EXPECT_NEAR(m.heat_sink_c - 25, hot_k / std::numbers::e, 0.02 * hot_k);
}

TEST(TypicalLosses, IronLossIsTheSettingAtRatedVoltageAndFrequency) {
  PlantConfig config = lossless_2k2();
  config.losses.iron_loss_w_at_rated = 100;
  config.nominal_mains_v_rms = config.mains.voltage_v_rms = 420;  // head-room for the full 400 V
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 2s);
  run(plant, 1s);
  const double before = plant.energy().iron_j;
  run(plant, 1s);
  EXPECT_NEAR(plant.energy().iron_j - before, 100, 2);  // the flux is 1 % below U / omega at no load
  plant.set_stage({});
  plant.advance(1ms);
  const double off = plant.energy().iron_j;
  run(plant, 100ms);
  EXPECT_EQ(plant.energy().iron_j, off);
}

}  // namespace
}  // namespace vinv::plant::test
