// Output voltage over output frequency: base frequency and voltage, torque boost, load pattern (E500 Pr.0, 3, 14, 19),
// or an adjustable law of up to five points (A700 Pr.71 = 2, Pr.100-109).
#pragma once

#include "motor_model/drive/drive_types.hpp"

namespace vinv::drive {

// Line-to-line rms voltage. frequency_hz >= 0; rotation is the direction of the output, for the hoist patterns.
// current_a_rms serves the stator resistance compensation; where that is on, the boost is a lower bound, not an
// addition.
double vf_voltage_v_rms(const DriveSettings& settings, double frequency_hz, RunDirection rotation,
                        double current_a_rms);

// Phase peak from line-to-line rms.
double phase_peak_v(double line_v_rms);

}  // namespace vinv::drive
