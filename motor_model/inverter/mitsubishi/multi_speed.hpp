// The 15 speeds of RH, RM, RL and REX: Pr.4-6, 24-27, 232-239. Typical for the family.
#pragma once

#include <optional>

#include "motor_model/inverter/parameter_store.hpp"
#include "motor_model/inverter/signal_map.hpp"

namespace vinv::inverter::mitsubishi {

// Empty: no speed is selected. A combination left at 9999 gives the lowest of its signals.
std::optional<double> multi_speed_hz(const ParameterStore& parameters, InputSignals signals);

}  // namespace vinv::inverter::mitsubishi
