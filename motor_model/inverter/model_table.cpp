#include "motor_model/inverter/model_table.hpp"

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {

Result<std::vector<ModelRow>, std::string> load_models(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  std::vector<ModelRow> models;
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    const auto positive = [&in](std::string_view column) {
      const double v = in.number(column);
      if (!(v > 0)) in.fail(column, "must be above 0");
      return v;
    };
    ModelRow m;
    m.model = in.text("model");
    if (find_model(models, m.model) != nullptr) in.fail("model", m.model + " is there twice");
    m.voltage_class_v = positive("voltage_class_v");
    m.motor_kw = positive("motor_kw");
    m.rated_current_a_rms = positive("rated_output_current_a");
    m.dc_link_capacitance_f = positive("dc_link_capacitance_uf") * 1e-6;
    m.source_resistance_ohm = positive("source_resistance_ohm");
    m.precharge_ohm = positive("precharge_ohm");
    m.over_current_percent = positive("over_current_percent");
    m.over_voltage_v = positive("over_voltage_v");
    m.under_voltage_v = positive("under_voltage_v");
    m.under_voltage_clear_v = positive("under_voltage_clear_v");
    m.control_off_v = positive("control_off_v");
    m.control_on_v = positive("control_on_v");
    m.chopper_on_v = positive("chopper_on_v");
    m.chopper_off_v = positive("chopper_off_v");
    m.chopper_duty_percent = positive("chopper_duty_percent");
    m.heat_sink_k_per_w = positive("heat_sink_k_per_w");
    m.heat_sink_time_constant_s = positive("heat_sink_time_constant_s");
    m.heat_sink_trip_c = positive("heat_sink_trip_c");
    m.restart_coast_s = positive("restart_coast_s");
    m.standard_motor_r1_ohm = positive("standard_motor_r1_ohm");
    m.standard_motor_slip_percent = positive("standard_motor_slip_percent");
    m.standard_motor_no_load_a_rms = positive("standard_motor_no_load_a");
    m.standard_motor_rated_a_rms = positive("standard_motor_rated_a");
    m.source = in.text("source");
    m.confidence = in.text("confidence");
    if (!(m.control_off_v < m.control_on_v && m.control_on_v < m.under_voltage_v &&
          m.under_voltage_v < m.under_voltage_clear_v && m.under_voltage_clear_v < m.chopper_off_v &&
          m.chopper_off_v < m.chopper_on_v && m.chopper_on_v < m.over_voltage_v)) {
      in.fail("over_voltage_v",
              "the levels must rise: control off, control on, under-voltage, its clear level, chopper off, chopper on, "
              "over-voltage");
    }
    models.push_back(std::move(m));
  }
  if (in.error()) return Unexpected(*in.error());
  return models;
}

const ModelRow* find_model(const std::vector<ModelRow>& models, std::string_view name) {
  for (const ModelRow& m : models) {
    if (m.model == name) return &m;
  }
  return nullptr;
}

}  // namespace vinv::inverter
