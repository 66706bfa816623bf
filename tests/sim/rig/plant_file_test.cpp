#include "sim/rig/plant_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/sim/rig/fakes.hpp"

namespace vinv::rig {
namespace {

PlantFile parse(const std::string& text) {
  test::Journal journal;
  return parse_plant_file(text, "some/where/hall_7.yaml", test::fake_catalogue(journal));
}

TEST(PlantFile, OneEmptyDriveIsAPlant) {
  const PlantFile f = parse("drives: [{}]\n");
  EXPECT_EQ(f.name, "hall_7");
  ASSERT_EQ(f.drives.size(), 1u);
  const DriveSpec& d = f.drives[0];
  EXPECT_EQ(d.name, "drive_1");
  EXPECT_EQ(d.family, "fr-e500");
  EXPECT_EQ(d.model.value, "FR-E540-1.5K");
  EXPECT_EQ(d.motor.value.name, "iec4p_1k5kW_400V");
  EXPECT_DOUBLE_EQ(d.load.value.inertia_kg_m2, 2 * d.motor.value.inertia_kg_m2);
  EXPECT_GT(d.load.value.quadratic_nm_s2, 0);
  EXPECT_TRUE(d.power);
  ASSERT_TRUE(d.board.has_value());
  EXPECT_EQ(d.board->type.value, "oi-fr-e5nco");
  EXPECT_EQ(d.board->node.value, 1u);
  ASSERT_EQ(f.serial.size(), 1u);
  EXPECT_EQ(f.serial[0].device, "pty");
  ASSERT_EQ(f.tcp.size(), 1u);
  EXPECT_EQ(f.tcp[0].host, "127.0.0.1");
  EXPECT_EQ(f.tcp[0].port, 1502);
}

TEST(PlantFile, MotorsFollowTheModelAndSmallOnesAreScaled) {
  const PlantFile f = parse("drives:\n  - inverter: { model: FR-E540-2.2K }\n  - inverter: { model: FR-E520-0.2K }\n");
  EXPECT_EQ(f.drives[0].motor.value.name, "iec4p_2k2kW_400V");
  const auto& small = f.drives[1].motor.value;
  const auto& base = *plant::find_machine("iec4p_0k4kW_200V");
  EXPECT_DOUBLE_EQ(small.rated_power_w, 200);
  EXPECT_DOUBLE_EQ(small.R_s_ohm, 2 * base.R_s_ohm);
  EXPECT_DOUBLE_EQ(small.rated_current_a_rms, base.rated_current_a_rms / 2);
  EXPECT_TRUE(plant::validate(small));
}

TEST(PlantFile, NodesWithoutANumberTakeTheLowestFreeOnes) {
  const PlantFile f = parse("drives: [{}, {board: {node: 1}}, {}, {board: {node: 2}}]\n");
  EXPECT_EQ(f.drives[0].board->node.value, 3u);
  EXPECT_EQ(f.drives[2].board->node.value, 4u);
}

TEST(PlantFile, AddressesAreSharedByThoseWhoNameThemAndPortZeroIsNot) {
  const PlantFile f = parse(
      "networks: { plc: { modbus_tcp: 127.0.0.1:0 }, bus: { serial: /dev/ttyUSB0 } }\n"
      "drives:\n"
      "  - board: { modbus_tcp: plc, modbus_rtu: bus }\n"
      "  - board: { modbus_tcp: plc, modbus_rtu: /dev/ttyUSB0 }\n"
      "  - board: { modbus_tcp: 127.0.0.1:0, modbus_rtu: none }\n"
      "  - board: { modbus_tcp: 127.0.0.1:0 }\n"
      "  - board: { modbus_tcp: '[::1]:1502' }\n"
      "  - board: { modbus_tcp: localhost:1502 }\n"
      "  - {}\n");
  EXPECT_EQ(f.drives[0].board->tcp, f.drives[1].board->tcp);
  EXPECT_EQ(f.drives[0].board->serial, f.drives[1].board->serial);
  EXPECT_FALSE(f.drives[2].board->serial.has_value());
  EXPECT_NE(f.drives[2].board->tcp, f.drives[3].board->tcp);
  EXPECT_EQ(f.tcp[*f.drives[4].board->tcp].host, "::1");
  EXPECT_EQ(f.drives[5].board->tcp, f.drives[6].board->tcp);
}

TEST(PlantFile, TorqueTermsAreGivenAtRatedSpeed) {
  const PlantFile f = parse(
      "drives:\n"
      "  - motor: { preset: iec4p_1k5kW_400V }\n"
      "    load:\n"
      "      inertia_kg_m2: 0.5\n"
      "      torque: { constant_Nm: 1, linear_Nm_at_rated: 2, quadratic_Nm_at_rated: 9, hoist_Nm: -3,\n"
      "                table: [ {time_s: 0, torque_Nm: 0}, {time_s: 2.5, torque_Nm: 4} ] }\n"
      "      friction: { coulomb_Nm: 0.25 }\n");
  const auto& load = f.drives[0].load.value;
  const double rated = 1445 * std::numbers::pi / 30;
  EXPECT_DOUBLE_EQ(load.inertia_kg_m2, 0.5);
  EXPECT_DOUBLE_EQ(load.constant_nm, 1);
  EXPECT_NEAR(load.linear_nm_s * rated, 2, 1e-12);
  EXPECT_NEAR(load.quadratic_nm_s2 * rated * rated, 9, 1e-12);
  EXPECT_DOUBLE_EQ(load.hoist_nm, -3);
  ASSERT_EQ(load.table.size(), 2u);
  EXPECT_DOUBLE_EQ(load.table[1].torque_nm, 4);
  EXPECT_EQ(f.drives[0].friction.coulomb_nm, 0.25);
  EXPECT_FALSE(f.drives[0].friction.viscous_nm_s.has_value());
}

TEST(PlantFile, APresetsValuesCanBeChangedOneByOne) {
  const PlantFile f = parse("drives:\n  - motor: { preset: iec4p_1k5kW_400V, R_r_ohm: 4.0 }\n");
  EXPECT_DOUBLE_EQ(f.drives[0].motor.value.R_r_ohm, 4.0);
  EXPECT_DOUBLE_EQ(f.drives[0].motor.value.R_s_ohm, plant::find_machine("iec4p_1k5kW_400V")->R_s_ohm);
}

TEST(PlantFile, AMotorCanBeGivenByItsEquivalentCircuit) {
  const PlantFile f = parse(
      "drives:\n"
      "  - motor: { R_s_ohm: 3.7, R_r_ohm: 2.297, L_ls_H: 0.0107, L_lr_H: 0.0107, L_m_H: 0.234, inertia_kg_m2: 0.015,\n"
      "             rated_power_W: 2200, rated_voltage_V: 400, rated_current_A: 5.0, rated_speed_rpm: 1439 }\n");
  EXPECT_DOUBLE_EQ(f.drives[0].motor.value.L_m_h, 0.234);
  EXPECT_EQ(f.drives[0].motor.value.pole_pairs, 2);
}

TEST(PlantFile, ADriveCanGoWithoutABoard) {
  const PlantFile f = parse("drives:\n  - board: none\n    power: off\n");
  EXPECT_FALSE(f.drives[0].board.has_value());
  EXPECT_FALSE(f.drives[0].power);
}

TEST(PlantFile, InputsAndParametersKeepTheirPlaces) {
  const PlantFile f = parse(
      "drives:\n  - terminals: { STF: on, RH: off }\n    analog: { terminal_2: 5, 4: 12.5 }\n    parameters: { Pr.7: "
      "2.5 }\n");
  const DriveSpec& d = f.drives[0];
  ASSERT_EQ(d.terminals.size(), 2u);
  EXPECT_EQ(d.terminals[0].first.value, "STF");
  EXPECT_TRUE(d.terminals[0].second);
  ASSERT_EQ(d.analog.size(), 2u);
  EXPECT_EQ(d.analog[0].first.value, "2");
  EXPECT_DOUBLE_EQ(d.analog[1].second, 12.5);
  ASSERT_EQ(d.parameters.size(), 1u);
  EXPECT_EQ(d.parameters[0].first.at.line, 4);
  EXPECT_DOUBLE_EQ(d.parameters[0].second.value, 2.5);
}

// The schema and the loader know the same keys.

void collect(const nlohmann::json& schema, const std::string& path,
             std::map<std::string, std::vector<std::string>>& out) {
  if (schema.contains("oneOf"))
    for (const auto& one : schema["oneOf"]) collect(one, path, out);
  if (schema.contains("properties")) {
    for (const auto& [key, sub] : schema["properties"].items()) {
      out[path].push_back(key);
      collect(sub, path.empty() ? key : path + "." + key, out);
    }
  } else if (schema.contains("additionalProperties") && schema["additionalProperties"].is_object()) {
    collect(schema["additionalProperties"], path + ".*", out);
  }
  if (schema.contains("items")) collect(schema["items"], path + "[]", out);
}

TEST(PlantSchema, KnowsTheKeysOfTheLoader) {
  std::ifstream in(VINV_SOURCE_DIR "/docs/plant.schema.json");
  ASSERT_TRUE(in.good());
  std::map<std::string, std::vector<std::string>> schema;
  collect(nlohmann::json::parse(in), "", schema);
  std::map<std::string, std::vector<std::string>> loader;
  for (const auto& [path, keys] : plant_file_keys()) loader[path].assign(keys.begin(), keys.end());
  for (auto* side : {&schema, &loader})
    for (auto& [path, keys] : *side) std::sort(keys.begin(), keys.end());
  EXPECT_EQ(schema, loader);
}

}  // namespace
}  // namespace vinv::rig
