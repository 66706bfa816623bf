// A control core with fake power around it, ticked in milliseconds.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "fake_power.hpp"
#include "motor_model/drive/drive_core.hpp"

namespace vinv::drive {

struct DriveBench {
  static constexpr double kTick_s = 0.001;
  DriveSettings settings;
  DriveCommand command;
  FakePower power;
  DriveCore core;
  // Changes the sensors of the next ticks.
  std::function<void(Sensors&)> meddle;
  std::optional<Trip> tripped;  // the latest
  int ticks = 0;

  DriveBench() {
    settings.rated_current_a_rms = 4;
    settings.electronic_thermal_a_rms = 4;
    settings.dc_brake_s = 0;
  }

  const DriveOutputs& out() const { return core.outputs(); }
  double hz() const { return core.outputs().output_frequency_hz; }

  const DriveOutputs& tick() {
    Sensors m = power.sensors(core.outputs().gates_on);
    if (meddle) meddle(m);
    const DriveOutputs& o = core.tick(std::chrono::milliseconds(1), settings, command, m);
    if (o.trip) tripped = o.trip;
    power.advance(kTick_s, o, settings);
    ++ticks;
    return o;
  }
  void run_ms(int ms) {
    for (int i = 0; i < ms; ++i) tick();
  }
  // Ticks until the condition holds after one of them; -1 if it does not within the limit.
  int ms_until(const std::function<bool(const DriveOutputs&)>& condition, int limit_ms) {
    for (int i = 1; i <= limit_ms; ++i) {
      if (condition(tick())) return i;
    }
    return -1;
  }
  int ms_until_state(RunState state, int limit_ms) {
    return ms_until([state](const DriveOutputs& o) { return o.state == state; }, limit_ms);
  }
  void forward(double hz) { command = {.direction = RunDirection::kForward, .set_frequency_hz = hz}; }
  void reverse(double hz) { command = {.direction = RunDirection::kReverse, .set_frequency_hz = hz}; }
  void stop() { command.direction = RunDirection::kStop; }
};

}  // namespace vinv::drive
