// ARKODE ERKStep with the Bogacki-Shampine 3(2) pair. SUNDIALS 6.4.1: this table is truly first-same-as-last, others
// with last c = 1 lose order in ERKStep; a re-initialisation clears the stop time, so it is set before every advance.
#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <cmath>
#include <string>

#include "motor_model/plant/solver/solver.hpp"
#include "motor_model/plant/solver/vector_ops.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

// After a restart: short against every time constant of the plant; error control lets it grow at once.
constexpr double kFirstStep = 2e-5;

class ErkSolver final : public Solver {
 public:
  ErkSolver(const OdeSystem& system, const SolverSettings& settings)
      : system_(system), relative_tolerance_(settings.relative_tolerance) {
    // The solver's norm is a root mean square over all states; this makes it the plain norm over the core states.
    weight_scale_ = std::sqrt(static_cast<double>(system.states));
    VINV_CHECK(SUNContext_Create(nullptr, &context_) == 0);
    y_ = N_VNew_Serial(static_cast<sunindextype>(system.states), context_);
    VINV_CHECK(y_ != nullptr);
    use_short_vector_operations(y_);
    N_VConst(0, y_);
    memory_ = ERKStepCreate(right_hand_side, 0, y_, context_);
    VINV_CHECK(memory_ != nullptr);
    check(ERKStepSetErrHandlerFn(memory_, note_error, this));
    check(ERKStepSetUserData(memory_, this));
    check(ERKStepSetTableNum(memory_, ARKODE_BOGACKI_SHAMPINE_4_2_3));
    check(ERKStepWFtolerances(memory_, error_weights));
    check(ERKStepSetMaxNumSteps(memory_, 10'000'000));
    check(ERKStepSetInterpolantDegree(memory_, 3));
    if (system.roots > 0) {
      check(ERKStepRootInit(memory_, static_cast<int>(system.roots), comparators));
      std::array<int, kMaxRoots> rising;
      rising.fill(1);
      check(ERKStepSetRootDirection(memory_, rising.data()));
      check(ERKStepSetNoInactiveRootWarn(memory_));
    }
  }
  ~ErkSolver() override {
    ERKStepFree(&memory_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  ErkSolver(const ErkSolver&) = delete;
  ErkSolver& operator=(const ErkSolver&) = delete;

  double* states() override { return N_VGetArrayPointer_Serial(y_); }

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
      for (std::size_t i = 0; i < system_.roots; ++i) stop.roots |= found[i] > 0 ? 1u << i : 0u;
    }
    return stop;
  }

  const std::string& error() const override { return error_; }
  std::uint64_t rhs_calls() const override { return rhs_calls_; }

 private:
  static int right_hand_side(realtype t, N_Vector y, N_Vector dy, void* self_pointer) {
    auto& self = *static_cast<ErkSolver*>(self_pointer);
    ++self.rhs_calls_;
    return self.system_.right_hand_side(self.system_.model, t, NV_DATA_S(y), NV_DATA_S(dy));
  }
  static int comparators(realtype t, N_Vector y, realtype* g, void* self_pointer) {
    const auto& self = *static_cast<ErkSolver*>(self_pointer);
    return self.system_.comparators(self.system_.model, t, NV_DATA_S(y), g);
  }
  static int error_weights(N_Vector y, N_Vector weights, void* self_pointer) {
    const auto& self = *static_cast<ErkSolver*>(self_pointer);
    const double* values = NV_DATA_S(y);
    double* w = NV_DATA_S(weights);
    for (std::size_t i = 0; i < self.system_.core_states; ++i) {
      w[i] = self.weight_scale_ / (self.relative_tolerance_ * (std::abs(values[i]) + self.system_.floor[i]));
    }
    for (std::size_t i = self.system_.core_states; i < self.system_.states; ++i) w[i] = kNoWeight;
    return 0;
  }
  static void note_error(int, const char*, const char* function, char* message, void* self_pointer) {
    static_cast<ErkSolver*>(self_pointer)->error_ = std::string(function) + ": " + message;
  }
  void check(int status) const {
    if (status < 0) throw SolverFailure("ERKStep set-up: " + error_);
  }

  static constexpr double kNoWeight = 1e-20;

  OdeSystem system_;
  double relative_tolerance_;
  double weight_scale_ = 1;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  void* memory_ = nullptr;
  std::uint64_t rhs_calls_ = 0;
  std::string error_;
};

}  // namespace

std::unique_ptr<Solver> make_erk_solver(const OdeSystem& system, const SolverSettings& settings) {
  return std::make_unique<ErkSolver>(system, settings);
}

}  // namespace vinv::plant
