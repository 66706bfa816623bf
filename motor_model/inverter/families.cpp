// The families that can be made, by the names that plant files use.
#include <array>
#include <utility>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/inverter.hpp"

namespace vinv::inverter {
namespace {

struct Family {
  std::string_view name;
  Result<std::unique_ptr<Inverter>, std::string> (*make)(const InverterConfig&);
  const std::vector<ModelRow>& (*models)();
};

const std::array<Family, 2> kFamilies{{
    {e500::kFamily, &e500::make_e500, []() -> const std::vector<ModelRow>& { return e500::family_data().models; }},
    {a700::kFamily, &a700::make_a700, []() -> const std::vector<ModelRow>& { return a700::family_data().models; }},
}};

}  // namespace

Result<std::unique_ptr<Inverter>, std::string> make_inverter(std::string_view family, const InverterConfig& config) {
  std::string known;
  for (const Family& f : kFamilies) {
    if (f.name == family) return f.make(config);
    known += (known.empty() ? "" : ", ") + std::string(f.name);
  }
  return Unexpected("there is no inverter family " + std::string(family) + "; there is " + known);
}

std::vector<std::string_view> families() {
  std::vector<std::string_view> out;
  for (const Family& f : kFamilies) out.push_back(f.name);
  return out;
}

std::vector<std::string_view> models(std::string_view family) {
  std::vector<std::string_view> out;
  for (const Family& f : kFamilies) {
    if (f.name != family) continue;
    for (const ModelRow& m : f.models()) out.push_back(m.model);
  }
  return out;
}

}  // namespace vinv::inverter
