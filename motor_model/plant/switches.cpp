#include "motor_model/plant/switches.hpp"

#include <algorithm>
#include <numbers>

namespace vinv::plant {

namespace {

constexpr double kNeverAbove = 1e9, kNeverBelow = -1e9;
// An over-voltage is over 3 % below its level (24 to 30 V of 800 V are usual).
constexpr double kOverVoltageClear = 0.97;

}  // namespace

SwitchLevels switch_levels(const PlantConfig& config, const StageInput& stage) {
  const double nominal = std::numbers::sqrt2 * config.nominal_mains_v_rms;
  const auto& c = config.comparators;
  SwitchLevels out;
  out.over_voltage_v = c.over_voltage_v;
  out.over_voltage_clear_v = kOverVoltageClear * c.over_voltage_v;
  out.under_voltage_v = c.under_voltage_v;
  out.under_voltage_clear_v = std::max(c.under_voltage_clear_v, 1.001 * c.under_voltage_v);
  out.bypass_closes_v = config.dc_link.bypass_closes_fraction * nominal;
  out.bypass_opens_v = config.dc_link.bypass_opens_fraction * nominal;
  out.chopper_on_v = stage.chopper_on_v;
  // Without hysteresis the chopper would switch infinitely often.
  out.chopper_off_v = std::min(stage.chopper_off_v, 0.998 * stage.chopper_on_v);
  out.chopper_possible = stage.chopper_enabled && stage.chopper_on_v > 0 && config.dc_link.brake_resistance_ohm > 0;
  return out;
}

QuietBand quiet_band(const Switches& s, const SwitchLevels& levels) {
  QuietBand band{kNeverBelow, kNeverAbove};
  const auto above = [&](bool applies, double v) {
    if (applies) band.above_v = std::min(band.above_v, v);
  };
  const auto below = [&](bool applies, double v) {
    if (applies) band.below_v = std::max(band.below_v, v);
  };
  above(levels.over_voltage_v > 0 && !s.over_voltage, levels.over_voltage_v);
  below(s.over_voltage, levels.over_voltage_clear_v);
  above(levels.under_voltage_v > 0 && !s.under_voltage_armed, levels.under_voltage_clear_v);
  below(s.under_voltage_armed, levels.under_voltage_v);
  above(!s.bypassed, levels.bypass_closes_v);
  below(s.bypassed, levels.bypass_opens_v);
  above(levels.chopper_possible && !s.chopper_on, levels.chopper_on_v);
  below(s.chopper_on, levels.chopper_off_v);
  return band;
}

SwitchActions settle(Switches& s, const SwitchLevels& levels, double v) {
  SwitchActions actions;
  if (s.over_voltage && v <= levels.over_voltage_clear_v) s.over_voltage = false;
  if (levels.over_voltage_v > 0 && v >= levels.over_voltage_v && !s.over_voltage) {
    s.over_voltage = true;
    actions.over_voltage = true;
  }
  if (s.under_voltage_armed && v <= levels.under_voltage_v) {
    s.under_voltage_armed = false;
    actions.under_voltage = true;
  }
  if (levels.under_voltage_v > 0 && v >= levels.under_voltage_clear_v) s.under_voltage_armed = true;
  if (s.bypassed ? v <= levels.bypass_opens_v : v >= levels.bypass_closes_v) s.bypassed = !s.bypassed;
  if (!levels.chopper_possible || v <= levels.chopper_off_v) {
    s.chopper_on = false;
  } else if (v >= levels.chopper_on_v) {
    s.chopper_on = true;
  }
  // The owner took the trip away while the link is still too high: the comparator shuts the gates again at once.
  if (s.over_voltage && s.gates_on() && !actions.over_voltage) actions.over_voltage = true;
  if (actions.over_voltage || actions.under_voltage) s.gates_latched = true;
  return actions;
}

}  // namespace vinv::plant
