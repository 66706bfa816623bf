// The tables of a family, parsed once, never changed.
#pragma once

#include <string_view>
#include <vector>

#include "motor_model/inverter/alarm_table.hpp"
#include "motor_model/inverter/model_table.hpp"
#include "motor_model/inverter/parameter_table.hpp"
#include "motor_model/inverter/signal_map.hpp"

namespace vinv::inverter {

struct FamilyTables {
  std::string_view parameters;
  std::string_view alarms;
  std::string_view terminals;
  std::string_view models;
  std::string_view ranges{};  // of the parameters of some models; empty: as in parameters
};

struct FamilyData {
  ParameterTable parameters;
  AlarmTable alarms;
  SignalMap signals;
  std::vector<ModelRow> models;
};

// The tables of the tree, whose loaders have been tested: a mistake in them ends the program.
FamilyData load_family(const FamilyTables& csv);

}  // namespace vinv::inverter
