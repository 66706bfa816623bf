// What a plant can be built of. The product's own catalogue is the default; tests put in their own parts.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/make_board.hpp"

namespace vinv::rig {

struct Catalogue {
  std::function<Result<std::unique_ptr<inverter::Inverter>, std::string>(std::string_view family,
                                                                         const inverter::InverterConfig&)>
      make_inverter;
  std::function<std::vector<std::string_view>()> families;
  std::function<std::vector<std::string_view>(std::string_view family)> models;
  std::function<Result<std::unique_ptr<boards::OptionBoard>, std::string>(const boards::BoardConfig&, port::DrivePort&)>
      make_board;
  std::function<std::vector<std::string_view>()> board_types;
  std::function<std::vector<std::string_view>(std::string_view type)> board_families;
  std::function<boards::BoardTraits(std::string_view type)> board_traits;
};

// Inverters of motor_model/inverter, boards of option_boards/boards.
Catalogue shipped_catalogue();

// Motor and voltage of a model as its name says them: "FR-E540-1.5K" is 1.5 kW in the 400 V class. False if the name
// says neither.
bool rating_of_model(std::string_view model, double& power_w, double& voltage_v_rms);

// The shipped four-pole motor of the model's power and voltage; a smaller one than any shipped is scaled from the
// smallest. Empty name if the model's name says no rating.
plant::MachineParameters default_motor(std::string_view model);
// A driven machine of that motor: twice its inertia, a fan of half the rated torque.
plant::LoadSettings default_load(const plant::MachineParameters& motor);

// The parameter that overrides a board's address switches, which `node:` sets as well; empty if there is none.
std::string_view node_parameter(std::string_view board_type);
// The node that this parameter's value gives; 0 if the switches count.
unsigned node_of_parameter(std::string_view board_type, double value);

// A parameter's value that stands for a setting of the board.
struct StartupValue {
  std::string_view parameter;
  double value = 0;
};
// The parameter that sets the board's bit rate on a CAN bus; empty if there is none.
std::optional<StartupValue> can_bitrate_value(std::string_view board_type, std::uint32_t bitrate);

// Unit of an analog input: "V" or "mA".
std::string_view analog_unit(std::string_view family, std::string_view terminal);

}  // namespace vinv::rig
