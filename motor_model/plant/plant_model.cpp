#include "motor_model/plant/plant_model.hpp"

#include <cmath>

namespace vinv::plant {

namespace {

// Inlined into both users; the right-hand side keeps only what it needs.
[[gnu::always_inline]] inline Flows compute_flows(const PlantModel& m, double t, const double* y) {
  Flows f;
  const FluxPair psi = flux_of(y);
  const double omega = y[state::kOmegaMech];
  const double v = y[state::kDcLink];

  if (m.on_line) {
    f.i = currents(m.machine, psi);
    f.stator_peak_v = m.line_peak_v;
    f.d_psi = flux_derivative(m.machine, psi, f.i, m.line_peak_v, m.line_omega, omega);
    f.torque_nm = air_gap_torque(m.machine, psi, f.i);
    f.current_squared = f.i.i_sd * f.i.i_sd + f.i.i_sq * f.i.i_sq;
    f.output_w = 1.5 * m.line_peak_v * f.i.i_sd;
    f.iron_w = m.iron_w_per_wb2 * (psi.psi_sd * psi.psi_sd + psi.psi_sq * psi.psi_sq);
    f.line_w = f.output_w + f.iron_w;
  } else if (m.gates_on) {
    f.i = currents(m.machine, psi);
    const double since = t - m.t_input;
    const double modulated = modulation(m.commanded_peak_v + m.commanded_peak_slope * since, v);
    f.stator_peak_v = modulated * v;
    f.d_psi = flux_derivative(m.machine, psi, f.i, f.stator_peak_v, m.omega_k + m.omega_k_slope * since, omega);
    f.torque_nm = air_gap_torque(m.machine, psi, f.i);
    f.current_squared = f.i.i_sd * f.i.i_sd + f.i.i_sq * f.i.i_sq;
    f.output_w = 1.5 * f.stator_peak_v * f.i.i_sd;
    const double loss_a = 1.5 * m.inverter_loss_fraction * modulated * std::sqrt(f.current_squared);
    f.inverter_w = loss_a * v;
    f.link_current_a = 1.5 * modulated * f.i.i_sd + loss_a;
    if (m.iron_w_per_wb2 > 0 && v > 0) {
      f.iron_w = m.iron_w_per_wb2 * (psi.psi_sd * psi.psi_sd + psi.psi_sq * psi.psi_sq) * sustained_fraction(m.link, v);
      f.link_current_a += f.iron_w / v;
    }
  } else {
    f.i.i_rd = psi.psi_rd / m.machine.L_r;
    f.i.i_rq = psi.psi_rq / m.machine.L_r;
    f.d_psi = open_stator_derivative(m.machine, psi);
  }

  f.shaft = shaft_torques(m.load, t, omega);
  f.rectifier = rectifier_flow(m.rectifier, v);
  if (m.link.standby_w > 0 && v > 0) {
    f.standby_w = standby_power(m.link, v);
    f.link_current_a += f.standby_w / v;
  }
  if (m.chopper_on) {
    f.brake_w = v * v * m.link.brake_conductance_s;
    f.link_current_a += v * m.link.brake_conductance_s;
  }
  return f;
}

int right_hand_side(const void* model, double t, const double* y, double* dy) {
  const PlantModel& m = *static_cast<const PlantModel*>(model);
  const Flows f = compute_flows(m, t, y);
  const double omega = y[state::kOmegaMech];
  const double v = y[state::kDcLink];

  dy[state::kPsiSd] = f.d_psi.psi_sd;
  dy[state::kPsiSq] = f.d_psi.psi_sq;
  dy[state::kPsiRd] = f.d_psi.psi_rd;
  dy[state::kPsiRq] = f.d_psi.psi_rq;
  const bool standing = m.load.locked || m.load.mode == ShaftMode::kHeld;
  dy[state::kOmegaMech] =
      standing ? 0.0 : (f.torque_nm - f.shaft.friction_nm - f.shaft.load_nm) * m.load.inverse_inertia;
  dy[state::kDcLink] = (f.rectifier.current_a - f.link_current_a) * m.link.inverse_capacitance;

  dy[state::kHeatSink] = heat_sink_slope(m.thermal, y[state::kHeatSink], f.inverter_w);
  dy[state::kWinding] = winding_slope(m.thermal, y[state::kWinding], f.current_squared);

  dy[state::kFromMains] = f.rectifier.mains_w + f.line_w;
  dy[state::kStatorCopper] = 1.5 * m.machine.R_s * f.current_squared;
  dy[state::kRotorCopper] = 1.5 * m.machine.R_r * (f.i.i_rd * f.i.i_rd + f.i.i_rq * f.i.i_rq);
  dy[state::kIron] = f.iron_w;
  dy[state::kInverter] = f.inverter_w;
  dy[state::kStandby] = f.standby_w;
  dy[state::kSource] = f.rectifier.mains_w - v * f.rectifier.current_a;
  dy[state::kBrake] = f.brake_w;
  dy[state::kFriction] = f.shaft.friction_nm * omega;
  dy[state::kLoad] = f.shaft.load_nm * omega;

  dy[state::kFrameAngle] = m.on_line    ? m.line_omega
                           : m.gates_on ? m.omega_k + m.omega_k_slope * (t - m.t_input)
                                        : m.machine.pole_pairs * omega;
  return 0;
}

int comparators(const void* model, double t, const double* y, double* g) {
  const PlantModel& m = *static_cast<const PlantModel*>(model);
  g[root::kOverCurrent] = -1;
  if (m.gates_on && m.over_current_squared > 0) {
    const CurrentPair i = currents(m.machine, flux_of(y));
    g[root::kOverCurrent] = i.i_sd * i.i_sd + i.i_sq * i.i_sq - m.over_current_squared;
  }
  g[root::kLinkAbove] = y[state::kDcLink] - m.link_above_v;
  g[root::kLinkBelow] = m.link_below_v - y[state::kDcLink];
  g[root::kShaft] = -1;
  if (!m.load.locked && m.load.mode != ShaftMode::kFree) {
    g[root::kShaft] = m.load.mode == ShaftMode::kHeld ? std::abs(net_torque_at_rest(m, y)) - holding_torque(m.load, t)
                                                      : -sliding_sign(m.load.mode) * y[state::kOmegaMech];
  }
  return 0;
}

}  // namespace

Flows flows(const PlantModel& model, double t, const double* y) { return compute_flows(model, t, y); }

double net_torque_at_rest(const PlantModel& m, const double* y) {
  if (!m.fed()) return -m.load.hoist_nm;
  const FluxPair psi = flux_of(y);
  return air_gap_torque(m.machine, psi, currents(m.machine, psi)) - m.load.hoist_nm;
}

double stored_energy(const PlantModel& m, const double* y) {
  const FluxPair psi = flux_of(y);
  const double omega = y[state::kOmegaMech], v = y[state::kDcLink];
  const double capacitance = m.link.inverse_capacitance > 0 ? 1 / m.link.inverse_capacitance : 0;
  return magnetic_energy(psi, currents(m.machine, psi)) + 0.5 * m.load.inertia * omega * omega +
         0.5 * capacitance * v * v;
}

void open_stator(const PlantModel& m, double* y) {
  const double image = m.machine.L_m / m.machine.L_r;
  y[state::kPsiSd] = image * y[state::kPsiRd];
  y[state::kPsiSq] = image * y[state::kPsiRq];
}

void align_frame(double angle_rad, double* y) {
  const double turn = angle_rad - y[state::kFrameAngle];
  const double c = std::cos(turn), s = std::sin(turn);
  for (const std::size_t d : {state::kPsiSd, state::kPsiRd}) {
    const double psi_d = y[d], psi_q = y[d + 1];
    y[d] = c * psi_d + s * psi_q;
    y[d + 1] = c * psi_q - s * psi_d;
  }
  y[state::kFrameAngle] = angle_rad;
}

OdeSystem ode_system(const PlantModel& model) {
  OdeSystem system;
  system.states = state::kStates;
  system.core_states = state::kCoreStates;
  system.roots = root::kRoots;
  for (std::size_t i = 0; i < state::kCoreStates; ++i) system.floor[i] = kStateFloor[i];
  system.model = &model;
  system.right_hand_side = right_hand_side;
  system.comparators = comparators;
  return system;
}

}  // namespace vinv::plant
