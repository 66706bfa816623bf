// Who asks a Mitsubishi inverter for an operation mode.
#pragma once

#include <cstdint>

namespace vinv::inverter::mitsubishi {

enum class ModeRequest : std::uint8_t { kNetworkOn, kNetworkOff, kPanelByNetwork, kPanelKey };

}  // namespace vinv::inverter::mitsubishi
