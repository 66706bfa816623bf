// Which parameter sets what in the control core: FR-E500 parameters to drive::DriveSettings.
#pragma once

#include "motor_model/inverter/mitsubishi/settings.hpp"

namespace vinv::inverter::e500 {

drive::DriveSettings make_settings(const ParameterStore& parameters, const mitsubishi::SettingsSelection& selection,
                                   const mitsubishi::SettingsSurroundings& surroundings);

}  // namespace vinv::inverter::e500
