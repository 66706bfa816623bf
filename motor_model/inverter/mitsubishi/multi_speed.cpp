#include "motor_model/inverter/mitsubishi/multi_speed.hpp"

#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

// Parameter by RL | RM << 1 | RH << 2 | REX << 3; 0 stands for none.
constexpr unsigned kSpeedOf[16] = {0,
                                   pr::kSpeedLow,
                                   pr::kSpeedMiddle,
                                   pr::kSpeed4,
                                   pr::kSpeedHigh,
                                   pr::kSpeed4 + 1,
                                   pr::kSpeed4 + 2,
                                   pr::kSpeed4 + 3,
                                   pr::kSpeed8,
                                   pr::kSpeed8 + 1,
                                   pr::kSpeed8 + 2,
                                   pr::kSpeed8 + 3,
                                   pr::kSpeed8 + 4,
                                   pr::kSpeed8 + 5,
                                   pr::kSpeed8 + 6,
                                   pr::kSpeed8 + 7};

}  // namespace

std::optional<double> multi_speed_hz(const ParameterStore& parameters, InputSignals signals) {
  const bool rl = signals.has(InputSignal::kRl);
  const bool rm = signals.has(InputSignal::kRm);
  const bool rh = signals.has(InputSignal::kRh);
  const bool rex = signals.has(InputSignal::kRex);
  const unsigned code = (rl ? 1u : 0u) | (rm ? 2u : 0u) | (rh ? 4u : 0u) | (rex ? 8u : 0u);
  if (code == 0) return std::nullopt;
  if (!parameters.is_9999(kSpeedOf[code])) return parameters.value(kSpeedOf[code]);
  if (rex && (code & 7u) != 0) {
    signals.set(InputSignal::kRex, false);
    return multi_speed_hz(parameters, signals);
  }
  if (rl) return parameters.value(pr::kSpeedLow);
  if (rm) return parameters.value(pr::kSpeedMiddle);
  if (rh) return parameters.value(pr::kSpeedHigh);
  return std::nullopt;
}

}  // namespace vinv::inverter::mitsubishi
