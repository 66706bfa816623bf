// The set frequency as the ramp gets it: jump bands, then minimum and maximum frequency (E500 Pr.31-36, 1, 2, 18).
#pragma once

#include "motor_model/drive/drive_types.hpp"

namespace vinv::drive {

// Magnitude in Hz. A reference strictly inside a band takes the band's jump frequency, whether it rises or falls; the
// ramp itself passes through the band. The maximum wins over the minimum.
double limited_reference_hz(const DriveSettings& settings, double set_frequency_hz);

}  // namespace vinv::drive
