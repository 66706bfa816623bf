// A motor and DC link in closed form for tests of the control core: torque proportional to slip, current from the
// torque and magnetising parts, link energy from the regenerated power. Per unit of the rated torque and 50 Hz.
#pragma once

#include <algorithm>
#include <cmath>

#include "motor_model/drive/drive_types.hpp"

namespace vinv::drive {

struct FakePower {
  // motor: 1.5 kW, 4 A
  double rated_active_a = 3.4;
  double no_load_a = 2.1;
  double rated_slip_hz = 2.0;
  double rated_power_w = 1500;
  double acceleration_hz_s = 200;  // of rotor and load by rated torque
  double load = 0;                 // opposing torque
  bool locked = false;
  // link
  bool stiff_link = true;  // false: the link takes what the motor regenerates
  double capacitance_f = 235e-6;
  double mains_peak_v = 566;
  double standby_w = 20;
  double brake_ohm = 0;
  // state
  double rotor_hz = 0;
  double torque = 0;
  double stage_sign = 1;
  double link_v = 566;
  bool chopper_on = false;

  void advance(double dt, const DriveOutputs& out, const DriveSettings& s) {
    torque = out.gates_on ? std::clamp((out.stage_frequency_hz - rotor_hz) / rated_slip_hz, -4.0, 4.0) : 0;
    stage_sign = out.stage_frequency_hz < 0 ? -1 : 1;
    const double drag = rotor_hz > 1e-6 ? load : rotor_hz < -1e-6 ? -load : std::clamp(torque, -load, load);
    if (locked) {
      rotor_hz = 0;
    } else {
      const double before = rotor_hz;
      rotor_hz += (torque - drag) * acceleration_hz_s * dt;
      if (before * rotor_hz < 0 && std::abs(torque) < load) rotor_hz = 0;
    }
    if (stiff_link) return;
    chopper_on =
        out.chopper_enabled && brake_ohm > 0 && (link_v >= s.chopper_on_v || (chopper_on && link_v > s.chopper_off_v));
    const double power =
        -torque * rotor_hz / 50 * rated_power_w - standby_w - (chopper_on ? link_v * link_v / brake_ohm : 0);
    const double energy = 0.5 * capacitance_f * link_v * link_v + power * dt;
    link_v = std::max(std::sqrt(std::max(2 * energy / capacitance_f, 0.0)), mains_peak_v);
  }

  Sensors sensors(bool gates_on) const {
    Sensors m;
    if (gates_on) {
      m.active_current_a_rms = torque * stage_sign * rated_active_a;
      m.current_a_rms = std::hypot(m.active_current_a_rms, no_load_a);
      m.current_peak_a = m.current_a_rms * std::sqrt(2.0);
    }
    m.dc_link_v = link_v;
    m.chopper_on = chopper_on;
    m.rotor_frequency_hz = rotor_hz;
    return m;
  }
};

}  // namespace vinv::drive
