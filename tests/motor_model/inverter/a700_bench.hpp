// An FR-A740-1.5K with its motor on the bench, with 50 Hz values and short ramps.
#pragma once

#include "parameter_bench.hpp"

namespace vinv::inverter::test {

inline InverterConfig config_a700() { return config_for("FR-A740-1.5K", "iec4p_1k5kW_400V"); }

// Ready, in the mode that Pr.79 and Pr.340 say.
inline Bench a700_with(const Settings& settings = {}, const InverterConfig& config = config_a700()) {
  Bench b(config, "fr-a700");
  b.preset("Pr.3", 50);
  b.preset("Pr.20", 50);
  b.preset("Pr.7", 0.5);
  b.preset("Pr.8", 0.5);
  for (const auto& [name, value] : settings) b.preset(name, value);
  b.power_on();
  return b;
}

// Running forward over the network.
inline Bench a700_running(double hz, Settings settings = {}, const InverterConfig& config = config_a700()) {
  settings.emplace_back("Pr.340", 1);
  Bench b = a700_with(settings, config);
  EXPECT_TRUE(b.frequency(hz).has_value());
  EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > hz - 0.01; }, 20)) << b->alarm_name() << b->alarm_cause();
  return b;
}

inline double monitor(Bench& b, unsigned code) { return b.port().read_monitor(code).value_or(std::uint16_t{0}); }

}  // namespace vinv::inverter::test
