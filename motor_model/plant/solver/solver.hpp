// The one interface between the plant's equations and the integrators. Time is seconds since the last restart that
// the owner chose as zero; states live in the solver and may be written only before restart().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

inline constexpr std::size_t kMaxCoreStates = 8;
inline constexpr std::size_t kMaxRoots = 8;

// Plain functions over a model: nothing virtual inside the right-hand side. Both return 0.
struct OdeSystem {
  std::size_t states = 0;
  std::size_t core_states = 0;                 // the first of them; only they steer step size and Newton
  std::size_t roots = 0;                       // act when they rise through zero
  std::array<double, kMaxCoreStates> floor{};  // tolerance of a state: relative * (|y| + floor)
  const void* model = nullptr;
  int (*right_hand_side)(const void* model, double t, const double* y, double* dy) = nullptr;
  int (*comparators)(const void* model, double t, const double* y, double* g) = nullptr;
};

struct SolverStop {
  double t = 0;             // t_end, or the instant of the first root or of the failure
  std::uint32_t roots = 0;  // bit i: root i rose through zero at t
  bool failed = false;      // gave up at t; states() are those of t
};

class Solver {
 public:
  virtual ~Solver() = default;

  // States at the time of the last stop; write them, then restart.
  virtual double* states() = 0;
  // Begins anew at t from states(): no history, no step size is kept, so that equal states continue equally.
  virtual void restart(double t) = 0;
  // Integrates to t_end or to the first root. t_end must lie at least kShortestAdvance ahead.
  virtual SolverStop advance(double t_end) = 0;
  // Why the last advance failed.
  virtual const std::string& error() const = 0;
  virtual std::uint64_t rhs_calls() const = 0;
};

inline constexpr double kShortestAdvance = 5e-10;  // s; half of the integer clock's step

std::unique_ptr<Solver> make_solver(const OdeSystem& system, const SolverSettings& settings);

std::unique_ptr<Solver> make_erk_solver(const OdeSystem& system, const SolverSettings& settings);
std::unique_ptr<Solver> make_cvode_solver(const OdeSystem& system, const SolverSettings& settings);
std::unique_ptr<Solver> make_rk4_solver(const OdeSystem& system, const SolverSettings& settings);

}  // namespace vinv::plant
