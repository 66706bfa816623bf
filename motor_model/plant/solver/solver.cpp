#include "motor_model/plant/solver/solver.hpp"

namespace vinv::plant {

std::unique_ptr<Solver> make_solver(const OdeSystem& system, const SolverSettings& settings) {
  switch (settings.choice) {
    case SolverChoice::kCvodeBdf: return make_cvode_solver(system, settings);
    case SolverChoice::kRk4: return make_rk4_solver(system, settings);
    case SolverChoice::kErk: break;
  }
  return make_erk_solver(system, settings);
}

}  // namespace vinv::plant
