// Classical Runge-Kutta of order 4 with a fixed step: baseline and independent check, no error control. Roots: a
// change of sign over a step, located by repeating the step with another length.
#include <algorithm>
#include <cmath>
#include <vector>

#include "motor_model/plant/solver/solver.hpp"

namespace vinv::plant {

namespace {

class Rk4Solver final : public Solver {
 public:
  Rk4Solver(const OdeSystem& system, const SolverSettings& settings)
      : system_(system), step_(settings.fixed_step_s), work_(7 * system.states) {}

  double* states() override { return work_.data(); }

  void restart(double t) override {
    t_ = t;
    fresh_ = true;
  }

  SolverStop advance(double t_end) override {
    if (fresh_) evaluate_comparators(t_, y(), before_);
    fresh_ = false;
    const double start = t_;
    const double span = t_end - start;
    const auto steps = static_cast<std::int64_t>(std::ceil(span / step_ - 1e-9));
    for (std::int64_t n = 1; n <= steps; ++n) {
      const double next_t = n == steps ? t_end : start + span * static_cast<double>(n) / static_cast<double>(steps);
      const double h = next_t - t_;
      take_step(h);
      evaluate_comparators(next_t, next(), after_);
      if (crossed(after_) != 0) return stop_at_root(h);
      accept(next_t);
    }
    // Without error control a run-away shows only here.
    const bool finite = std::all_of(y(), y() + system_.states, [](double x) { return std::isfinite(x); });
    return {t_end, 0, !finite};
  }

  const std::string& error() const override { return error_; }
  std::uint64_t rhs_calls() const override { return rhs_calls_; }

 private:
  double* y() { return work_.data(); }
  double* part(std::size_t n) { return work_.data() + n * system_.states; }
  double* next() { return part(1); }

  void right_hand_side(double t, const double* y, double* dy) {
    ++rhs_calls_;
    system_.right_hand_side(system_.model, t, y, dy);
  }

  // next() = y() integrated by h.
  void take_step(double h) {
    const std::size_t n = system_.states;
    double* const stage = part(2);
    double* const k1 = part(3);
    double* const k2 = part(4);
    double* const k3 = part(5);
    double* const k4 = part(6);
    const double* const from = y();
    double* const to = next();
    right_hand_side(t_, from, k1);
    for (std::size_t i = 0; i < n; ++i) stage[i] = from[i] + 0.5 * h * k1[i];
    right_hand_side(t_ + 0.5 * h, stage, k2);
    for (std::size_t i = 0; i < n; ++i) stage[i] = from[i] + 0.5 * h * k2[i];
    right_hand_side(t_ + 0.5 * h, stage, k3);
    for (std::size_t i = 0; i < n; ++i) stage[i] = from[i] + h * k3[i];
    right_hand_side(t_ + h, stage, k4);
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i] + h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
  }

  using Signs = std::array<double, kMaxRoots>;

  void evaluate_comparators(double t, const double* y, Signs& g) const {
    if (system_.roots > 0) system_.comparators(system_.model, t, y, g.data());
  }
  std::uint32_t crossed(const Signs& after) const {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < system_.roots; ++i) bits |= before_[i] < 0 && after[i] >= 0 ? 1u << i : 0u;
    return bits;
  }

  // The step of length h has passed a root: halve until the first one lies within a picosecond below the length taken.
  SolverStop stop_at_root(double h) {
    double low = 0, high = h;
    while (high - low > 1e-12) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      take_step(middle);
      evaluate_comparators(t_ + middle, next(), after_);
      (crossed(after_) != 0 ? high : low) = middle;
    }
    take_step(high);
    evaluate_comparators(t_ + high, next(), after_);
    const std::uint32_t bits = crossed(after_);
    accept(t_ + high);
    return {t_, bits, false};
  }

  void accept(double t) {
    t_ = t;
    std::copy_n(next(), system_.states, y());
    before_ = after_;
  }

  OdeSystem system_;
  double step_;
  double t_ = 0;
  bool fresh_ = true;
  Signs before_{}, after_{};
  std::vector<double> work_;  // y, next, stage, k1..k4
  std::uint64_t rhs_calls_ = 0;
  std::string error_ = "RK4: state is not finite";
};

}  // namespace

std::unique_ptr<Solver> make_rk4_solver(const OdeSystem& system, const SolverSettings& settings) {
  return std::make_unique<Rk4Solver>(system, settings);
}

}  // namespace vinv::plant
