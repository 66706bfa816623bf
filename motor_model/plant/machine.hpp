// Induction machine, 5th order: two flux vectors and the shaft. Symmetric, linear T model (no saturation).
//
//   d(psi_s)/dt = u_s - R_s i_s - j omega_k psi_s
//   d(psi_r)/dt =     - R_r i_r - j (omega_k - p omega_mech) psi_r
//   i_s = (L_r psi_s - L_m psi_r) / D,  i_r = (L_s psi_r - L_m psi_s) / D,  D = L_s L_r - L_m^2
//   T_e = 3/2 p Im(conj(psi_s) i_s)
//
// Complex vectors x = x_d + j x_q, peak values, in a frame that turns with omega_k. The d axis lies on the stator
// voltage vector, so u_s = U + j0. Symbols: motor_model/README.md.
#pragma once

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

// Constants of the flux equations, computed once.
struct MachineModel {
  double R_s = 0, R_r = 0;  // ohm
  double L_s = 0, L_r = 0;  // H, self inductances
  double L_m = 0;
  double L_sigma = 0;  // D / L_r: what the stator current sees while the rotor flux stands still
  double gamma_s = 0;  // L_r / D
  double gamma_r = 0;  // L_s / D
  double gamma_m = 0;  // L_m / D
  double pole_pairs = 1;

  MachineModel() = default;
  explicit MachineModel(const MachineParameters& machine);
};

struct FluxPair {
  double psi_sd = 0, psi_sq = 0, psi_rd = 0, psi_rq = 0;  // Wb
};

struct CurrentPair {
  double i_sd = 0, i_sq = 0, i_rd = 0, i_rq = 0;  // A peak
};

inline CurrentPair currents(const MachineModel& m, const FluxPair& psi) {
  return {m.gamma_s * psi.psi_sd - m.gamma_m * psi.psi_rd, m.gamma_s * psi.psi_sq - m.gamma_m * psi.psi_rq,
          m.gamma_r * psi.psi_rd - m.gamma_m * psi.psi_sd, m.gamma_r * psi.psi_rq - m.gamma_m * psi.psi_sq};
}

inline double air_gap_torque(const MachineModel& m, const FluxPair& psi, const CurrentPair& i) {
  return 1.5 * m.pole_pairs * (psi.psi_sd * i.i_sq - psi.psi_sq * i.i_sd);
}

// Stator voltage u_d on the d axis.
inline FluxPair flux_derivative(const MachineModel& m, const FluxPair& psi, const CurrentPair& i, double u_d,
                                double omega_k, double omega_mech) {
  const double omega_slip = omega_k - m.pole_pairs * omega_mech;
  return {u_d - m.R_s * i.i_sd + omega_k * psi.psi_sq, -m.R_s * i.i_sq - omega_k * psi.psi_sd,
          -m.R_r * i.i_rd + omega_slip * psi.psi_rq, -m.R_r * i.i_rq - omega_slip * psi.psi_rd};
}

// Open stator (i_s = 0) in the rotor's own frame: the rotor flux decays, the stator flux is its image.
inline FluxPair open_stator_derivative(const MachineModel& m, const FluxPair& psi) {
  const double decay = -m.R_r / m.L_r;
  const double image = m.L_m / m.L_r * decay;
  return {image * psi.psi_rd, image * psi.psi_rq, decay * psi.psi_rd, decay * psi.psi_rq};
}

// Magnetic energy of the machine, J.
inline double magnetic_energy(const FluxPair& psi, const CurrentPair& i) {
  return 0.75 * (psi.psi_sd * i.i_sd + psi.psi_sq * i.i_sq + psi.psi_rd * i.i_rd + psi.psi_rq * i.i_rq);
}

}  // namespace vinv::plant
