// The shipped machines, from the table compiled into the library.
#include <charconv>

#include "motor_model/plant/power_plant.hpp"
#include "sim/base/check.hpp"
#include "vinv_plant_data.hpp"

namespace vinv::plant {

namespace {

// The next cell of a CSV line; quotes only in the free-text columns at its end.
std::string_view next_cell(std::string_view& line) {
  const auto comma = line.find(',');
  const auto cell = line.substr(0, comma);
  line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  return cell;
}

double number(std::string_view cell) {
  double value = 0;
  const auto end = cell.data() + cell.size();
  VINV_CHECK(std::from_chars(cell.data(), end, value).ptr == end);
  return value;
}

MachineParameters parse_row(std::string_view line) {
  MachineParameters m;
  m.name = next_cell(line);
  next_cell(line);  // kind
  m.rated_power_w = number(next_cell(line));
  m.rated_voltage_v_rms = number(next_cell(line));
  m.rated_frequency_hz = number(next_cell(line));
  m.pole_pairs = static_cast<int>(number(next_cell(line))) / 2;
  m.R_s_ohm = number(next_cell(line));
  m.R_r_ohm = number(next_cell(line));
  m.L_ls_h = number(next_cell(line));
  m.L_lr_h = number(next_cell(line));
  m.L_m_h = number(next_cell(line));
  m.inertia_kg_m2 = number(next_cell(line));
  m.rated_current_a_rms = number(next_cell(line));
  m.rated_speed_rpm = number(next_cell(line));
  return m;
}

std::vector<MachineParameters> parse_table(std::string_view text) {
  std::vector<MachineParameters> out;
  bool header_seen = false;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const auto line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    if (header_seen) out.push_back(parse_row(line));
    header_seen = true;
  }
  return out;
}

const std::vector<MachineParameters>& machines() {
  static const std::vector<MachineParameters> table = parse_table(data::machines_csv);
  return table;
}

}  // namespace

const MachineParameters* find_machine(std::string_view name) {
  for (const auto& machine : machines()) {
    if (machine.name == name) return &machine;
  }
  return nullptr;
}

std::vector<std::string_view> machine_names() {
  std::vector<std::string_view> names;
  for (const auto& machine : machines()) names.push_back(machine.name);
  return names;
}

}  // namespace vinv::plant
