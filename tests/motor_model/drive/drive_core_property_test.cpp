// Random settings and commands: what must hold whatever happens. The seed is printed with every failure.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "fake_power.hpp"
#include "motor_model/drive/drive_core.hpp"
#include "sim/base/random.hpp"

namespace vinv::drive {
namespace {

double between(Random& r, double low, double high) { return low + (high - low) * r.uniform(); }
bool chance(Random& r, double p) { return r.uniform() < p; }

DriveSettings random_settings(Random& r) {
  DriveSettings s;
  s.rated_current_a_rms = between(r, 1, 20);
  s.max_frequency_hz = between(r, 0, 120);
  s.min_frequency_hz = chance(r, 0.5) ? 0 : between(r, 0, 60);
  s.start_frequency_hz = chance(r, 0.5) ? 0.5 : between(r, 0, 20);
  for (auto& band : s.jump_bands) {
    if (chance(r, 0.5)) continue;
    band.low_hz = between(r, 0, 100);
    band.high_hz = band.low_hz + between(r, 0, 10);
    band.jump_to_hz = chance(r, 0.5) ? band.low_hz : band.high_hz;
  }
  s.acceleration_s = chance(r, 0.1) ? 0 : between(r, 0.05, 5);
  s.deceleration_s = chance(r, 0.1) ? 0 : between(r, 0.05, 5);
  s.ramp_reference_hz = between(r, 1, 400);
  s.cushion_pattern_base_hz = between(r, 1, 120);
  s.ramp_pattern = static_cast<RampPattern>(r.below(3));
  s.base_frequency_hz = chance(r, 0.1) ? 0 : between(r, 1, 120);
  s.torque_boost_percent = between(r, 0, 30);
  s.load_pattern = static_cast<LoadPattern>(r.below(4));
  s.stator_resistance_compensation_ohm = chance(r, 0.7) ? 0 : between(r, 0, 10);
  s.rated_slip_hz = chance(r, 0.5) ? 0 : between(r, 0, 5);
  s.motor_no_load_current_a_rms = between(r, 0, 10);
  s.slip_response_s = between(r, 0, 2);
  s.slip_in_constant_output = chance(r, 0.5);
  s.dc_brake_frequency_hz = between(r, 0, 20);
  s.dc_brake_s = chance(r, 0.5) ? 0 : between(r, 0, 1);
  s.stall_level_percent = chance(r, 0.3) ? 0 : between(r, 20, 200);
  s.stall_compensated = chance(r, 0.5);
  s.stall_level_double_speed_percent = between(r, 0, 200);
  s.stall_reduction_start_hz = between(r, 0, 400);
  s.stall_trips_at_once = chance(r, 0.1);
  s.fast_current_limit = chance(r, 0.5);
  s.dc_link_hold_v = chance(r, 0.5) ? 0 : 760;
  s.shortest_acceleration = chance(r, 0.1);
  s.shortest_deceleration = chance(r, 0.1);
  s.stop_by_coasting = chance(r, 0.3);
  s.coast_delay_s = between(r, 0, 0.5);
  s.electronic_thermal_a_rms = chance(r, 0.3) ? 0 : between(r, 1, 20);
  s.over_current_percent = chance(r, 0.5) ? 200 : 2000;
  s.chopper_fitted = chance(r, 0.5);
  s.chopper_duty_percent = between(r, 0, 30);
  s.restart_enabled = chance(r, 0.5);
  s.restart_coast_s = between(r, 0, 0.3);
  s.restart_cushion_s = between(r, 0, 0.3);
  return s;
}

// Steepest slope that the ramp of these settings may have, Hz/s.
double steepest(const DriveSettings& s, double time_s) {
  if (time_s <= 0) return 1e9;
  switch (s.ramp_pattern) {
    case RampPattern::kLinear:
    case RampPattern::kBacklash:
    case RampPattern::kSCurveC:
    case RampPattern::kSCurveD: return s.ramp_reference_hz / time_s;
    case RampPattern::kSCurveA: return 9.0 / 8 * s.cushion_pattern_base_hz / time_s;
    case RampPattern::kSCurveB: return std::numbers::pi / 2 * s.ramp_reference_hz / time_s;
  }
  return 0;
}

bool all_finite(const DriveOutputs& o) {
  for (const double x :
       std::array{o.stage_frequency_hz, o.stage_voltage_peak_v, o.output_frequency_hz, o.ramp_frequency_hz,
                  o.motor_thermal_fraction, o.inverter_thermal_fraction, o.brake_duty_fraction}) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

// How often the runs got where they should get; a run that is always stopped proves nothing.
struct Visits {
  std::array<int, 9> ticks{};  // by RunState
  int overload = 0;
  int reverse = 0;
};

void run_one(std::uint64_t seed, Visits& visits) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random r(seed);
  const DriveSettings s = random_settings(r);
  FakePower power;
  power.acceleration_hz_s = between(r, 20, 500);
  power.load = between(r, 0, 1.5);
  power.rated_active_a = s.rated_current_a_rms * 0.85;
  power.no_load_a = s.rated_current_a_rms * 0.5;
  power.stiff_link = chance(r, 0.5);
  power.brake_ohm = s.chopper_fitted ? 250 : 0;
  DriveCore core;
  DriveCommand command;
  bool mains = true;
  double previous = 0;
  RunState before = RunState::kStopped;
  for (int i = 0; i < 6000; ++i) {
    if (chance(r, 0.002)) command.direction = static_cast<RunDirection>(static_cast<int>(r.below(3)) - 1);
    if (chance(r, 0.002)) command.set_frequency_hz = between(r, -5, 150);
    if (chance(r, 0.0005)) command.output_stop = !command.output_stop;
    if (chance(r, 0.0005)) command.permit = !command.permit;
    if (chance(r, 0.001)) mains = !mains;
    if (chance(r, 0.001)) power.locked = !power.locked;
    if (chance(r, 0.0003)) core.force_trip();
    if (core.outputs().state == RunState::kTripped && chance(r, 0.01)) {
      core.reset(chance(r, 0.5) ? DriveCore::Accumulators::kKeep : DriveCore::Accumulators::kClear);
    }
    before = core.outputs().state;
    Sensors m = power.sensors(core.outputs().gates_on);
    if (!mains) m.dc_link_v = 200;
    if (chance(r, 0.0002)) m.over_current = true;
    m.control_power = !chance(r, 0.0002);
    const DriveOutputs& o = core.tick(std::chrono::milliseconds(1), s, command, m);
    power.advance(0.001, o, s);

    ++visits.ticks[static_cast<std::size_t>(o.state)];
    visits.overload += o.overload;
    visits.reverse += o.output_frequency_hz < 0;
    ASSERT_TRUE(all_finite(o)) << i;
    ASSERT_LE(std::abs(o.output_frequency_hz), s.max_frequency_hz + 1e-9) << i;
    ASSERT_LE(std::abs(o.ramp_frequency_hz), s.max_frequency_hz + 1e-9) << i;
    ASSERT_GE(o.stage_voltage_peak_v, 0) << i;
    ASSERT_LE(o.stage_voltage_peak_v, 400 * std::sqrt(2.0 / 3) + 1e-6) << i;
    if (o.trip) {
      ASSERT_EQ(o.state, RunState::kTripped) << i;
    }
    if (o.state == RunState::kTripped || o.state == RunState::kStopped || command.output_stop || !command.permit ||
        !m.control_power || m.dc_link_v < s.under_voltage_v) {
      ASSERT_FALSE(o.gates_on) << i;
      ASSERT_FALSE(o.running) << i;
    }
    if (!o.gates_on) {
      ASSERT_EQ(o.stage_voltage_peak_v, 0) << i;
      ASSERT_EQ(o.output_frequency_hz, 0) << i;
    }
    ASSERT_FALSE(o.running && !o.gates_on) << i;

    const bool ramping = o.running && (before == RunState::kAccelerating || before == RunState::kConstant ||
                                       before == RunState::kDecelerating);
    const double now = o.ramp_frequency_hz;
    if (ramping && !s.shortest_acceleration && !s.shortest_deceleration && now * previous > 0) {
      const double rise = (std::abs(now) - std::abs(previous)) / 0.001;
      ASSERT_LE(rise, steepest(s, s.acceleration_s) * 1.001 + 1e-6) << i;
      if (!o.overload) {
        ASSERT_GE(rise, -steepest(s, s.deceleration_s) * 1.001 - 1e-6) << i;
      }
    }
    // Without stall prevention the output stays at or above the start frequency.
    if (o.running && s.stall_level_percent == 0) {
      ASSERT_GE(std::abs(now), std::min(s.start_frequency_hz, s.max_frequency_hz) - 1e-9) << i;
    }
    previous = now;
  }
}

TEST(DriveCoreProperties, HoldForRandomSettingsAndCommands) {
  Visits visits;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    run_one(seed, visits);
    if (testing::Test::HasFatalFailure()) return;
  }
  for (std::size_t state = 0; state < visits.ticks.size(); ++state) EXPECT_GT(visits.ticks[state], 1000) << state;
  EXPECT_GT(visits.overload, 1000);
  EXPECT_GT(visits.reverse, 10'000);
}

// The same seed gives the same outputs.
TEST(DriveCoreProperties, IdenticalInputsGiveIdenticalOutputs) {
  const auto run = [] {
    Random r(77);
    DriveSettings s = random_settings(r);
    s.max_frequency_hz = 100;
    FakePower power;
    DriveCore core;
    double sum = 0;
    for (int i = 0; i < 5000; ++i) {
      const DriveCommand command{.direction = i % 3000 < 2000 ? RunDirection::kForward : RunDirection::kReverse,
                                 .set_frequency_hz = between(r, 30, 60)};
      const DriveOutputs& o =
          core.tick(std::chrono::milliseconds(1), s, command, power.sensors(core.outputs().gates_on));
      power.advance(0.001, o, s);
      sum = sum * 1.0001 + o.stage_voltage_peak_v + o.output_frequency_hz;
    }
    return sum;
  };
  const double first = run();
  EXPECT_NE(first, 0);
  EXPECT_EQ(first, run());
}

}  // namespace
}  // namespace vinv::drive
