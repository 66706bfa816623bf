#include "motor_model/drive/torque_current.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {

double resistive_current_a_rms(const OutputSample& output, double stator_ohm) {
  if (output.phase_voltage_v_rms <= 0) return 0;
  return stator_ohm * output.current_a_rms * output.current_a_rms / output.phase_voltage_v_rms;
}

double torque_current_a_rms(const OutputSample& output, double stator_ohm) {
  if (output.phase_voltage_v_rms <= 0) return 0;
  const double i = output.current_a_rms;
  const double active = std::clamp(output.active_current_a_rms, -i, i);
  const double reactive = std::sqrt(i * i - active * active);
  const double behind_v = std::hypot(output.phase_voltage_v_rms - stator_ohm * active, stator_ohm * reactive);
  if (behind_v <= 0) return 0;
  const double power_w = output.phase_voltage_v_rms * active - stator_ohm * i * i;
  return std::clamp(power_w / behind_v, -i, i);
}

}  // namespace vinv::drive
