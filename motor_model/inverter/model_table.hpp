// The models of a family (families/*/models.csv): ratings, and the power circuit chosen for each size.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"

namespace vinv::inverter {

struct ModelRow {
  std::string model;
  double voltage_class_v = 400;
  double motor_kw = 0;
  double rated_current_a_rms = 0;
  double dc_link_capacitance_f = 0;
  double source_resistance_ohm = 0;
  double precharge_ohm = 0;
  double over_current_percent = 200;
  double over_voltage_v = 0;
  double under_voltage_v = 0;
  double under_voltage_clear_v = 0;
  double control_off_v = 0;  // DC link below which the control supply dies, and above which it comes back
  double control_on_v = 0;
  double chopper_on_v = 0;
  double chopper_off_v = 0;
  double chopper_duty_percent = 0;  // permitted without a setting of its own
  double heat_sink_k_per_w = 0;
  double heat_sink_time_constant_s = 0;
  double heat_sink_trip_c = 0;
  double restart_coast_s = 0;  // wait after a power failure when left to the drive
  // the standard motor of this capacity, where parameters are left at 9999
  double standard_motor_r1_ohm = 0;
  double standard_motor_slip_percent = 0;
  double standard_motor_no_load_a_rms = 0;
  double standard_motor_rated_a_rms = 0;
  std::string source;
  std::string confidence;
};

// Checked: positive values, comparator levels in order, names unique. Error: line, column and reason.
Result<std::vector<ModelRow>, std::string> load_models(std::string_view csv);
const ModelRow* find_model(const std::vector<ModelRow>& models, std::string_view name);

}  // namespace vinv::inverter
