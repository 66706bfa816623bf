#include "motor_model/drive/protections.hpp"

#include <cmath>
#include <numbers>

namespace vinv::drive {
namespace {

double ratio(double current_a, double rated_a) { return rated_a > 0 ? current_a / rated_a : 0; }

// Over-current and over-voltage have one alarm each for acceleration, constant speed, and deceleration or stop.
TripKind by_ramp(RunState state, TripKind acceleration, TripKind constant, TripKind deceleration) {
  if (state == RunState::kAccelerating) return acceleration;
  if (state == RunState::kConstant) return constant;
  return deceleration;
}

}  // namespace

double over_current_level_a_peak(const DriveSettings& settings) {
  return settings.over_current_percent / 100 * std::numbers::sqrt2 * settings.rated_current_a_rms;
}

void Protections::observe(double dt_s, const DriveSettings& settings, const Sensors& sensors,
                          const Situation& situation) {
  const double frequency_hz = std::abs(situation.output_frequency_hz);
  inverter_.step(dt_s, ratio(sensors.current_a_rms, settings.rated_current_a_rms), frequency_hz,
                 settings.inverter_overload_start_percent / 100);
  // The motor that does not run cools down.
  second_motor_ = settings.second_motor;
  motors_[second_motor_ ? 1 : 0].step(dt_s, ratio(sensors.current_a_rms, settings.electronic_thermal_a_rms),
                                      frequency_hz, settings.motor_forced_cooling);
  motors_[second_motor_ ? 0 : 1].step(dt_s, 0, frequency_hz, true);
}

std::optional<Trip> Protections::check(double dt_s, const DriveSettings& settings, const DriveCommand& command,
                                       const Sensors& sensors, const Situation& situation) {
  const auto trip = [&](TripKind kind, double value, double level, Duration after = {}) {
    return Trip{kind, after, value, level, situation.state, situation.output_frequency_hz};
  };
  // These two count time, so they step in every tick.
  const bool earth = earth_fault_.step(dt_s, settings.earth_fault_detection && situation.gates_on, sensors.earth_fault);
  const bool phase =
      phase_loss_.step(dt_s, settings.output_phase_loss_protection, situation.gates_on, sensors.output_phase_open);

  const double oc_level = over_current_level_a_peak(settings);
  if (sensors.over_current || (oc_level > 0 && sensors.current_peak_a >= oc_level)) {
    const bool event = sensors.over_current;
    return trip(by_ramp(situation.state, TripKind::kOverCurrentAcceleration, TripKind::kOverCurrentConstant,
                        TripKind::kOverCurrentDeceleration),
                event ? sensors.comparator_value : sensors.current_peak_a, oc_level,
                event ? sensors.comparator_after : Duration{});
  }
  if (sensors.over_voltage || (settings.over_voltage_v > 0 && sensors.dc_link_v >= settings.over_voltage_v)) {
    const bool event = sensors.over_voltage;
    return trip(by_ramp(situation.state, TripKind::kOverVoltageAcceleration, TripKind::kOverVoltageConstant,
                        TripKind::kOverVoltageDeceleration),
                event ? sensors.comparator_value : sensors.dc_link_v, settings.over_voltage_v,
                event ? sensors.comparator_after : Duration{});
  }
  if (earth) return trip(TripKind::kEarthFault, 1, 0);
  if (sensors.chopper_failed) return trip(TripKind::kBrakeTransistor, 1, 0);
  if (command.external_thermal && !settings.motor_alarms_wait) return trip(TripKind::kExternalThermal, 1, 0);
  if (sensors.heat_sink_c >= settings.heat_sink_trip_c) {
    return trip(TripKind::kHeatSink, sensors.heat_sink_c, settings.heat_sink_trip_c);
  }
  if (phase) return trip(TripKind::kOutputPhaseLoss, 1, 0);
  // The accumulators survive a reset, so these must not lock a stopped drive in its alarm.
  if (situation.gates_on && inverter_.tripped()) return trip(TripKind::kInverterOverload, inverter_.fraction(), 1);
  if (situation.gates_on && settings.electronic_thermal_a_rms > 0 && !settings.motor_alarms_wait && motor().tripped()) {
    return trip(TripKind::kMotorOverload, motor().fraction(), 1);
  }
  return std::nullopt;
}

void Protections::clear_accumulators() {
  for (ElectronicThermal& motor : motors_) motor.clear();
  inverter_.clear();
}

}  // namespace vinv::drive
