#include "sim/rig/catalogue.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

// Impedances in inverse proportion to the power, inertia and current in proportion: the same per-unit machine.
plant::MachineParameters scaled(plant::MachineParameters m, double power_w) {
  const double k = power_w / m.rated_power_w;
  m.R_s_ohm /= k;
  m.R_r_ohm /= k;
  m.L_ls_h /= k;
  m.L_lr_h /= k;
  m.L_m_h /= k;
  m.inertia_kg_m2 *= k;
  m.rated_current_a_rms *= k;
  m.rated_power_w = power_w;
  char name[96];
  std::snprintf(name, sizeof name, "%s scaled to %g kW", m.name.c_str(), power_w / 1000);
  m.name = name;
  return m;
}

struct NodeParameter {
  std::string_view board_type;
  std::string_view parameter;
  unsigned last_node;  // values from 1 on are nodes, all others let the switches count
};

// OI-FR-E5NCO manual, 5.1 and 8.4: Pr.345 holds the node; its value 100 makes the switches count.
constexpr NodeParameter kNodeParameters[] = {{"oi-fr-e5nco", "Pr.345", 99}};

struct BitrateValue {
  std::string_view board_type;
  std::string_view parameter;
  std::uint32_t bitrate;
  unsigned value;
};

// OI-FR-E5NCO manual, 5.1: the low nibble of Pr.346; the high one is that of the factory value, 84H.
constexpr BitrateValue kBitrateValues[] = {
    {"oi-fr-e5nco", "Pr.346", 1'000'000, 0x81}, {"oi-fr-e5nco", "Pr.346", 500'000, 0x82},
    {"oi-fr-e5nco", "Pr.346", 250'000, 0x83},   {"oi-fr-e5nco", "Pr.346", 125'000, 0x84},
    {"oi-fr-e5nco", "Pr.346", 100'000, 0x85},   {"oi-fr-e5nco", "Pr.346", 62'500, 0x86},
    {"oi-fr-e5nco", "Pr.346", 50'000, 0x87},    {"oi-fr-e5nco", "Pr.346", 20'000, 0x88}};

struct CurrentInput {
  std::string_view family;
  std::string_view terminal;
};

// Analog inputs that take 4-20 mA; all others take a voltage.
constexpr CurrentInput kCurrentInputs[] = {{"fr-e500", "4"}, {"fr-a700", "4"}};

}  // namespace

bool rating_of_model(std::string_view model, double& power_w, double& voltage_v_rms) {
  // <series><2|4>0-<kW>K...: the digit before the 0 is the voltage class in hundreds of volts.
  const std::size_t dash = model.rfind('-');
  if (dash == std::string_view::npos || dash < 2 || model[dash - 1] != '0') return false;
  const std::size_t kilo = model.find('K', dash);
  if (kilo == std::string_view::npos) return false;
  double kilowatt = 0;
  if (!parse_number(model.substr(dash + 1, kilo - dash - 1), kilowatt) || kilowatt <= 0) return false;
  if (model[dash - 2] != '2' && model[dash - 2] != '4') return false;
  power_w = kilowatt * 1000;
  voltage_v_rms = model[dash - 2] == '2' ? 200 : 400;
  return true;
}

plant::MachineParameters default_motor(std::string_view model) {
  double power_w = 0;
  double voltage_v_rms = 0;
  if (!rating_of_model(model, power_w, voltage_v_rms)) return {};
  const plant::MachineParameters* smallest = nullptr;
  const plant::MachineParameters* best = nullptr;
  for (const std::string_view name : plant::machine_names()) {
    const plant::MachineParameters* m = plant::find_machine(name);
    if (!name.starts_with("iec4p_") || m->rated_voltage_v_rms != voltage_v_rms) continue;
    if (smallest == nullptr || m->rated_power_w < smallest->rated_power_w) smallest = m;
    if (m->rated_power_w <= power_w * 1.001 && (best == nullptr || m->rated_power_w > best->rated_power_w)) best = m;
  }
  if (best != nullptr) return *best;
  return smallest == nullptr ? plant::MachineParameters{} : scaled(*smallest, power_w);
}

plant::LoadSettings default_load(const plant::MachineParameters& motor) {
  const double rated_speed_rad_s = motor.rated_speed_rpm * std::numbers::pi / 30;
  plant::LoadSettings load;
  load.inertia_kg_m2 = 2 * motor.inertia_kg_m2;
  if (rated_speed_rad_s > 0)
    load.quadratic_nm_s2 = 0.5 * motor.rated_power_w / rated_speed_rad_s / (rated_speed_rad_s * rated_speed_rad_s);
  return load;
}

std::string_view node_parameter(std::string_view board_type) {
  for (const NodeParameter& row : kNodeParameters)
    if (row.board_type == board_type) return row.parameter;
  return {};
}

unsigned node_of_parameter(std::string_view board_type, double value) {
  for (const NodeParameter& row : kNodeParameters)
    if (row.board_type == board_type && value >= 1 && value <= row.last_node) return static_cast<unsigned>(value);
  return 0;
}

std::optional<StartupValue> can_bitrate_value(std::string_view board_type, std::uint32_t bitrate) {
  for (const BitrateValue& row : kBitrateValues)
    if (row.board_type == board_type && row.bitrate == bitrate)
      return StartupValue{row.parameter, static_cast<double>(row.value)};
  return {};
}

std::string_view analog_unit(std::string_view family, std::string_view terminal) {
  for (const CurrentInput& row : kCurrentInputs)
    if (row.family == family && row.terminal == terminal) return "mA";
  return "V";
}

}  // namespace vinv::rig
