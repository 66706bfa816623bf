// Construction of a Mitsubishi inverter, its terminals, supply, injected faults and live signals.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

plant::PlantConfig plant_config(const InverterConfig& c, const ModelRow& m, double nominal_mains_v_rms) {
  plant::PlantConfig p;
  p.machine = c.motor;
  p.load = c.load;
  p.losses = c.losses ? *c.losses : plant::typical_losses(c.motor);
  p.dc_link.capacitance_f = m.dc_link_capacitance_f;
  p.dc_link.source_resistance_ohm = c.source_resistance_ohm.value_or(m.source_resistance_ohm);
  p.dc_link.precharge_resistance_ohm = m.precharge_ohm;
  p.dc_link.brake_resistance_ohm = c.brake_resistance_ohm;
  // What the drive rides through must not flow through the pre-charge resistor.
  p.dc_link.bypass_opens_fraction = m.under_voltage_v / (std::numbers::sqrt2 * nominal_mains_v_rms);
  p.thermal.heat_sink_k_per_w = m.heat_sink_k_per_w;
  p.thermal.heat_sink_time_constant_s = m.heat_sink_time_constant_s;
  p.comparators.over_current_a_peak = m.rated_current_a_rms * std::numbers::sqrt2 * m.over_current_percent / 100;
  p.comparators.over_voltage_v = m.over_voltage_v;
  p.comparators.under_voltage_v = m.under_voltage_v;
  p.comparators.under_voltage_clear_v = m.under_voltage_clear_v;
  p.nominal_mains_v_rms = nominal_mains_v_rms;
  p.mains_frequency_hz = c.mains_frequency_hz;
  p.mains_phase_rad = c.mains_phase_rad;
  p.voltage_table = c.voltage_table;
  p.ambient_c = c.ambient_c;
  p.mains.voltage_v_rms = 0;  // the breaker is open until set_power
  return p;
}

double nominal_mains(const InverterConfig& c, const ModelRow& m) {
  return c.mains && c.mains->voltage_v_rms > 0 ? c.mains->voltage_v_rms : m.voltage_class_v;
}

// What a contactor to the motor gets: nothing unless all phases are there.
double line_v(const plant::MainsState& mains) {
  const auto& phases = mains.phase_present;
  return std::all_of(phases.begin(), phases.end(), [](bool there) { return there; }) ? mains.voltage_v_rms : 0;
}

}  // namespace

MitsubishiInverter::MitsubishiInverter(const Personality& personality, const InverterConfig& config,
                                       const ModelRow& model, ParameterStore store)
    : personality_(personality),
      data_(*personality.data),
      model_(model),
      option_fitted_(config.option_fitted),
      nominal_mains_v_rms_(nominal_mains(config, model)),
      brake_resistor_(config.brake_resistance_ohm > 0),
      snapshot_grid_(config.snapshot_grid),
      mains_(config.mains.value_or(plant::MainsState{.voltage_v_rms = model.voltage_class_v})),
      store_(std::move(store)),
      plant_(plant_config(config, model, nominal_mains_v_rms_), config.solver) {
  plant_.set_line(line_v(mains_));
}

// --- terminals ---

Outcome MitsubishiInverter::set_terminal(std::string_view terminal, bool on) {
  std::string known;
  for (const InputTerminal& input : personality_.inputs) {
    if (input.name == terminal) {
      wiring_.closed.set(input.bit, on);
      return {};
    }
    known += (known.empty() ? "" : ", ") + std::string(input.name);
  }
  std::string text = "there is no input terminal " + std::string(terminal) + "; there are " + known;
  const bool function = std::any_of(data_.signals.inputs().begin(), data_.signals.inputs().end(),
                                    [&](const TerminalFunction& f) { return f.signal == terminal; });
  if (function)
    text += "; " + std::string(terminal) + " is a function that " + std::string(personality_.input_functions);
  return Unexpected(text);
}

Outcome MitsubishiInverter::set_analog(std::string_view terminal, double value) {
  std::string known;
  for (const AnalogTerminal& input : personality_.analogs) {
    known += (known.empty() ? "" : " and ") + std::string(input.name) + " (" + std::string(input.unit) + ")";
    if (input.name != terminal) continue;
    if (!(value >= input.minimum && value <= input.maximum)) {
      return Unexpected("terminal " + std::string(terminal) + " takes " +
                        std::to_string(static_cast<int>(input.minimum)) + " to " +
                        std::to_string(static_cast<int>(input.maximum)) + " " + std::string(input.unit));
    }
    wiring_.analog[static_cast<std::size_t>(input.input)] = value;
    return {};
  }
  return Unexpected("there is no analog input " + std::string(terminal) + "; there are " + known);
}

std::vector<std::pair<std::string_view, bool>> MitsubishiInverter::terminals() const {
  std::vector<std::pair<std::string_view, bool>> out;
  out.reserve(personality_.inputs.size() + personality_.outputs.size());
  for (const InputTerminal& input : personality_.inputs) out.emplace_back(input.name, wiring_.closed.has(input.bit));
  for (std::size_t i = 0; i < personality_.outputs.size(); ++i) {
    const OutputTerminal& output = personality_.outputs[i];
    const auto function = data_.signals.output(store_.integer(output.function));
    out.emplace_back(output.name, control_alive_ && function && output_on(i, function->signal) != function->inverted);
  }
  return out;
}

std::vector<std::string_view> MitsubishiInverter::analog_terminals() const {
  std::vector<std::string_view> out;
  for (const AnalogTerminal& input : personality_.analogs) out.push_back(input.name);
  return out;
}

// --- supply ---

namespace {

// With fewer than two phases nothing is rectified.
double rectified_v(const plant::MainsState& mains) {
  const auto phases = std::count(mains.phase_present.begin(), mains.phase_present.end(), true);
  return phases >= 2 ? mains.voltage_v_rms * std::numbers::sqrt2 : 0;
}

}  // namespace

void MitsubishiInverter::set_power(bool on) {
  breaker_ = on;
  plant::MainsState mains = mains_;
  if (!on) mains.voltage_v_rms = 0;
  plant_.set_mains(mains);
}

void MitsubishiInverter::set_mains(const plant::MainsState& mains) {
  mains_ = mains;
  plant_.set_line(line_v(mains));
  set_power(breaker_);
}

Outcome MitsubishiInverter::set_motor_source(plant::MotorSource source) {
  if (source == plant::MotorSource::kTable && plant_.config().voltage_table.empty()) {
    return Unexpected(std::string("the plant file has no voltage_table for this drive"));
  }
  plant_.set_motor_source(source);
  return {};
}

bool MitsubishiInverter::powered() const {
  return control_alive_ || (breaker_ && rectified_v(mains_) > model_.control_on_v);
}

// --- faults ---

Outcome MitsubishiInverter::inject_fault(std::string_view fault, bool on) {
  for (const auto& [name, cause] : personality_.causes) {
    if (name != fault) continue;
    if (name == "external_thermal" && on && !has_function(InputSignal::kOh)) {
      return Unexpected(std::string("no terminal has the function OH: give it to one with the setting 7"));
    }
    if (name == "option" && on && !option_fitted_) return Unexpected(std::string("no option board is fitted"));
    causes_.*cause = on;
    return {};
  }
  const auto row = data_.alarms.by_name(fault);
  if (!row) {
    std::string known;
    for (std::string_view name : injectable_faults()) known += (known.empty() ? "" : ", ") + std::string(name);
    return Unexpected("there is no fault " + std::string(fault) + "; there are " + known);
  }
  // An alarm is an event: it is there until it is reset, and taking it away is the reset's business.
  if (!on) return {};
  if (!control_alive_) return Unexpected(std::string("the inverter has no supply"));
  if (v_.alarm.row) return Unexpected("there is an alarm already, " + alarm_name());
  raise(*row, data_.alarms.rows()[*row].cause + " (injected)");
  return {};
}

std::vector<std::string_view> MitsubishiInverter::injectable_faults() const {
  std::vector<std::string_view> out;
  for (const auto& cause : personality_.causes) out.push_back(cause.name);
  for (const AlarmRow& row : data_.alarms.rows()) out.push_back(row.name);
  return out;
}

std::string MitsubishiInverter::alarm_name() const {
  return v_.alarm.row ? data_.alarms.rows()[*v_.alarm.row].name : "";
}

SettingsSurroundings MitsubishiInverter::surroundings() const {
  return {&model_, &data_.models, nominal_mains_v_rms_, brake_resistor_};
}

// --- live values ---

std::vector<SignalValue> MitsubishiInverter::signals() const {
  const plant::PlantMeasurements& m = plant_.measurements();
  const drive::DriveOutputs& out = core_.outputs();
  const Published& p = v_.published;
  const auto hours = static_cast<double>(record_.operating_seconds) + v_.operating_s;
  return {
      {"set_frequency", p.set_frequency_hz, "Hz"},
      {"output_frequency", control_alive_ ? out.output_frequency_hz : 0, "Hz"},
      {"output_current", m.output_current_a_rms, "A"},
      {"output_voltage", m.gates_on ? m.output_voltage_v_rms : 0, "V"},
      {"dc_link", m.dc_link_v, "V"},
      {"speed", m.speed_rpm, "rpm"},
      {"torque", m.torque_nm, "Nm"},
      {"load_torque", m.load_torque_nm, "Nm"},
      {"shaft_power", m.shaft_power_w, "W"},
      {"input_power", m.input_power_w, "W"},
      {"output_power", m.output_power_w, "W"},
      {"brake_power", m.brake_power_w, "W"},
      {"motor_thermal", out.motor_thermal_fraction * 100, "%"},
      {"inverter_thermal", out.inverter_thermal_fraction * 100, "%"},
      {"brake_duty", out.brake_duty_fraction * 100, "%"},
      {"heat_sink", m.heat_sink_c, "degC"},
      {"winding", m.winding_c, "degC"},
      {"run_state", static_cast<double>(out.state), "-"},
      {"alarm_code", static_cast<double>(active_alarm()), "-"},
      {"am", p.am_v, "V"},
      {"fan", p.fan ? 1.0 : 0.0, "-"},
      {"carrier", settings_.carrier_hz, "Hz"},
      {"operating_hours", hours / 3600, "h"},
      {"motor_current", m.motor_current_a_rms, "A"},
      {"motor_voltage", m.motor_voltage_v_rms, "V"},
  };
}

// --- factory ---

Result<Prepared, std::string> prepare(const Personality& personality, const InverterConfig& config) {
  const FamilyData& data = *personality.data;
  const ModelRow* model = find_model(data.models, config.model);
  if (model == nullptr) {
    std::string known;
    for (const ModelRow& m : data.models) known += (known.empty() ? "" : ", ") + m.model;
    return Unexpected("family " + std::string(personality.family) + " has no model " + config.model + "; there are " +
                      known);
  }
  if (const auto ok = plant::validate(config.motor); !ok) return Unexpected("motor: " + ok.error());
  if (const auto ok = plant::validate(config.load); !ok) return Unexpected("load: " + ok.error());
  if (!(config.brake_resistance_ohm >= 0)) return Unexpected(std::string("brake resistor: must not be negative"));
  if (config.source_resistance_ohm && !(*config.source_resistance_ohm > 0)) {
    return Unexpected(std::string("source resistance: must be above 0 ohm"));
  }
  if (config.mains &&
      !(config.mains->voltage_v_rms >= 0 && config.mains->voltage_v_rms <= 1.5 * model->voltage_class_v)) {
    return Unexpected("mains: a " + model->model + " takes 0 to " +
                      std::to_string(static_cast<int>(1.5 * model->voltage_class_v)) + " V");
  }
  if (!(config.mains_frequency_hz >= 40 && config.mains_frequency_hz <= 70)) {
    return Unexpected(std::string("mains frequency: must be 40 to 70 Hz"));
  }
  if (config.snapshot_grid < Duration{} || config.snapshot_grid % Inverter::kControlPeriod != Duration{}) {
    return Unexpected(std::string("snapshot grid: must be a multiple of 1 ms, or 0"));
  }
  ParameterStore store(data.parameters, *model);
  for (const auto& [name, value] : config.factory_values) {
    const auto row = data.parameters.index(name);
    if (!row) return Unexpected("factory value: there is no parameter " + name);
    const auto raw = store.from_physical(*row, value);
    if (!raw) return Unexpected("factory value: " + raw.error());
    store.set_factory(*row, *raw);
  }
  return Prepared{model, std::move(store)};
}

}  // namespace vinv::inverter::mitsubishi
