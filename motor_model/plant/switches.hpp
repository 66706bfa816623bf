// The switching parts around the continuous plant: comparators, pre-charge relay, brake chopper. Each acts at a level
// of the link voltage; between two actions the plant is smooth, so the integration looks for one band edge each way.
#pragma once

#include "motor_model/plant/power_plant.hpp"
#include "sim/base/archive.hpp"

namespace vinv::plant {

struct SwitchLevels {
  double over_voltage_v = 0;  // 0: off
  double over_voltage_clear_v = 0;
  double under_voltage_v = 0;  // 0: off
  double under_voltage_clear_v = 0;
  double bypass_closes_v = 0;
  double bypass_opens_v = 0;
  double chopper_on_v = 0;
  double chopper_off_v = 0;
  bool chopper_possible = false;  // enabled, a resistor is fitted, levels make sense
};

// Positions. Plain data, part of a snapshot.
struct Switches {
  bool gates_commanded = false;
  bool gates_latched = false;  // shut by a comparator until the owner takes the command away
  bool over_voltage = false;   // link has been above, and not yet below the clear level
  bool under_voltage_armed = false;
  bool bypassed = false;
  bool chopper_on = false;

  bool gates_on() const { return gates_commanded && !gates_latched; }
  VINV_ARCHIVE(Switches, gates_commanded, gates_latched, over_voltage, under_voltage_armed, bypassed, chopper_on);
};

// The edges of the band in which nothing acts: strictly inside, no switch moves.
struct QuietBand {
  double below_v = 0;
  double above_v = 0;
};
QuietBand quiet_band(const Switches& switches, const SwitchLevels& levels);

struct SwitchActions {
  bool over_voltage = false;  // comparator events
  bool under_voltage = false;
};
// Moves every switch that has to move at this link voltage.
SwitchActions settle(Switches& switches, const SwitchLevels& levels, double v_dc);

SwitchLevels switch_levels(const PlantConfig& config, const StageInput& stage);

}  // namespace vinv::plant
