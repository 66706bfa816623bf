// Dry, hoist and table loads, standstill and the locked shaft.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/motor_model/plant/plants.hpp"

namespace vinv::plant::test {
namespace {

constexpr double kRpm = 30 / std::numbers::pi;

TEST(Shaft, DryLoadHoldsTheShaftUntilTheMotorIsStronger) {
  PlantConfig config = lossless_2k2();
  config.load.constant_nm = 10;
  PowerPlant plant(config);
  charge(plant);
  plant.set_stage(vf(0.5));
  run(plant, 500ms);
  const auto& m = plant.measurements();
  EXPECT_EQ(m.speed_rpm, 0);
  EXPECT_GT(m.torque_nm, 0.5);
  EXPECT_LT(m.torque_nm, 10);
  EXPECT_NEAR(m.load_torque_nm, m.torque_nm, 1e-9);
  ramp(plant, 0.5, 10, 500ms);
  run(plant, 1s);
  EXPECT_GT(m.speed_rpm, 150);
  EXPECT_NEAR(m.torque_nm, 10, 0.1);
  // Coasting, 10 Nm bring it to rest in J omega / T, and there it stays: no chatter, no restarts.
  const double rest_s = 0.015 * m.speed_rpm / kRpm / 10;
  plant.set_stage({});
  plant.advance(seconds_to_duration(rest_s * 0.98));
  EXPECT_GT(m.speed_rpm, 0);
  plant.advance(seconds_to_duration(rest_s * 0.04));
  EXPECT_EQ(m.speed_rpm, 0);
  const auto restarts = plant.reinitialisations();
  run(plant, 1s);
  EXPECT_EQ(m.speed_rpm, 0);
  EXPECT_EQ(plant.reinitialisations(), restarts);
}

TEST(Shaft, AHeldShaftTurnsWhenItsLoadIsTakenAway) {
  PlantConfig config = lossless_2k2();
  config.load.constant_nm = 100;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0.5, 10, 500ms);
  run(plant, 500ms);
  const auto& m = plant.measurements();
  ASSERT_EQ(m.speed_rpm, 0);
  ASSERT_GT(m.torque_nm, 10);
  LoadSettings load = config.load;
  load.constant_nm = 5;
  plant.set_load(load);
  run(plant, 500ms);
  EXPECT_GT(m.speed_rpm, 200);
}

// The motor's torque swings around what the load can hold: the shaft may move, but never against the motor.
TEST(Shaft, TorqueNearTheHoldingTorqueNeverTurnsTheShaftBackwards) {
  const auto start = [](PowerPlant& plant) {
    charge(plant);
    StageInput stage = vf(2);
    stage.voltage_peak_v = 30;
    plant.set_stage(stage);
  };
  PlantConfig config = lossless_2k2();
  config.load.constant_nm = 100;
  PowerPlant held(config);
  start(held);
  double peak_nm = 0;
  for (int n = 0; n < 5000; ++n) {
    held.advance(200us);
    peak_nm = std::max(peak_nm, held.measurements().torque_nm);
  }
  EXPECT_EQ(held.measurements().speed_rpm, 0);
  const double steady_nm = held.measurements().torque_nm;
  for (const double load_nm :
       {peak_nm * 0.9999999, peak_nm / 1.0010001, peak_nm * 0.998, steady_nm * 1.0001, steady_nm}) {
    config.load.constant_nm = load_nm;
    PowerPlant plant(config);
    start(plant);
    for (int n = 0; n < 2000; ++n) {
      plant.advance(1ms);
      ASSERT_GE(plant.measurements().speed_rpm, -1e-9) << load_nm << " Nm after " << n << " ms";
      ASSERT_LE(plant.measurements().speed_rpm, 60) << load_nm;
    }
  }
}

TEST(Shaft, DryLoadOpposesReverseRotationToo) {
  PlantConfig config = lossless_2k2();
  config.load.constant_nm = 5;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, -20, 2s);
  run(plant, 1s);
  EXPECT_LT(plant.measurements().speed_rpm, -500);
  EXPECT_NEAR(plant.measurements().torque_nm, -5, 0.05);
  EXPECT_NEAR(plant.measurements().load_torque_nm, -5, 1e-9);
  // Through standstill to the other side.
  ramp(plant, -20, 20, 4s);
  run(plant, 1s);
  EXPECT_GT(plant.measurements().speed_rpm, 500);
  EXPECT_NEAR(plant.measurements().load_torque_nm, 5, 1e-9);
}

TEST(Shaft, HoistFallsBackWhenTheGatesAreShut) {
  PlantConfig config = lossless_2k2();
  config.load.hoist_nm = 3;
  PowerPlant plant(config);
  charge(plant);
  const double fallen = plant.measurements().speed_rpm / kRpm;
  EXPECT_NEAR(fallen, -3 / 0.015 * 1.0, 0.01);  // for one second
}

TEST(Shaft, LockedShaftStandsAndTurnsAgainWhenFreed) {
  PowerPlant plant(real_2k2());
  charge(plant);
  ramp(plant, 0, 20, 1s);
  const double moving = 0.5 * 0.015 * std::pow(plant.measurements().speed_rpm / kRpm, 2);
  const double before = plant.energy().load_j;
  plant.set_shaft_locked(true);
  run(plant, 500ms);
  EXPECT_TRUE(plant.shaft_locked());
  EXPECT_EQ(plant.measurements().speed_rpm, 0);
  EXPECT_GT(plant.measurements().torque_nm, 10);
  EXPECT_NEAR(plant.energy().load_j - before, moving, 1e-6);
  plant.set_shaft_locked(false);
  run(plant, 2s);
  EXPECT_NEAR(plant.measurements().speed_rpm, 600, 10);
}

TEST(Shaft, LoadTableIsFollowedWithStepsAndHeldAtItsEnd) {
  PlantConfig config = lossless_2k2();
  config.load.table = {{4, 0}, {5, 10}, {6, 10}, {6, 2}, {7, 2}};
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 50, 2s);
  const auto at = [&](Duration t) {
    plant.advance(t - plant.time());
    return plant.measurements().load_torque_nm;
  };
  EXPECT_NEAR(at(3900ms), 0, 1e-9);
  EXPECT_NEAR(at(4500ms), 5, 1e-9);
  EXPECT_NEAR(at(5500ms), 10, 1e-9);
  const auto restarts = plant.reinitialisations();
  EXPECT_NEAR(at(5999ms), 10, 1e-9);
  EXPECT_NEAR(at(6001ms), 2, 1e-9);
  EXPECT_EQ(plant.reinitialisations(), restarts + 1);
  EXPECT_NEAR(at(20s), 2, 1e-9);
  EXPECT_NEAR(plant.measurements().torque_nm, 2, 0.01);
}

TEST(Shaft, OverhaulingTableDrivesTheMotorAndRegenerates) {
  PlantConfig config = real_2k2();
  config.dc_link.brake_resistance_ohm = 100;
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 40, 2s);
  LoadSettings load = config.load;
  load.table = {{3.5, 0}, {4, -12}};
  plant.set_load(load);
  StageInput stage = vf(40);
  stage.chopper_enabled = true;
  stage.chopper_on_v = 740;
  stage.chopper_off_v = 725;
  plant.set_stage(stage);
  run(plant, 3s);
  EXPECT_GT(plant.measurements().speed_rpm, 1200);
  EXPECT_LT(plant.measurements().active_current_a_rms, 0);
  EXPECT_LT(plant.measurements().output_power_w, 0);
  EXPECT_GT(plant.energy().brake_j, 100);
}

}  // namespace
}  // namespace vinv::plant::test
