// Commands of vector control that change from tick to tick: torque command, torque limits and stall level at the analog
// inputs, speed limit of torque control, method by MC, motor by RT. Typical for the family.
#include <algorithm>
#include <cmath>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/motor_settings.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

// Pr.868, Pr.858
enum TerminalFunction : int { kFrequency = 0, kRegenerativeLimit = 2, kTorque = 4, kSpeedLimit = 5 };

// Torque in percent of rated at an input in percent of full scale.
double torque_line(const ParameterStore& p, unsigned bias, unsigned gain, double percent) {
  const AnalogLine line{p.value(bias, 2), p.value(bias, 1), p.value(gain, 2), p.value(gain, 1)};
  return line.frequency(percent);
}

}  // namespace

// The motor is chosen while the output is off.
void A700Inverter::follow_motor(const mitsubishi::Inputs& inputs) {
  if (running()) return;
  s_.second_motor = inputs.signals.has(InputSignal::kRt) && !store_.is_9999(pr::kSecondAppliedMotor);
}

MotorSelection A700Inverter::motor_selection(const mitsubishi::SettingsSelection& s) const {
  return {(s.variant & kSecondMotor) != 0, s.vf_by_x18, (s.variant & kTorqueByMc) != 0};
}

bool A700Inverter::terminal_4_sets_frequency() const {
  return !store_.is_9999(pr::kTerminal4Function) && store_.integer(pr::kTerminal4Function) == kFrequency;
}

// Pr.804: 0 terminal 1 with Pr.868 = 4, 1 Pr.805 or 806, whichever was written last; the others belong to options.
double A700Inverter::torque_command_percent() const {
  switch (store_.integer(pr::kTorqueSource)) {
    case 0:
      if (store_.integer(pr::kTerminal1Function) != kTorque) return 0;
      return std::copysign(
          torque_line(store_, pr::kTerminal1TorqueBias, pr::kTerminal1TorqueGain, std::abs(s_.percent_1)),
          s_.percent_1);
    case 1: return store_.value(pr::kTorqueCommandRam) - 1000;
    default: return 0;
  }
}

// Pr.807: 0 the set frequency, 1 Pr.808 and 809, 2 terminal 1 with Pr.868 = 5: its sign says which direction it limits.
double A700Inverter::speed_limit(double set_hz, bool reverse) {
  s_.backward_limit_hz = -1;
  if (!settings_.vector.on || !settings_.vector.torque_control) return set_hz;
  const double forward_limit = store_.value(pr::kForwardSpeedLimit);
  switch (store_.integer(pr::kSpeedLimitSelection)) {
    case 1: {
      const double reverse_limit = mitsubishi::or_else(store_, pr::kReverseSpeedLimit, forward_limit);
      s_.backward_limit_hz = reverse ? forward_limit : reverse_limit;
      return reverse ? reverse_limit : forward_limit;
    }
    case 2: {
      if (store_.integer(pr::kTerminal1Function) != kSpeedLimit) return 0;
      const AnalogLine line{store_.value(pr::kTerminal1Bias, 2), store_.value(pr::kTerminal1Bias, 1),
                            store_.value(pr::kTerminal1Gain, 2), store_.value(pr::kTerminal1Gain, 1)};
      const double hz = line.frequency(std::abs(s_.percent_1));
      const bool limits_reverse = s_.percent_1 < 0;
      const double other = settings_.max_frequency_hz;
      s_.backward_limit_hz = limits_reverse == reverse ? other : hz;
      return limits_reverse == reverse ? hz : other;
    }
    default: return set_hz;
  }
}

// What the analog inputs make of limits; settings_ is this tick's.
void A700Inverter::follow_torque(drive::DriveCommand& command, const mitsubishi::Inputs& inputs) {
  drive::DriveSettings& s = settings_;
  const int function_1 = store_.is_9999(pr::kTerminal1Function) ? -1 : store_.integer(pr::kTerminal1Function);
  const bool by_4 = store_.integer(pr::kTerminal4Function) == kTorque && function_1 != kTorque;
  if (!s.vector.on) {
    // V/f and flux vector control: the level of stall prevention, Pr.148 at 0 and Pr.149 at full input.
    if (function_1 != kTorque && !by_4) return;
    const double share = std::clamp((by_4 ? s_.percent_4 : std::abs(s_.percent_1)) / 100, 0.0, 1.0);
    const double zero = store_.value(pr::kStallAt0V);
    s.stall_level_percent = zero + (store_.value(pr::kStallAt10V) - zero) * share;
    return;
  }
  command.pre_excite = inputs.signals.has(InputSignal::kLx);
  command.torque_percent = torque_command_percent();
  command.backward_limit_hz = s_.backward_limit_hz;
  set_torque_limits(s.vector, store_, inputs.signals.has(InputSignal::kTl));
  // X44 leaves the speed controller its proportional part.
  s.vector.integral_s = inputs.signals.has(InputSignal::kX44) ? 0 : speed_integral_s(store_, s_.second_motor);
  if (store_.integer(pr::kTorqueLimitInput) != 1) return;
  auto& limit = s.vector.limit_percent;
  if (function_1 == kTorque || by_4) {
    const double percent =
        by_4 ? torque_line(store_, pr::kTerminal4TorqueBias, pr::kTerminal4TorqueGain, s_.percent_4)
             : torque_line(store_, pr::kTerminal1TorqueBias, pr::kTerminal1TorqueGain, std::abs(s_.percent_1));
    limit.fill(percent);
  }
  if (function_1 == kRegenerativeLimit) {
    limit[drive::kForwardBraking] = limit[drive::kReverseBraking] =
        torque_line(store_, pr::kTerminal1TorqueBias, pr::kTerminal1TorqueGain, std::abs(s_.percent_1));
  }
}

std::optional<std::string> A700Inverter::not_fitted(unsigned number, std::int32_t raw) const {
  if (!needs_encoder(number, raw)) return std::nullopt;
  return "Pr." + std::to_string(number) + " = " + std::to_string(raw) +
         " needs an encoder and the option FR-A7AP, which is not fitted";
}

A700Inverter::TuningNumbers A700Inverter::tuning_numbers() const {
  const MotorNumbers& n = motor_numbers(s_.second_motor);
  return {n.tuning, n.capacity, n.r1};
}

}  // namespace vinv::inverter::a700
