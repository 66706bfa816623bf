// Which parameter sets what in the control core: FR-E500 parameters to drive::DriveSettings.
#pragma once

#include <vector>

#include "motor_model/drive/drive_core.hpp"
#include "motor_model/inverter/parameter_store.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter::e500 {

struct SettingsSelection {
  bool second = false;  // signal RT
  bool jog = false;
  bool vf_by_x18 = false;  // signal X18: V/f control instead of flux vector control
  friend bool operator==(const SettingsSelection&, const SettingsSelection&) = default;
  VINV_ARCHIVE(SettingsSelection, second, jog, vf_by_x18);
};

struct SettingsSurroundings {
  const ModelRow* model = nullptr;
  const std::vector<ModelRow>* models = nullptr;  // for the standard motor of Pr.80
  double mains_v_rms = 400;                       // nominal supply
  bool brake_resistor = false;
};

drive::DriveSettings make_settings(const ParameterStore& parameters, const SettingsSelection& selection,
                                   const SettingsSurroundings& surroundings);

// Pr.1, or Pr.18 above 120 Hz.
double maximum_frequency_hz(const ParameterStore& parameters);

}  // namespace vinv::inverter::e500
