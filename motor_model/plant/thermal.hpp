// First-order temperatures: heat sink over the inverter loss, stator winding over the square of the current.
#pragma once

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

struct Thermal {
  double ambient_c = 25;
  double heat_sink_k_per_w = 0;
  double heat_sink_rate = 0;    // 1/s
  double winding_k_per_a2 = 0;  // per A peak squared
  double winding_rate = 0;

  Thermal() = default;
  Thermal(const ThermalSettings& s, const MachineParameters& machine, double ambient)
      : ambient_c(ambient),
        heat_sink_k_per_w(s.heat_sink_k_per_w),
        heat_sink_rate(1 / s.heat_sink_time_constant_s),
        winding_k_per_a2(s.winding_rise_k_at_rated / (2 * machine.rated_current_a_rms * machine.rated_current_a_rms)),
        winding_rate(1 / s.winding_time_constant_s) {}

  void set_cooling(const ThermalSettings& s, double resistance_factor) {
    heat_sink_k_per_w = s.heat_sink_k_per_w * resistance_factor;
    heat_sink_rate = 1 / (s.heat_sink_time_constant_s * resistance_factor);
  }
};

inline double heat_sink_slope(const Thermal& t, double heat_sink_c, double inverter_loss_w) {
  return (t.ambient_c + t.heat_sink_k_per_w * inverter_loss_w - heat_sink_c) * t.heat_sink_rate;
}
inline double winding_slope(const Thermal& t, double winding_c, double current_peak_squared) {
  return (t.ambient_c + t.winding_k_per_a2 * current_peak_squared - winding_c) * t.winding_rate;
}

}  // namespace vinv::plant
