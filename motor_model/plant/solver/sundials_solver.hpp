// What the SUNDIALS integrators have in common: context, state vector, callbacks into the system, error weights, messages.
// For solver/*.cpp only.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <array>
#include <cmath>
#include <string>

#include "motor_model/plant/solver/solver.hpp"
#include "motor_model/plant/solver/vector_ops.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

class SundialsSolver : public Solver {
 public:
  SundialsSolver(const OdeSystem& system, double relative_tolerance, const char* name)
      : system_(system), relative_tolerance_(relative_tolerance), name_(name) {
    // The solver's norm is a root mean square over all states; this makes it the plain norm over the core states.
    weight_scale_ = std::sqrt(static_cast<double>(system.states));
    VINV_CHECK(SUNContext_Create(nullptr, &context_) == 0);
    y_ = N_VNew_Serial(static_cast<sunindextype>(system.states), context_);
    VINV_CHECK(y_ != nullptr);
    use_short_vector_operations(y_);
    N_VConst(0, y_);
  }
  // Derived solvers have freed their memory by now.
  ~SundialsSolver() override {
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  SundialsSolver(const SundialsSolver&) = delete;
  SundialsSolver& operator=(const SundialsSolver&) = delete;

  double* states() override { return N_VGetArrayPointer_Serial(y_); }
  const std::string& error() const override { return error_; }
  std::uint64_t rhs_calls() const override { return rhs_calls_; }

 protected:
  // What callbacks get back as self_pointer.
  void* user_data() { return static_cast<SundialsSolver*>(this); }
  static SundialsSolver& of(void* self_pointer) { return *static_cast<SundialsSolver*>(self_pointer); }

  static int right_hand_side(realtype t, N_Vector y, N_Vector dy, void* self_pointer) {
    return of(self_pointer).evaluate(t, NV_DATA_S(y), NV_DATA_S(dy));
  }
  static int comparators(realtype t, N_Vector y, realtype* g, void* self_pointer) {
    const SundialsSolver& self = of(self_pointer);
    return self.system_.comparators(self.system_.model, t, NV_DATA_S(y), g);
  }
  static int error_weights(N_Vector y, N_Vector weights, void* self_pointer) {
    const SundialsSolver& self = of(self_pointer);
    const double* values = NV_DATA_S(y);
    double* w = NV_DATA_S(weights);
    for (std::size_t i = 0; i < self.system_.core_states; ++i) {
      w[i] = self.weight_scale_ / (self.relative_tolerance_ * (std::abs(values[i]) + self.system_.floor[i]));
    }
    for (std::size_t i = self.system_.core_states; i < self.system_.states; ++i) w[i] = kNoWeight;
    return 0;
  }
  static void note_error(int, const char*, const char* function, char* message, void* self_pointer) {
    of(self_pointer).error_ = std::string(function) + ": " + message;
  }

  int evaluate(double t, const double* y, double* dy) {
    ++rhs_calls_;
    return system_.right_hand_side(system_.model, t, y, dy);
  }
  void check(int status) const {
    if (status < 0) throw SolverFailure(std::string(name_) + " set-up: " + error_);
  }
  // Roots act when they rise.
  static std::array<int, kMaxRoots> rising() {
    std::array<int, kMaxRoots> directions;
    directions.fill(1);
    return directions;
  }
  std::uint32_t root_bits(const std::array<int, kMaxRoots>& found) const {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < system_.roots; ++i) bits |= found[i] > 0 ? 1u << i : 0u;
    return bits;
  }

  OdeSystem system_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  void* memory_ = nullptr;

 private:
  static constexpr double kNoWeight = 1e-20;

  double relative_tolerance_;
  double weight_scale_ = 1;
  const char* name_;
  std::uint64_t rhs_calls_ = 0;
  std::string error_;
};

}  // namespace vinv::plant
