// A motor on the inverter, the mains, a voltage table or nothing, and what happens when it changes over.
#include <gtest/gtest.h>

#include <numbers>

#include "motor_model/plant/machine_steady.hpp"
#include "tests/motor_model/plant/plants.hpp"

namespace vinv::plant::test {
namespace {

constexpr double kLineRms = 1.2247448713915890;  // line to line rms of a phase peak

double largest_current(PowerPlant& plant, Duration duration) {
  double largest = 0;
  for (Duration t{}; t < duration; t += 1ms) {
    plant.advance(1ms);
    largest = std::max(largest, plant.measurements().motor_current_a_rms);
  }
  return largest;
}

TEST(MotorSource, OnTheMainsTheMotorRunsAtItsSteadyPointWhateverTheInverterDoes) {
  PowerPlant plant(lossless_2k2());
  plant.set_motor_source(MotorSource::kMains);
  charge(plant);
  LoadSettings load = plant.load();
  load.constant_nm = 14.6;
  plant.set_load(load);
  plant.set_stage(vf(20));
  run(plant, 2s);
  const MachineModel machine(plant.config().machine);
  const double omega = 2 * std::numbers::pi * 50;
  const SteadyPoint expected =
      steady_point(machine, phase_peak(400), omega, slip_for_torque(machine, phase_peak(400), omega, 14.6));
  const auto& m = plant.measurements();
  EXPECT_NEAR(m.motor_current_a_rms, expected.current_a_rms, 1e-3);
  EXPECT_NEAR(m.speed_rpm, 1500 * (1 - expected.slip), 0.05);
  EXPECT_NEAR(m.input_power_w, expected.input_power_w, 0.5);
  EXPECT_NEAR(m.motor_voltage_v_rms, 400, 1e-9);
  // The stage runs with nothing behind it.
  EXPECT_EQ(m.output_current_a_rms, 0);
  EXPECT_EQ(m.current_peak_a, 0);
  EXPECT_EQ(m.output_power_w, 0);
  EXPECT_TRUE(m.gates_on);
  EXPECT_NEAR(m.output_voltage_v_rms, vf(20).voltage_peak_v * kLineRms, 1e-6);
}

TEST(MotorSource, TheComparatorDoesNotSeeAMotorOnTheMains) {
  PlantConfig config = lossless_2k2();
  config.comparators.over_current_a_peak = 15;
  PowerPlant plant(config);
  charge(plant);
  plant.set_stage(vf(50));
  EXPECT_EQ(plant.advance(20ms).count, 1u);
  plant.set_stage({});
  plant.advance(1ms);
  plant.set_motor_source(MotorSource::kMains);
  plant.set_stage(vf(50));
  EXPECT_EQ(run(plant, 500ms).count, 0u);
  EXPECT_GT(plant.measurements().speed_rpm, 1450);
}

// Without load and losses the rotor goes on in step with the mains, and its flux with it: closing again finds it in
// phase after any short time; what has decayed of it comes back.
TEST(MotorSource, ARotorInStepIsTakenOverWithoutInrushAfterAnyPause) {
  for (const Duration pause : {1ms, 4ms, 7ms, 10ms, 13ms, 20ms}) {
    PlantConfig config = lossless_2k2();
    config.mains_frequency_hz = 60;
    config.mains_phase_rad = 1;
    config.mains.voltage_v_rms = 480;
    PowerPlant plant(config);
    plant.set_motor_source(MotorSource::kMains);
    const double of_a_start = largest_current(plant, 3s);
    plant.set_motor_source(MotorSource::kOpen);
    run(plant, pause);
    EXPECT_EQ(plant.measurements().motor_current_a_rms, 0);
    EXPECT_GT(plant.measurements().motor_voltage_v_rms, 150);
    plant.set_motor_source(MotorSource::kMains);
    EXPECT_LT(largest_current(plant, 30ms), 0.3 * of_a_start) << pause.count();
  }
}

// The same machine, fed by a stage that runs at mains frequency, put on mains of eight phases.
TEST(MotorSource, TheInrushDependsOnThePhaseAtClosing) {
  double smallest = 1e9, largest = 0, smallest_phase = 0, largest_phase = 0;
  for (int k = 0; k < 8; ++k) {
    PlantConfig config = lossless_2k2();
    config.mains.voltage_v_rms = 450;
    config.mains_phase_rad = k * std::numbers::pi / 4;
    PowerPlant plant(config);
    charge(plant);
    ramp(plant, 0, 50, 2s);
    run(plant, 2s);
    plant.set_motor_source(MotorSource::kMains);
    const double current = largest_current(plant, 30ms);
    if (current < smallest) smallest = current, smallest_phase = config.mains_phase_rad;
    if (current > largest) largest = current, largest_phase = config.mains_phase_rad;
  }
  EXPECT_LT(smallest, 12);
  EXPECT_GT(largest, 40);
  EXPECT_NEAR(std::abs(smallest_phase - largest_phase), std::numbers::pi, 1e-9);
}

TEST(MotorSource, TheResidualVoltageDecaysWithTheRotorTimeConstant) {
  PowerPlant plant(lossless_2k2(10));
  charge(plant);
  ramp(plant, 0, 50, 2s);
  plant.set_shaft_locked(false);
  run(plant, 60s);
  plant.set_motor_source(MotorSource::kOpen);
  plant.advance(1ms);
  const double at_once = plant.measurements().motor_voltage_v_rms;
  EXPECT_GT(at_once, 350);
  EXPECT_LT(at_once, 400);
  const auto& m = plant.config().machine;
  const double time_constant_s = (m.L_m_h + m.L_lr_h) / m.R_r_ohm;
  plant.advance(seconds_to_duration(time_constant_s));
  EXPECT_NEAR(plant.measurements().motor_voltage_v_rms, at_once * std::exp(-1), 0.01 * at_once);
}

TEST(MotorSource, EnergyIsAccountedForThroughEveryChange) {
  PlantConfig config = real_2k2();
  config.voltage_table = {{0, 0, 0}, {0.05, 100, 0}, {0.06, 0, -100}};
  PowerPlant plant(config);
  charge(plant);
  ramp(plant, 0, 40, 1s);
  for (const MotorSource source :
       {MotorSource::kMains, MotorSource::kOpen, MotorSource::kTable, MotorSource::kMains, MotorSource::kInverter}) {
    plant.set_motor_source(source);
    plant.set_stage(source == MotorSource::kInverter ? StageInput{} : vf(40));
    run(plant, 300ms);
    const EnergyCounters& e = plant.energy();
    const double spent = e.stator_copper_j + e.rotor_copper_j + e.iron_j + e.inverter_j + e.standby_j +
                         e.source_resistance_j + e.brake_j + e.friction_j + e.load_j + plant.stored_energy_j();
    EXPECT_NEAR(spent, e.from_mains_j, 2e-3 * e.from_mains_j) << static_cast<int>(source);
  }
}

TEST(MotorSource, DeadMainsLeaveTheStatorOpenAndTakeItAgainWhenTheyReturn) {
  PowerPlant plant(lossless_2k2());
  plant.set_motor_source(MotorSource::kMains);
  run(plant, 1s);
  plant.set_line(0);
  run(plant, 100ms);
  EXPECT_EQ(plant.measurements().motor_current_a_rms, 0);
  EXPECT_EQ(plant.measurements().torque_nm, 0);
  plant.set_line(380);
  run(plant, 1s);
  EXPECT_NEAR(plant.measurements().motor_voltage_v_rms, 380, 1e-9);
  EXPECT_GT(plant.measurements().motor_current_a_rms, 2);
}

// A vector that stands still for longer than any time constant: direct current U / R_s, and a brake.
TEST(MotorSource, TheTableHoldsItsVectorUntilTheNextRow) {
  PlantConfig config = lossless_2k2();
  config.voltage_table = {{0, 0, 0}, {0.0100005, 30, 40}, {2, -37, 0}};
  PowerPlant plant(config);
  plant.advance(1s);
  plant.set_motor_source(MotorSource::kTable);
  plant.advance(10ms);
  EXPECT_EQ(plant.measurements().motor_current_a_rms, 0);
  plant.advance(1ms);
  EXPECT_GT(plant.measurements().motor_current_a_rms, 0);
  plant.advance(1980ms);
  EXPECT_NEAR(plant.measurements().motor_voltage_v_rms, 50 * kLineRms, 1e-9);
  EXPECT_NEAR(plant.measurements().motor_current_a_rms * std::numbers::sqrt2, 50 / 3.7, 3e-3);
  plant.advance(5s);
  EXPECT_NEAR(plant.measurements().motor_current_a_rms * std::numbers::sqrt2, 10, 3e-3);
}

TEST(MotorSource, ATableThatCannotBeIsRefused) {
  const auto refusal = [](std::vector<VoltagePoint> table) {
    PlantConfig config = lossless_2k2();
    config.voltage_table = std::move(table);
    const auto ok = validate(config);
    return ok ? std::string() : ok.error();
  };
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({{0, 1, 2}}), "");
  EXPECT_EQ(refusal({{0.1, 1, 2}}), "voltage table point 1: time_s is 0.1 s; the first point must be at 0 s");
  EXPECT_EQ(refusal({{0, 1, 2}, {0, 1, 2}}),
            "voltage table point 2: time_s is 0 s; it must be later than the point before");
  EXPECT_EQ(refusal({{0, 1, 2e5}}),
            "voltage table point 1: beta_v is 200000 V; it must be between -100000 and 100000 V");
}

}  // namespace
}  // namespace vinv::plant::test
