// CVODE BDF with Newton and a dense matrix, for a stiff rectifier. A tenth of the given relative tolerance is asked of
// it: BDF errors add up where ERKStep's do not (docs/decisions/0001-plant-solver.md). Small changes of the inputs from
// tick to tick do not restart it.
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <limits>

#include "motor_model/plant/solver/sundials_solver.hpp"

namespace vinv::plant {

namespace {

class CvodeSolver final : public SundialsSolver {
 public:
  CvodeSolver(const OdeSystem& system, const SolverSettings& settings)
      : SundialsSolver(system, 0.1 * settings.relative_tolerance, "CVODE") {
    const auto n = static_cast<sunindextype>(system.states);
    matrix_ = SUNDenseMatrix(n, n, context_);
    linear_ = SUNLinSol_Dense(y_, matrix_, context_);
    memory_ = CVodeCreate(CV_BDF, context_);
    VINV_CHECK(matrix_ != nullptr && linear_ != nullptr && memory_ != nullptr);
    check(CVodeSetErrHandlerFn(memory_, note_error, user_data()));
    check(CVodeInit(memory_, right_hand_side, 0, y_));
    check(CVodeSetUserData(memory_, user_data()));
    check(CVodeWFtolerances(memory_, error_weights));
    check(CVodeSetMaxNumSteps(memory_, 10'000'000));
    check(CVodeSetLinearSolver(memory_, linear_, matrix_));
    check(CVodeSetJacFn(memory_, jacobian));
    if (system.roots > 0) {
      check(CVodeRootInit(memory_, static_cast<int>(system.roots), comparators));
      auto directions = rising();
      check(CVodeSetRootDirection(memory_, directions.data()));
      check(CVodeSetNoInactiveRootWarn(memory_));
    }
  }
  ~CvodeSolver() override {
    CVodeFree(&memory_);
    SUNLinSolFree(linear_);
    SUNMatDestroy(matrix_);
  }

  void restart(double t) override { check(CVodeReInit(memory_, t, y_)); }

  SolverStop advance(double t_end) override {
    check(CVodeSetStopTime(memory_, t_end));
    SolverStop stop;
    const int status = CVode(memory_, t_end, y_, &stop.t, CV_NORMAL);
    stop.failed = status < 0;
    if (status == CV_ROOT_RETURN) {
      std::array<int, kMaxRoots> found{};
      check(CVodeGetRootInfo(memory_, found.data()));
      stop.roots = root_bits(found);
    }
    return stop;
  }

 private:
  // Difference quotients in the core states only: nothing depends on the others but their own slow decay.
  static int jacobian(realtype t, N_Vector y, N_Vector dy, SUNMatrix matrix, void* self_pointer, N_Vector, N_Vector,
                      N_Vector shifted) {
    auto& self = static_cast<CvodeSolver&>(of(self_pointer));
    const auto n = self.system_.states;
    double* values = NV_DATA_S(y);
    const double* base = NV_DATA_S(dy);
    double* slope = NV_DATA_S(shifted);
    SUNMatZero(matrix);
    for (std::size_t column = 0; column < self.system_.core_states; ++column) {
      const double kept = values[column];
      const double change = std::sqrt(std::numeric_limits<double>::epsilon()) * (std::abs(kept) + 1e-3);
      values[column] = kept + change;
      self.evaluate(t, values, slope);
      values[column] = kept;
      double* out = SM_COLUMN_D(matrix, static_cast<sunindextype>(column));
      for (std::size_t row = 0; row < n; ++row) out[row] = (slope[row] - base[row]) / change;
    }
    return 0;
  }

  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
};

}  // namespace

std::unique_ptr<Solver> make_cvode_solver(const OdeSystem& system, const SolverSettings& settings) {
  return std::make_unique<CvodeSolver>(system, settings);
}

}  // namespace vinv::plant
