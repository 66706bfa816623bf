#include "tests/motor_model/plant/plant_trace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace vinv::plant::test {

PlantTrace::PlantTrace(std::string_view machine, double total_inertia_kg_m2, Input input, SolverSettings solver)
    : input_(std::move(input)) {
  const MachineParameters* parameters = find_machine(machine);
  if (parameters == nullptr) throw std::runtime_error("no machine " + std::string(machine));
  model.machine = MachineModel(*parameters);
  model.load.inertia = total_inertia_kg_m2;
  model.load.inverse_inertia = 1 / total_inertia_kg_m2;
  model.gates_on = true;
  model.link_above_v = 1e9;
  model.link_below_v = -1e9;
  model.thermal = Thermal({}, *parameters, 25);
  inner_ = ode_system(model);
  OdeSystem system = inner_;
  system.model = this;
  system.right_hand_side = right_hand_side;
  system.comparators = comparators;
  solver_ = make_solver(system, solver);
}

void PlantTrace::use_link(const LinkSettings& link) {
  model.link.inverse_capacitance = 1 / link.capacitance_f;
  model.link.nominal_v = link.open_circuit_v;
  model.link.inverse_nominal_v2 = 1 / (link.open_circuit_v * link.open_circuit_v);
  model.rectifier = {link.open_circuit_v, 1 / link.source_resistance_ohm, false, true};
}

void PlantTrace::start(const FluxPair& psi, double omega_mech, double link_v) {
  std::fill_n(y(), state::kStates, 0.0);
  y()[state::kPsiSd] = psi.psi_sd;
  y()[state::kPsiSq] = psi.psi_sq;
  y()[state::kPsiRd] = psi.psi_rd;
  y()[state::kPsiRq] = psi.psi_rq;
  y()[state::kOmegaMech] = omega_mech;
  y()[state::kDcLink] = link_v;
  t_ = 0;
  solver_->restart(0);
}

bool PlantTrace::run_to(double t) {
  while (t - t_ > kShortestAdvance) {
    const SolverStop stop = solver_->advance(t);
    if (stop.failed) throw std::runtime_error(solver_->error());
    t_ = stop.t;
    if ((stop.roots >> root::kLinkAbove & 1u) != 0) return true;
    if ((stop.roots >> root::kShaft & 1u) != 0) turn_or_hold();
  }
  return false;
}

// The shaft has come to rest, or dry torque no longer holds it.
void PlantTrace::turn_or_hold() {
  const double net = net_torque_at_rest(at(t_), y());
  const bool held = model.load.mode != ShaftMode::kHeld && std::abs(net) <= holding_torque(model.load, t_);
  model.load.mode = held ? ShaftMode::kHeld : net > 0 ? ShaftMode::kForward : ShaftMode::kReverse;
  y()[state::kOmegaMech] = 0;
  solver_->restart(t_);
}

void PlantTrace::turn_frame(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  for (const std::size_t d : {state::kPsiSd, state::kPsiRd}) {
    const double psi_d = y()[d], psi_q = y()[d + 1];
    y()[d] = c * psi_d + s * psi_q;
    y()[d + 1] = c * psi_q - s * psi_d;
  }
}

double PlantTrace::current_peak() { return std::sqrt(now().current_squared); }

const PlantModel& PlantTrace::at(double t) const {
  // The model is the input's only destination; between two calls nobody else looks at it.
  auto& changing = const_cast<PlantModel&>(model);
  const TraceInput input = input_(t);
  changing.commanded_peak_v = input.voltage_peak_v;
  changing.omega_k = 2 * std::numbers::pi * input.frequency_hz;
  return model;
}

int PlantTrace::right_hand_side(const void* self_pointer, double t, const double* y, double* dy) {
  const auto& self = *static_cast<const PlantTrace*>(self_pointer);
  return self.inner_.right_hand_side(&self.at(t), t, y, dy);
}

int PlantTrace::comparators(const void* self_pointer, double t, const double* y, double* g) {
  const auto& self = *static_cast<const PlantTrace*>(self_pointer);
  return self.inner_.comparators(&self.at(t), t, y, g);
}

double vf_law(double frequency_hz, double boost_v, double nominal_v, double base_hz) {
  return boost_v + (nominal_v - boost_v) * std::min(std::abs(frequency_hz) / base_hz, 1.0);
}

}  // namespace vinv::plant::test
