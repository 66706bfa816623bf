// What the parameter effect tests share: a drive with settings, powered up, started over the network or by terminals,
// and times taken on it. Each acting parameter of families/mitsubishi_e500/parameters.csv is set here or in the tests
// beside it, and something a user can see must follow.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench.hpp"

namespace vinv::inverter::test {

using port::NetTerminal;
using Settings = std::vector<std::pair<std::string, double>>;

inline constexpr double kStateDcBraking = 4;  // signal run_state

// In external operation, with ramps of 0.2 s to 50 Hz unless the settings say otherwise.
inline Bench drive_with(const Settings& settings, const InverterConfig& config = config_1k5()) {
  Bench b(config);
  b.preset("Pr.7", 0.2);
  b.preset("Pr.8", 0.2);
  for (const auto& [name, value] : settings) b.preset(name, value);
  b.power_on();
  return b;
}

// Forward in network operation.
inline void start(Bench& b, double hz) {
  ASSERT_TRUE(b.net().has_value());
  ASSERT_TRUE(b.frequency(hz).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
}
inline void stop(Bench& b) { ASSERT_TRUE(b.command({}).has_value()); }

// Seconds from now until it happens; a failure if it does not.
inline double seconds_until(Bench& b, const std::function<bool()>& done, double within_s) {
  const double from = b.now_s();
  EXPECT_TRUE(b.run_until(done, within_s)) << "alarm " << b->alarm_name() << " " << b->alarm_cause();
  return b.now_s() - from;
}
inline double seconds_to_reach(Bench& b, double hz, double within_s = 30) {
  return seconds_until(
      b, [&] { return b.output_hz() > hz - 0.005; }, within_s);
}
inline double seconds_to_stop(Bench& b, double within_s = 30) {
  const double seconds = seconds_until(
      b, [&] { return !b.port().status().running; }, within_s);
  EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
  return seconds;
}

inline InverterConfig loaded(double inertia_kg_m2, double constant_nm = 0, InverterConfig config = config_1k5()) {
  config.load.inertia_kg_m2 = inertia_kg_m2;
  config.load.constant_nm = constant_nm;
  return config;
}

}  // namespace vinv::inverter::test
