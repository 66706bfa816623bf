// CVODE BDF with Newton and a dense matrix, for a stiff rectifier. A tenth of the given relative tolerance is asked of
// it: BDF errors add up where ERKStep's do not (docs/decisions/0001-plant-solver.md). Small changes of the inputs from
// tick to tick do not restart it.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmath>
#include <limits>
#include <string>

#include "motor_model/plant/solver/solver.hpp"
#include "motor_model/plant/solver/vector_ops.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

class CvodeSolver final : public Solver {
 public:
  CvodeSolver(const OdeSystem& system, const SolverSettings& settings)
      : system_(system), relative_tolerance_(0.1 * settings.relative_tolerance) {
    weight_scale_ = std::sqrt(static_cast<double>(system.states));
    VINV_CHECK(SUNContext_Create(nullptr, &context_) == 0);
    const auto n = static_cast<sunindextype>(system.states);
    y_ = N_VNew_Serial(n, context_);
    VINV_CHECK(y_ != nullptr);
    use_short_vector_operations(y_);
    N_VConst(0, y_);
    matrix_ = SUNDenseMatrix(n, n, context_);
    linear_ = SUNLinSol_Dense(y_, matrix_, context_);
    memory_ = CVodeCreate(CV_BDF, context_);
    VINV_CHECK(matrix_ != nullptr && linear_ != nullptr && memory_ != nullptr);
    check(CVodeSetErrHandlerFn(memory_, note_error, this));
    check(CVodeInit(memory_, right_hand_side, 0, y_));
    check(CVodeSetUserData(memory_, this));
    check(CVodeWFtolerances(memory_, error_weights));
    check(CVodeSetMaxNumSteps(memory_, 10'000'000));
    check(CVodeSetLinearSolver(memory_, linear_, matrix_));
    check(CVodeSetJacFn(memory_, jacobian));
    if (system.roots > 0) {
      check(CVodeRootInit(memory_, static_cast<int>(system.roots), comparators));
      std::array<int, kMaxRoots> rising;
      rising.fill(1);
      check(CVodeSetRootDirection(memory_, rising.data()));
      check(CVodeSetNoInactiveRootWarn(memory_));
    }
  }
  ~CvodeSolver() override {
    CVodeFree(&memory_);
    SUNLinSolFree(linear_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  CvodeSolver(const CvodeSolver&) = delete;
  CvodeSolver& operator=(const CvodeSolver&) = delete;

  double* states() override { return N_VGetArrayPointer_Serial(y_); }

  void restart(double t) override { check(CVodeReInit(memory_, t, y_)); }

  SolverStop advance(double t_end) override {
    check(CVodeSetStopTime(memory_, t_end));
    SolverStop stop;
    const int status = CVode(memory_, t_end, y_, &stop.t, CV_NORMAL);
    stop.failed = status < 0;
    if (status == CV_ROOT_RETURN) {
      std::array<int, kMaxRoots> found{};
      check(CVodeGetRootInfo(memory_, found.data()));
      for (std::size_t i = 0; i < system_.roots; ++i) stop.roots |= found[i] > 0 ? 1u << i : 0u;
    }
    return stop;
  }

  const std::string& error() const override { return error_; }
  std::uint64_t rhs_calls() const override { return rhs_calls_; }

 private:
  static int right_hand_side(realtype t, N_Vector y, N_Vector dy, void* self_pointer) {
    auto& self = *static_cast<CvodeSolver*>(self_pointer);
    ++self.rhs_calls_;
    return self.system_.right_hand_side(self.system_.model, t, NV_DATA_S(y), NV_DATA_S(dy));
  }
  static int comparators(realtype t, N_Vector y, realtype* g, void* self_pointer) {
    const auto& self = *static_cast<CvodeSolver*>(self_pointer);
    return self.system_.comparators(self.system_.model, t, NV_DATA_S(y), g);
  }
  static int error_weights(N_Vector y, N_Vector weights, void* self_pointer) {
    const auto& self = *static_cast<CvodeSolver*>(self_pointer);
    const double* values = NV_DATA_S(y);
    double* w = NV_DATA_S(weights);
    for (std::size_t i = 0; i < self.system_.core_states; ++i) {
      w[i] = self.weight_scale_ / (self.relative_tolerance_ * (std::abs(values[i]) + self.system_.floor[i]));
    }
    for (std::size_t i = self.system_.core_states; i < self.system_.states; ++i) w[i] = kNoWeight;
    return 0;
  }
  // Difference quotients in the core states only: nothing depends on the others but their own slow decay.
  static int jacobian(realtype t, N_Vector y, N_Vector dy, SUNMatrix matrix, void* self_pointer, N_Vector, N_Vector,
                      N_Vector shifted) {
    auto& self = *static_cast<CvodeSolver*>(self_pointer);
    const auto n = self.system_.states;
    double* values = NV_DATA_S(y);
    const double* base = NV_DATA_S(dy);
    double* slope = NV_DATA_S(shifted);
    SUNMatZero(matrix);
    for (std::size_t column = 0; column < self.system_.core_states; ++column) {
      const double kept = values[column];
      const double change = std::sqrt(std::numeric_limits<double>::epsilon()) * (std::abs(kept) + 1e-3);
      values[column] = kept + change;
      ++self.rhs_calls_;
      self.system_.right_hand_side(self.system_.model, t, values, slope);
      values[column] = kept;
      double* out = SM_COLUMN_D(matrix, static_cast<sunindextype>(column));
      for (std::size_t row = 0; row < n; ++row) out[row] = (slope[row] - base[row]) / change;
    }
    return 0;
  }
  static void note_error(int, const char*, const char* function, char* message, void* self_pointer) {
    static_cast<CvodeSolver*>(self_pointer)->error_ = std::string(function) + ": " + message;
  }
  void check(int status) const {
    if (status < 0) throw SolverFailure("CVODE set-up: " + error_);
  }

  static constexpr double kNoWeight = 1e-20;

  OdeSystem system_;
  double relative_tolerance_;
  double weight_scale_ = 1;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
  void* memory_ = nullptr;
  std::uint64_t rhs_calls_ = 0;
  std::string error_;
};

}  // namespace

std::unique_ptr<Solver> make_cvode_solver(const OdeSystem& system, const SolverSettings& settings) {
  return std::make_unique<CvodeSolver>(system, settings);
}

}  // namespace vinv::plant
