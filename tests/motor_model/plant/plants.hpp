// Plants and drives of them that several tests share.
#pragma once

#include <algorithm>
#include <cmath>

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant::test {

using namespace std::chrono_literals;

// The 2.2 kW drive of the reference cases: 400 V, 235 uF, 2 ohm, total inertia given, no losses.
inline PlantConfig lossless_2k2(double total_inertia_kg_m2 = 0.015) {
  PlantConfig config;
  config.machine = *find_machine("motulator_2k2");
  config.load.inertia_kg_m2 = total_inertia_kg_m2 - config.machine.inertia_kg_m2;
  return config;
}

inline PlantConfig real_2k2(double total_inertia_kg_m2 = 0.015) {
  PlantConfig config = lossless_2k2(total_inertia_kg_m2);
  config.losses = typical_losses(config.machine);
  config.thermal.heat_sink_k_per_w = 0.5;
  return config;
}

// U = 5 % + 95 % f / 50 Hz of 326.6 V.
inline StageInput vf(double frequency_hz) {
  StageInput stage;
  stage.gates_on = true;
  stage.frequency_hz = frequency_hz;
  stage.voltage_peak_v = 16.32993162 + (326.5986324 - 16.32993162) * std::min(std::abs(frequency_hz) / 50, 1.0);
  return stage;
}

inline void charge(PowerPlant& plant) { plant.advance(1s); }

// Ramps from one frequency to another; each tick is told the frequency at its end. Stops at the first event.
inline PowerPlant::Events ramp(PowerPlant& plant, double from_hz, double to_hz, Duration duration) {
  const auto ticks = duration / 1ms;
  for (std::int64_t n = 1; n <= ticks; ++n) {
    plant.set_stage(vf(from_hz + (to_hz - from_hz) * static_cast<double>(n) / static_cast<double>(ticks)));
    const auto events = plant.advance(1ms);
    if (events.count > 0) return events;
  }
  return {};
}

inline PowerPlant::Events run(PowerPlant& plant, Duration duration) {
  for (Duration t{}; t < duration; t += 1ms) {
    const auto events = plant.advance(1ms);
    if (events.count > 0) return events;
  }
  return {};
}

}  // namespace vinv::plant::test
