// Same inputs, same bytes; snapshots that continue; ticks that do not allocate.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/bench/allocation_count.hpp"
#include "tests/motor_model/plant/plants.hpp"

namespace vinv::plant::test {
namespace {

PlantConfig busy_config() {
  PlantConfig config = real_2k2(0.06);
  config.dc_link.brake_resistance_ohm = 100;
  config.comparators = {40, 800, 345, 380};
  config.load.constant_nm = 3;
  config.load.table = {{1.5, 0}, {2.5, 8}, {2.5, 2}};
  config.voltage_table = {{0, 20, 0}, {0.0051234, 0, 25}, {0.0302, -30, 10}, {0.04, 0, 0}};
  return config;
}

StageInput busy_stage(int tick) {
  StageInput stage = vf(std::min({50.0, tick * 0.05, std::max(0.0, 50 - (tick - 2000) * 0.1)}));
  stage.chopper_enabled = true;
  stage.chopper_on_v = 740;
  stage.chopper_off_v = 725;
  return stage;
}

void disturb(PowerPlant& plant, int tick) {
  if (tick == 700) plant.set_mains({400, {true, true, false}});
  if (tick == 900) plant.set_mains({400, {true, true, true}});
  if (tick == 1200) plant.set_shaft_locked(true);
  if (tick == 1230) plant.set_shaft_locked(false);
  if (tick == 1300) plant.set_ambient(40);
  if (tick == 1350) plant.set_carrier(8000);
  if (tick == 1350) plant.set_cooling(2);
  if (tick == 2450) plant.set_motor_source(MotorSource::kMains);
  if (tick == 2480) plant.set_line(200);
  if (tick == 2500) plant.set_motor_source(MotorSource::kTable);
  if (tick == 2550) plant.set_motor_source(MotorSource::kOpen);
  if (tick == 2570) plant.set_motor_source(MotorSource::kInverter);
}

std::string bytes_of(PowerPlant& plant) {
  const Bytes bytes = save_snapshot(plant);
  return {bytes.begin(), bytes.end()};
}

void restore(PowerPlant& plant, const Bytes& snapshot) {
  const auto ok = load_snapshot(plant, snapshot);
  ASSERT_TRUE(ok.has_value()) << ok.error();
}

class Reproducibility : public testing::TestWithParam<SolverChoice> {
 protected:
  PowerPlant make() const {
    SolverSettings settings;
    settings.choice = GetParam();
    return PowerPlant(busy_config(), settings);
  }
};

TEST_P(Reproducibility, TwoRunsAreByteIdentical) {
  std::string traces[2];
  for (auto& trace : traces) {
    PowerPlant plant = make();
    charge(plant);
    for (int tick = 1; tick <= 2600; ++tick) {
      plant.set_stage(busy_stage(tick));
      disturb(plant, tick);
      const auto events = plant.advance(1ms);
      trace.append(reinterpret_cast<const char*>(&events.count), sizeof events.count);
      if (tick % 10 == 0) trace += bytes_of(plant);
    }
  }
  EXPECT_TRUE(traces[0] == traces[1]);
}

// Snapshots at quiet and at busy instants; the run that goes on restarts its solver there, as the restored one must.
TEST_P(Reproducibility, RestoredPlantContinuesIdentically) {
  for (const int at : {0, 1, 333, 750, 1215, 1700, 2105, 2300, 2470, 2490, 2500, 2515, 2555, 2575}) {
    PowerPlant first = make();
    charge(first);
    for (int tick = 1; tick <= at; ++tick) {
      first.set_stage(busy_stage(tick));
      disturb(first, tick);
      first.advance(1ms);
    }
    first.restart_solver();
    PowerPlant second = make();
    EXPECT_TRUE(first.starts_anew());
    restore(second, save_snapshot(first));
    EXPECT_TRUE(bytes_of(first) == bytes_of(second)) << at;
    for (int tick = at + 1; tick <= at + 400; ++tick) {
      for (auto* plant : {&first, &second}) {
        plant->set_stage(busy_stage(tick));
        disturb(*plant, tick);
        plant->advance(1ms);
      }
    }
    EXPECT_EQ(first.time(), second.time());
    EXPECT_TRUE(bytes_of(first) == bytes_of(second)) << at;
  }
}

// Between set_stage() and advance() too: the step or ramp still to come is part of the state.
TEST_P(Reproducibility, SnapshotBetweenInputAndAdvanceKeepsTheInput) {
  for (const double next_hz : {20.02, 45.0}) {
    PowerPlant first = make();
    charge(first);
    ramp(first, 0, 20, 500ms);
    first.set_stage(vf(next_hz));
    first.restart_solver();
    PowerPlant second = make();
    restore(second, save_snapshot(first));
    first.advance(1ms);
    second.advance(1ms);
    EXPECT_TRUE(bytes_of(first) == bytes_of(second)) << next_hz;
  }
}

TEST_P(Reproducibility, RestoringDoesNotDependOnWhatThePlantDidBefore) {
  PowerPlant first = make();
  charge(first);
  ramp(first, 0, 20, 500ms);
  const Bytes state = save_snapshot(first);
  PowerPlant second = make();
  charge(second);
  ramp(second, 0, -50, 2s);
  second.set_load({});
  second.set_mains({230, {true, true, false}});
  second.set_shaft_locked(true);
  second.advance(3ms);
  restore(first, state);
  restore(second, state);
  for (auto* plant : {&first, &second}) ramp(*plant, 20, 30, 300ms);
  EXPECT_TRUE(bytes_of(first) == bytes_of(second));
}

TEST_P(Reproducibility, AnotherCircuitMotorOrSolverRefusesTheSnapshot) {
  PowerPlant first = make();
  charge(first);
  const Bytes state = save_snapshot(first);
  SolverSettings settings;
  settings.choice = GetParam();
  for (const int other : {0, 1, 2, 3, 4, 5}) {
    PlantConfig config = busy_config();
    SolverSettings s = settings;
    if (other == 0) config.machine = *find_machine("iec4p_1k5kW_400V");
    if (other == 1) config.dc_link.capacitance_f *= 1.01;
    if (other == 2) config.losses.coulomb_nm = 1;
    if (other == 3) s.relative_tolerance = 1e-6;
    if (other == 4) config.voltage_table[1].beta_v = 26;
    if (other == 5) config.mains_frequency_hz = 60;
    PowerPlant plant(config, s);
    const Bytes before = save_snapshot(plant);
    const auto ok = load_snapshot(plant, state);
    ASSERT_FALSE(ok.has_value()) << other;
    EXPECT_NE(ok.error().find(other == 0 ? "of another motor: " : "of another motor, power circuit or solver"),
              std::string::npos)
        << ok.error();
    EXPECT_EQ(save_snapshot(plant), before);
  }
}

TEST_P(Reproducibility, TicksDoNotAllocate) {
  const auto at_start = vinv::test::allocation_count();
  PowerPlant plant = make();
  EXPECT_GT(vinv::test::allocation_count(), at_start);  // the counter counts
  charge(plant);
  const LoadSettings load = plant.load();
  const auto before = vinv::test::allocation_count();
  std::uint64_t restarts = plant.reinitialisations();
  for (int tick = 1; tick <= 2600; ++tick) {
    plant.set_stage(busy_stage(tick));
    disturb(plant, tick);
    plant.set_load(load);
    plant.set_mains(plant.mains());
    plant.advance(1ms);
  }
  EXPECT_EQ(vinv::test::allocation_count(), before);
  EXPECT_GT(plant.reinitialisations(), restarts + 20);  // not even at switching instants
}

std::string solver_name(const testing::TestParamInfo<SolverChoice>& parameter) {
  switch (parameter.param) {
    case SolverChoice::kErk: return "Erk";
    case SolverChoice::kCvodeBdf: return "CvodeBdf";
    case SolverChoice::kRk4: return "Rk4";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Solvers, Reproducibility,
                         testing::Values(SolverChoice::kErk, SolverChoice::kCvodeBdf, SolverChoice::kRk4), solver_name);

}  // namespace
}  // namespace vinv::plant::test
