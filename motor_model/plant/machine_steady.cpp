#include "motor_model/plant/machine_steady.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>

namespace vinv::plant {

using Complex = std::complex<double>;

double phase_peak(double line_v_rms) { return line_v_rms * std::sqrt(2.0 / 3.0); }

SteadyPoint steady_point(const MachineModel& m, double voltage_peak_v, double omega_k_rad_s, double slip) {
  // The flux equations at rest: 0 = U - (R_s gamma_s + j w) psi_s + R_s gamma_m psi_r,
  // 0 = R_r gamma_m psi_s - (R_r gamma_r + j s w) psi_r.
  Eigen::Matrix2cd a;
  a << Complex{m.R_s * m.gamma_s, omega_k_rad_s}, -m.R_s * m.gamma_m,
      -m.R_r * m.gamma_m, Complex{m.R_r * m.gamma_r, slip * omega_k_rad_s};
  const Eigen::Vector2cd psi = a.inverse() * Eigen::Vector2cd{voltage_peak_v, 0.0};

  SteadyPoint out;
  out.slip = slip;
  out.psi = {psi[0].real(), psi[0].imag(), psi[1].real(), psi[1].imag()};
  out.i = currents(m, out.psi);
  out.torque_nm = air_gap_torque(m, out.psi, out.i);
  const double i_peak = std::hypot(out.i.i_sd, out.i.i_sq);
  out.current_a_rms = i_peak / std::sqrt(2.0);
  out.power_factor = i_peak > 0 ? out.i.i_sd / i_peak : 0;
  out.input_power_w = 1.5 * voltage_peak_v * out.i.i_sd;
  return out;
}

BreakdownSlips breakdown_slips(const MachineModel& m, double omega_k_rad_s) {
  // Torque is greatest where R_r / s equals the magnitude of the impedance behind it (Thevenin of supply, stator and
  // magnetising branch, plus rotor leakage).
  const double w = std::abs(omega_k_rad_s);
  const Complex z_source = Complex{0, w * m.L_m} * Complex{m.R_s, w * (m.L_s - m.L_m)} / Complex{m.R_s, w * m.L_s};
  const double x = z_source.imag() + w * (m.L_r - m.L_m);
  const double s = m.R_r / std::hypot(z_source.real(), x);
  return {s, -s};
}

double slip_for_torque(const MachineModel& m, double voltage_peak_v, double omega_k_rad_s, double torque_nm) {
  const auto limits = breakdown_slips(m, omega_k_rad_s);
  double low = limits.regenerating, high = limits.motoring;
  const double sign = omega_k_rad_s < 0 ? -1.0 : 1.0;
  for (int n = 0; n < 100; ++n) {
    const double middle = 0.5 * (low + high);
    const double torque = sign * steady_point(m, voltage_peak_v, omega_k_rad_s, middle).torque_nm;
    (torque < sign * torque_nm ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace vinv::plant
