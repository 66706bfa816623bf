// ARKODE ERKStep with the Bogacki-Shampine 3(2) pair. SUNDIALS 6.4.1: this table is truly first-same-as-last, others
// with last c = 1 lose order in ERKStep; a re-initialisation clears the stop time, so it is set before every advance.
#include <arkode/arkode_erkstep.h>

#include "motor_model/plant/solver/sundials_solver.hpp"

namespace vinv::plant {

namespace {

// After a restart: short against every time constant of the plant; error control lets it grow at once.
constexpr double kFirstStep = 2e-5;

class ErkSolver final : public SundialsSolver {
 public:
  ErkSolver(const OdeSystem& system, const SolverSettings& settings)
      : SundialsSolver(system, settings.relative_tolerance, "ERKStep") {
    memory_ = ERKStepCreate(right_hand_side, 0, y_, context_);
    VINV_CHECK(memory_ != nullptr);
    check(ERKStepSetErrHandlerFn(memory_, note_error, user_data()));
    check(ERKStepSetUserData(memory_, user_data()));
    check(ERKStepSetTableNum(memory_, ARKODE_BOGACKI_SHAMPINE_4_2_3));
    check(ERKStepWFtolerances(memory_, error_weights));
    check(ERKStepSetMaxNumSteps(memory_, 10'000'000));
    check(ERKStepSetInterpolantDegree(memory_, 3));
    if (system.roots > 0) {
      check(ERKStepRootInit(memory_, static_cast<int>(system.roots), comparators));
      auto directions = rising();
      check(ERKStepSetRootDirection(memory_, directions.data()));
      check(ERKStepSetNoInactiveRootWarn(memory_));
    }
  }
  ~ErkSolver() override { ERKStepFree(&memory_); }

  void restart(double t) override {
    check(ERKStepReInit(memory_, right_hand_side, t, y_));
    check(ERKStepSetInitStep(memory_, kFirstStep));
  }

  SolverStop advance(double t_end) override {
    check(ERKStepSetStopTime(memory_, t_end));
    SolverStop stop;
    const int status = ERKStepEvolve(memory_, t_end, y_, &stop.t, ARK_NORMAL);
    stop.failed = status < 0;
    if (status == ARK_ROOT_RETURN) {
      std::array<int, kMaxRoots> found{};
      check(ERKStepGetRootInfo(memory_, found.data()));
      stop.roots = root_bits(found);
    }
    return stop;
  }
};

}  // namespace

std::unique_ptr<Solver> make_erk_solver(const OdeSystem& system, const SolverSettings& settings) {
  return std::make_unique<ErkSolver>(system, settings);
}

}  // namespace vinv::plant
