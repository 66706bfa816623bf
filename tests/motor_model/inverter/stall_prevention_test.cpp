// Stall prevention of whole drives around the plant: heavy starts, overloads, a blocked shaft, hard stops.
#include <numbers>

#include "bench.hpp"
#include "motor_model/plant/machine_steady.hpp"

namespace vinv::inverter::test {
namespace {

constexpr double kTarget_hz = 50;
constexpr double kFastLimit_percent = 170;  // where the hardware limit holds the current

struct Drive {
  std::string model;
  std::string machine;
  double rated_a_rms = 0;
  double boost_percent = 0;
};
std::ostream& operator<<(std::ostream& out, const Drive& d) { return out << d.model; }
const std::vector<Drive>& drives() {
  static const std::vector<Drive> all{{"FR-E540-0.4K", "iec4p_0k4kW_400V", 1.6, 6},
                                      {"FR-E540-1.5K", "iec4p_1k5kW_400V", 4, 4},
                                      {"FR-E520-3.7K", "iec4p_3k7kW_200V", 17.5, 4},
                                      {"FR-E540-7.5K", "iec4p_7k5kW_400V", 17, 3}};
  return all;
}

double rated_torque_nm(const plant::MachineParameters& m) {
  return m.rated_power_w / (m.rated_speed_rpm * std::numbers::pi / 30);
}

InverterConfig geared(const Drive& d, double inertia_ratio, double load_of_rated = 0) {
  InverterConfig c = config_for(d.model, d.machine);
  c.load.inertia_kg_m2 = (inertia_ratio - 1) * c.motor.inertia_kg_m2;
  c.load.constant_nm = load_of_rated * rated_torque_nm(c.motor);
  return c;
}

void start(Bench& b, double hz = kTarget_hz) {
  b.preset("Pr.4", hz);
  b.power_on();
  b.terminal("RH");
  b.terminal("STF");
}

double rotor_hz(Bench& b) { return b.signal("speed") / 60 * b->plant().config().machine.pole_pairs; }
double current_a(Bench& b) { return b->plant().measurements().output_current_a_rms; }

// Speed and torque of the motor in steady state where it takes this current at this frequency of the V/f line.
struct AtCurrent {
  double rotor_hz = 0;
  double torque_nm = 0;
};
AtCurrent at_current(const plant::MachineParameters& motor, double boost_percent, double hz, double current_a_rms) {
  const plant::MachineModel model(motor);
  const double share = boost_percent / 100 + (1 - boost_percent / 100) * hz / motor.rated_frequency_hz;
  const double peak_v = plant::phase_peak(motor.rated_voltage_v_rms) * share;
  const double omega = 2 * std::numbers::pi * hz;
  double low = 0;
  double high = plant::breakdown_slips(model, omega).motoring;
  for (int i = 0; i < 50; ++i) {
    const double slip = (low + high) / 2;
    (plant::steady_point(model, peak_v, omega, slip).current_a_rms < current_a_rms ? low : high) = slip;
  }
  return {hz * (1 - low), plant::steady_point(model, peak_v, omega, low).torque_nm};
}

// How long a start takes whose every instant has the torque of the current limit, or the ramp where that is slower.
double shortest_start_s(const plant::MachineParameters& motor, const Drive& d, double inertia, double ramp_s,
                        double current_a_rms) {
  double time_s = 0;
  double speed_hz = 0;
  for (double hz = 1; hz <= kTarget_hz; hz += 0.25) {
    const AtCurrent now = at_current(motor, d.boost_percent, hz, current_a_rms);
    double rate_hz_s = now.torque_nm / inertia * motor.pole_pairs / (2 * std::numbers::pi);
    if (ramp_s > 0) rate_hz_s = std::min(rate_hz_s, kTarget_hz / ramp_s);
    if (now.rotor_hz <= speed_hz) continue;
    time_s += (now.rotor_hz - speed_hz) / rate_hz_s;
    speed_hz = now.rotor_hz;
  }
  return time_s;
}

struct Start {
  double time_s = -1;  // until the motor is near the target
  double highest_a_rms = 0;
  double highest_later_a_rms = 0;    // after the beginning
  double highest_settled_a_rms = 0;  // when the machine's own swinging at low speed is over
  double fall_back_hz = 0;           // of the frequency, from its highest value
  double fall_back_later_hz = 0;
  bool overload = false;
};

constexpr double kBeginning_s = 0.75;  // until the flux is there and the acceleration is found
constexpr double kSettled_s = 1.3;

Start observe_start(Bench& b, double limit_s) {
  Start s;
  double highest_hz = 0;
  const double begin_s = b.now_s();
  while (b.now_s() - begin_s < limit_s && b->alarm_name().empty()) {
    b.tick();
    const double t = b.now_s() - begin_s;
    const double hz = b.signal("output_frequency");
    highest_hz = std::max(highest_hz, hz);
    s.highest_a_rms = std::max(s.highest_a_rms, current_a(b));
    s.fall_back_hz = std::max(s.fall_back_hz, highest_hz - hz);
    if (t > kBeginning_s) {
      s.highest_later_a_rms = std::max(s.highest_later_a_rms, current_a(b));
      if (t > kSettled_s) s.highest_settled_a_rms = std::max(s.highest_settled_a_rms, current_a(b));
      s.fall_back_later_hz = std::max(s.fall_back_later_hz, highest_hz - hz);
    } else if (t > kBeginning_s / 2) {
      highest_hz = hz;
    }
    s.overload = s.overload || b.port().status().overload;
    if (hz > kTarget_hz - 0.01 && rotor_hz(b) > 0.9 * kTarget_hz) {
      s.time_s = t;
      return s;
    }
  }
  return s;
}

class HeavyStart : public testing::TestWithParam<Drive> {};

TEST_P(HeavyStart, TakesTheTimeThatTheTorqueAtTheLevelNeeds) {
  const Drive& d = GetParam();
  for (const double ratio : {1.0, 5.0, 20.0, 50.0}) {
    for (const double ramp_s : {0.0, 0.1, 0.2, 0.5, 1.0, 5.0}) {
      for (const double level : {100.0, 150.0, 200.0}) {
        SCOPED_TRACE(testing::Message() << d.model << ", inertia " << ratio << " times, Pr.7 = " << ramp_s
                                        << ", Pr.22 = " << level);
        Bench b(geared(d, ratio));
        b.preset("Pr.7", ramp_s);
        b.preset("Pr.22", level);
        start(b);
        const plant::MachineParameters& motor = b->plant().config().machine;
        const double held_a = std::min(level, kFastLimit_percent) / 100 * d.rated_a_rms;
        const double expected_s = shortest_start_s(motor, d, ratio * motor.inertia_kg_m2, ramp_s, held_a);
        const Start s = observe_start(b, 2 * expected_s + 2);
        ASSERT_EQ(b->alarm_name(), "") << b->alarm_cause();
        EXPECT_LT(s.time_s, 1.3 * std::max(expected_s, ramp_s) + 0.35);
        EXPECT_GT(s.time_s, 0.8 * std::max(expected_s, 0.95 * ramp_s));
        EXPECT_LT(s.highest_a_rms, 1.08 * kFastLimit_percent / 100 * d.rated_a_rms);
        EXPECT_LT(s.highest_later_a_rms, 1.25 * held_a);
        EXPECT_LT(s.highest_settled_a_rms, 1.1 * held_a);
        EXPECT_LT(s.fall_back_hz, 10);
        EXPECT_LT(s.fall_back_later_hz, 0.5);
        if (s.time_s > 1.3 * ramp_s + 0.2) {
          EXPECT_TRUE(s.overload);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, HeavyStart, testing::ValuesIn(drives()), [](const auto& of) {
  std::string name = of.param.model;
  std::erase_if(name, [](char c) { return c == '-' || c == '.'; });
  return name;
});

// --- at constant speed ---

TEST(StallPrevention, AnOverloadOfASecondDipsTheSpeedWhichComesBack) {
  for (const Drive& d : drives()) {
    SCOPED_TRACE(d.model);
    InverterConfig c = geared(d, 2, 0.5);
    Bench b(c);
    // Just below the current that twice the rated torque takes.
    const AtCurrent twice = [&] {
      AtCurrent at;
      for (double a = 0.5 * d.rated_a_rms; at.torque_nm < 2 * rated_torque_nm(c.motor); a += 0.01 * d.rated_a_rms) {
        at = at_current(c.motor, d.boost_percent, kTarget_hz, a);
        at.rotor_hz = a;  // the current, in place of the speed
      }
      return at;
    }();
    b.preset("Pr.22", std::floor(0.92 * twice.rotor_hz / d.rated_a_rms * 1000) / 10);
    b.preset("Pr.7", 1);
    b.preset("Pr.8", 1);
    start(b);
    ASSERT_TRUE(b.run_until([&] { return b.port().status().up_to_frequency && rotor_hz(b) > 47; }, 5));
    ASSERT_FALSE(b.port().status().overload);
    plant::LoadSettings load = b->plant().load();
    load.constant_nm = 2 * rated_torque_nm(c.motor);
    b->set_load(load);
    bool overload = false;
    for (int i = 0; i < 1000; ++i) {
      b.tick();
      overload = overload || b.port().status().overload;
    }
    EXPECT_TRUE(overload);
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    EXPECT_LT(b.output_hz(), 48);
    EXPECT_TRUE(b.port().status().running);
    load.constant_nm = 0.5 * rated_torque_nm(c.motor);
    b->set_load(load);
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() == kTarget_hz && rotor_hz(b) > 47; }, 4));
    b.run(0.5);
    EXPECT_FALSE(b.port().status().overload);
    EXPECT_EQ(b->alarm_name(), "");
  }
}

// The motor has stopped; its frequency stands where a blocked motor takes the current of the level.
TEST(StallPrevention, ALastingOverloadWalksTheSpeedDownAndEndsInTheDrivesOverload) {
  for (const Drive& d : drives()) {
    SCOPED_TRACE(d.model);
    Bench b(geared(d, 2, 0.5));
    b.preset("Pr.7", 1);
    b.preset("Pr.8", 1);
    b.preset("Pr.9", 0);  // without the motor's own protection
    start(b);
    ASSERT_TRUE(b.run_until([&] { return rotor_hz(b) > 47; }, 5));
    plant::LoadSettings load = b->plant().load();
    load.constant_nm = 2.5 * rated_torque_nm(b->plant().config().machine);
    b->set_load(load);
    b.run(5);
    EXPECT_LT(rotor_hz(b), 0.5);
    EXPECT_LT(b.output_hz(), 20);
    EXPECT_TRUE(b.port().status().running);
    EXPECT_NEAR(current_a(b), 1.5 * d.rated_a_rms, 0.05 * d.rated_a_rms);
    EXPECT_TRUE(b.port().status().overload);
    ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 90));
    EXPECT_TRUE(b.alarm("E.THT")) << b->alarm_cause();
  }
}

// --- blocked shaft ---

// A blocked motor takes the level's 150 % at a few hertz, not at 0.5 Hz: the frequency stays there, so that the drive's
// overload curve ends it, sooner the nearer to standstill.
TEST(StallPrevention, ABlockedShaftIsHeldAtTheLevelUntilTheDrivesOverloadTrips) {
  for (const Drive& d : drives()) {
    SCOPED_TRACE(d.model);
    Bench b(geared(d, 1));
    b.preset("Pr.7", 1);
    b->set_shaft_locked(true);
    start(b);
    const double begin_s = b.now_s();
    b.run(5);
    EXPECT_TRUE(b.port().status().overload);
    EXPECT_NEAR(current_a(b), 1.5 * d.rated_a_rms, 0.05 * d.rated_a_rms);
    const double hz = b.output_hz();
    EXPECT_GT(hz, 1);
    EXPECT_LT(hz, 20);
    ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 90));
    EXPECT_TRUE(b.alarm("E.THT")) << b->alarm_cause();
    const double seconds = b.now_s() - begin_s;
    const double effective = 1.5 + 0.5 * 0.4 * std::max(0.0, 1 - hz / 10);
    EXPECT_NEAR(seconds, 60 * std::pow(20, -(effective - 1.5) / 0.5), 0.15 * seconds);
  }
}

// Where the current stays above the level down to 0.5 Hz: a low level, or much boost.
TEST(StallPrevention, ABlockedShaftThatCannotBeHeldEndsInTheStallPreventionStop) {
  for (const Drive& d : drives()) {
    for (const auto& [level, boost] : {std::pair{25.0, d.boost_percent}, std::pair{100.0, 25.0}}) {
      SCOPED_TRACE(testing::Message() << d.model << " Pr.22 = " << level << " Pr.0 = " << boost);
      Bench b(geared(d, 1));
      b.preset("Pr.22", level);
      b.preset("Pr.0", boost);
      b->set_shaft_locked(true);
      start(b);
      const double begin_s = b.now_s();
      bool overload = false;
      ASSERT_TRUE(
          b.run_until([&] { return overload = overload || b.port().status().overload, !b->alarm_name().empty(); }, 10));
      EXPECT_TRUE(overload);
      EXPECT_TRUE(b.alarm("E.OLT")) << b->alarm_cause();
      EXPECT_NEAR(b.now_s() - begin_s, 3.2, 0.3);
    }
  }
}

TEST(StallPrevention, AShaftThatBlocksAtSpeedIsNoOverCurrent) {
  for (const Drive& d : drives()) {
    SCOPED_TRACE(d.model);
    Bench b(geared(d, 2));
    b.preset("Pr.7", 1);
    start(b, 40);
    ASSERT_TRUE(b.run_until([&] { return rotor_hz(b) > 38; }, 5));
    b->set_shaft_locked(true);
    b.run(10);
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    EXPECT_TRUE(b.port().status().overload);
    EXPECT_NEAR(current_a(b), 1.5 * d.rated_a_rms, 0.05 * d.rated_a_rms);
    b->set_shaft_locked(false);
    EXPECT_TRUE(b.run_until([&] { return rotor_hz(b) > 38; }, 10)) << b->alarm_cause();
  }
}

// --- deceleration ---

TEST(StallPrevention, AHardStopIsHeldAtTheLevelWhereTheChopperTakesTheEnergy) {
  for (const Drive& d : drives()) {
    SCOPED_TRACE(d.model);
    InverterConfig c = geared(d, 20);
    c.brake_resistance_ohm = 0.5 * (d.model[4] == '2' ? 370 : 740) / d.rated_a_rms;
    Bench b(c);
    b.preset("Pr.7", 5);
    b.preset("Pr.8", 0.1);
    b.preset("Pr.22", 100);
    b.preset("Pr.30", 1);
    b.preset("Pr.70", 30);
    start(b);
    ASSERT_TRUE(b.run_until([&] { return rotor_hz(b) > 49; }, 8)) << b->alarm_cause();
    b.terminal("STF", false);
    bool overload = false;
    double highest_a = 0;
    const double begin_s = b.now_s();
    ASSERT_TRUE(b.run_until(
        [&] {
          overload = overload || b.port().status().overload;
          if (b.now_s() - begin_s > 0.2 && b.output_hz() > 5) highest_a = std::max(highest_a, current_a(b));
          return !b.port().status().running || b.output_hz() <= 3;
        },
        10));
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    EXPECT_TRUE(overload);
    EXPECT_GT(b.now_s() - begin_s, 0.3);
    EXPECT_LT(highest_a, 1.15 * d.rated_a_rms);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
