#include "motor_model/inverter/mitsubishi/auto_tuning.hpp"

#include <algorithm>
#include <numbers>

namespace vinv::inverter::mitsubishi {
namespace {

constexpr double kSettle_s = 2.0;        // the current is brought to its aim
constexpr double kMeasure_s = 1.0;       // then voltage and current are averaged
constexpr double kAim = 0.5;             // of the rated current, peak
constexpr double kIntegral_per_s = 1.5;  // voltage per missing current, in units of limit over rated current
constexpr double kVoltageLimit = 0.2;    // of the highest phase voltage: more means that no motor is there

}  // namespace

void AutoTuning::start() {
  *this = AutoTuning{};
  running_ = true;
}

plant::StageInput AutoTuning::step(double period_s, double rated_current_a_rms, double voltage_limit_peak_v,
                                   const plant::PlantMeasurements& measured) {
  const double rated_peak = rated_current_a_rms * std::numbers::sqrt2;
  const double highest = kVoltageLimit * voltage_limit_peak_v;
  if (elapsed_s_ < kSettle_s) {
    const double missing = (kAim * rated_peak - measured.current_peak_a) / rated_peak;
    voltage_peak_v_ = std::clamp(voltage_peak_v_ + missing * kIntegral_per_s * highest * period_s, 0.0, highest);
  } else {
    sum_voltage_ += voltage_peak_v_;
    sum_current_ += measured.current_peak_a;
  }
  elapsed_s_ += period_s;
  if (elapsed_s_ >= kSettle_s + kMeasure_s) {
    running_ = false;
    const bool enough_current = sum_current_ > 0.25 * kAim * rated_peak * kMeasure_s / period_s;
    resistance_ohm_ = enough_current ? sum_voltage_ / sum_current_ : 0;
    return {};
  }
  plant::StageInput stage;
  stage.gates_on = true;
  stage.voltage_peak_v = voltage_peak_v_;
  return stage;
}

}  // namespace vinv::inverter::mitsubishi
