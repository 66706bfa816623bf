// Which parameter sets what in the control core, as far as the Mitsubishi families have the same parameters.
#pragma once

#include <vector>

#include "motor_model/drive/drive_core.hpp"
#include "motor_model/inverter/parameter_store.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter::mitsubishi {

struct SettingsSelection {
  bool second = false;  // signal RT
  bool third = false;   // signal X9, where the family has it
  bool jog = false;
  bool vf_by_x18 = false;     // signal X18: V/f control instead of vector control
  std::uint32_t variant = 0;  // what else the family distinguishes
  friend bool operator==(const SettingsSelection&, const SettingsSelection&) = default;
  VINV_ARCHIVE(SettingsSelection, second, third, jog, vf_by_x18, variant);
};

struct SettingsSurroundings {
  const ModelRow* model = nullptr;
  const std::vector<ModelRow>* models = nullptr;  // for the standard motor of Pr.80
  double mains_v_rms = 400;                       // nominal supply
  bool brake_resistor = false;
};

// The value, or the fallback where the parameter is set to 9999.
double or_else(const ParameterStore& parameters, unsigned number, double fallback);

// The standard motor of a capacity: of the model with the same voltage and the nearest capacity.
const ModelRow& standard_motor(const SettingsSurroundings& surroundings, double capacity_kw);

// Everything whose parameters are the same in each family; pattern, vector control, second functions beyond ramp and
// V/f, chopper and earth fault are the family's.
drive::DriveSettings common_settings(const ParameterStore& parameters, const SettingsSelection& selection,
                                     const SettingsSurroundings& surroundings);

// Motor data that vector control and slip compensation need; a base voltage and frequency of Pr.83 and 84.
void set_vector_control(drive::DriveSettings& settings, const ParameterStore& parameters, const ModelRow& standard);

// Pr.1, or Pr.18 above 120 Hz.
double maximum_frequency_hz(const ParameterStore& parameters);

}  // namespace vinv::inverter::mitsubishi
