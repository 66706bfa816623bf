// Runs the plant's own right-hand side and solvers under inputs that are functions of time, for comparison with
// trajectories: direct mains (no DC link, the voltage is what the input says), or the whole link. Losses, friction and
// standby load are zero unless the test sets them in model.
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "motor_model/plant/plant_model.hpp"

namespace vinv::plant::test {

struct TraceInput {
  double voltage_peak_v = 0;
  double frequency_hz = 0;
};

struct LinkSettings {
  double capacitance_f = 0;
  double source_resistance_ohm = 0;
  double open_circuit_v = 0;
};

class PlantTrace {
 public:
  using Input = std::function<TraceInput(double t)>;

  PlantTrace(std::string_view machine, double total_inertia_kg_m2, Input input, SolverSettings solver = {});
  PlantTrace(const PlantTrace&) = delete;
  PlantTrace& operator=(const PlantTrace&) = delete;

  PlantModel model;  // load, link, locked shaft: set before start(), change between run_to() and jump()

  void use_link(const LinkSettings& link);
  // Link voltage whose first upward crossing is looked for from now on.
  void watch_link(double level_v) { model.link_above_v = level_v; }

  void start(const FluxPair& psi = {}, double omega_mech = 0, double link_v = 1e6);
  // An input has a kink or step here: the solver starts anew.
  void jump() { solver_->restart(t_); }
  // Integrates to t; a shaft that comes to rest under dry load is held. With a watched level: stops there, returns
  // true.
  bool run_to(double t);
  // The frame turns by this angle against the fluxes (a voltage vector that jumps in direction).
  void turn_frame(double angle_rad);

  double t() const { return t_; }
  double* y() { return solver_->states(); }
  double omega() { return y()[state::kOmegaMech]; }
  double link_v() { return y()[state::kDcLink]; }
  Flows now() { return flows(at(t_), t_, y()); }
  double current_peak();
  std::uint64_t rhs_calls() const { return solver_->rhs_calls(); }

 private:
  void turn_or_hold();
  const PlantModel& at(double t) const;
  static int right_hand_side(const void* self, double t, const double* y, double* dy);
  static int comparators(const void* self, double t, const double* y, double* g);

  Input input_;
  OdeSystem inner_;
  std::unique_ptr<Solver> solver_;
  double t_ = 0;
};

// U(f) = U_b + (U_n - U_b) min(|f| / f_b, 1), phase peaks.
double vf_law(double frequency_hz, double boost_v, double nominal_v, double base_hz);

}  // namespace vinv::plant::test
