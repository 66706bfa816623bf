// What a drive knows of the torque without a model of the flux: the output power less what the stator resistance takes.
#pragma once

namespace vinv::drive {

struct OutputSample {
  double current_a_rms = 0;
  double active_current_a_rms = 0;  // in phase with the voltage, negative while power comes back
  double phase_voltage_v_rms = 0;   // that drove it
};

// Part of the active current that feeds the heat of the stator resistance, A rms; at low frequency most of it.
double resistive_current_a_rms(const OutputSample& output, double stator_ohm);

// The current in phase with the voltage behind the stator resistance, A rms: it makes the torque, and is negative while
// the motor brakes. 0 without output.
double torque_current_a_rms(const OutputSample& output, double stator_ohm);

}  // namespace vinv::drive
