// Steady state of the flux equations (machine.hpp with all derivatives zero), and the points of it that data sheets
// print. Closed form except where a torque is given and the slip is sought.
#pragma once

#include "motor_model/plant/machine.hpp"

namespace vinv::plant {

// Stator voltage U + j0 at omega_k; rotor at slip s = 1 - p omega_mech / omega_k.
struct SteadyPoint {
  double slip = 0;
  FluxPair psi;
  CurrentPair i;
  double torque_nm = 0;  // air gap
  double current_a_rms = 0;
  double power_factor = 0;  // signed: negative while regenerating
  double input_power_w = 0;
};

SteadyPoint steady_point(const MachineModel& machine, double voltage_peak_v, double omega_k_rad_s, double slip);

// Slips of largest motoring and regenerating torque at this supply.
struct BreakdownSlips {
  double motoring = 0;
  double regenerating = 0;  // negative
};
BreakdownSlips breakdown_slips(const MachineModel& machine, double omega_k_rad_s);

// The slip between the two breakdown slips at which the machine gives this torque; the nearer breakdown slip if the
// torque is out of reach.
double slip_for_torque(const MachineModel& machine, double voltage_peak_v, double omega_k_rad_s, double torque_nm);

// Phase peak of a line-to-line rms voltage.
double phase_peak(double line_v_rms);

}  // namespace vinv::plant
