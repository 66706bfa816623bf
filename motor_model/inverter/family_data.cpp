#include "motor_model/inverter/family_data.hpp"

#include <utility>

#include "sim/base/check.hpp"

namespace vinv::inverter {
namespace {

template <class T>
T checked(Result<T, std::string> loaded) {
  VINV_CHECK(loaded.has_value());
  return std::move(loaded).value();
}

}  // namespace

FamilyData load_family(const FamilyTables& csv) {
  ParameterTable parameters = checked(ParameterTable::load(csv.parameters));
  if (!csv.ranges.empty()) VINV_CHECK(parameters.take_ranges(csv.ranges).has_value());
  return {std::move(parameters), checked(AlarmTable::load(csv.alarms)), checked(SignalMap::load(csv.terminals)),
          checked(load_models(csv.models))};
}

}  // namespace vinv::inverter
