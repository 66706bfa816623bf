// Settings of the control of speed and torque without an encoder (A700 Pr.800 = 10 to 12).
#pragma once

#include <array>

#include "sim/base/archive.hpp"

namespace vinv::drive {

// The four ways in which a torque can act, by direction of rotation.
enum Quadrant : std::size_t { kForwardDriving, kForwardBraking, kReverseDriving, kReverseBraking };

struct VectorSettings {
  bool on = false;
  bool torque_control = false;  // the torque is commanded and the speed limited, instead of the other way round
  // the motor as its parameters have it; electrical, at its rated point
  double rated_torque_nm = 10;
  double rated_frequency_hz = 50;
  double rated_slip_hz = 2;
  double no_load_current_a_rms = 2;
  double torque_current_a_rms = 3;
  double stator_ohm = 3;
  double leakage_ohm = 10;       // of stator and rotor together, at rated frequency
  double magnetising_ohm = 100;  // with the stator's leakage, at rated frequency
  double start_s = 0.05;         // the motor alone, from rest to rated speed with rated torque
  // speed controller
  double response_rad_s = 40;  // of the motor alone
  double integral_s = 0.333;   // 0: none
  double speed_filter_s = 0;   // of the set speed
  double torque_filter_s = 0;  // of the torque command
  // torque that the ramp's acceleration needs, given ahead
  double feed_forward = 0;  // part of it; 0: off
  double load_inertia = 0;  // multiple of the motor's own
  double feed_forward_filter_s = 0;
  double feed_forward_most_percent = 150;
  // limits, percent of the rated torque
  std::array<double, 4> limit_percent{150, 150, 150, 150};  // by Quadrant
  double limit_accelerating_percent = -1;                   // negative: those of the quadrants
  double limit_decelerating_percent = -1;
  bool constant_torque_above_base = false;  // the limits hold above rated frequency too, where they else fall with 1/f
  double idle_excitation = 1;               // part of the flux that is left without torque
  // stall: this slow with this much torque for 3 s
  double stall_hz = 1.5;
  double stall_percent = 150;
  VINV_ARCHIVE(VectorSettings, on, torque_control, rated_torque_nm, rated_frequency_hz, rated_slip_hz,
               no_load_current_a_rms, torque_current_a_rms, stator_ohm, leakage_ohm, magnetising_ohm, start_s,
               response_rad_s, integral_s, speed_filter_s, torque_filter_s, feed_forward, load_inertia,
               feed_forward_filter_s, feed_forward_most_percent, limit_percent, limit_accelerating_percent,
               limit_decelerating_percent, constant_torque_above_base, idle_excitation, stall_hz, stall_percent);
};

}  // namespace vinv::drive
