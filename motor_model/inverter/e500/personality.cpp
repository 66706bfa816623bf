// Tables, terminals and causes of the FR-E500, and its factory.
#include <array>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/parameter_numbers.hpp"
#include "vinv_inverter_data.hpp"

namespace vinv::inverter::e500 {
namespace {

using mitsubishi::AnalogInput;
using mitsubishi::AnalogTerminal;
using mitsubishi::CauseName;
using mitsubishi::Causes;
using mitsubishi::InputTerminal;
using mitsubishi::OutputTerminal;
using port::NetTerminal;

constexpr std::array<InputTerminal, 7> kInputs{{
    {"STF", NetTerminal::kStf, 0, InputSignal::kStf},
    {"STR", NetTerminal::kStr, 0, InputSignal::kStr},
    {"RL", NetTerminal::kRl, pr::kRlFunction, {}},
    {"RM", NetTerminal::kRm, pr::kRmFunction, {}},
    {"RH", NetTerminal::kRh, pr::kRhFunction, {}},
    {"MRS", NetTerminal::kMrs, pr::kMrsFunction, {}},
    {"RES", NetTerminal::kRes, 0, InputSignal::kRes},
}};
constexpr std::array<OutputTerminal, 3> kOutputs{{
    {"RUN", pr::kRunFunction},
    {"FU", pr::kFuFunction},
    {"ABC", pr::kAbcFunction},
}};
constexpr std::array<AnalogTerminal, 2> kAnalogs{{
    {"2", AnalogInput::k2, 0, 10, "V"},
    {"4", AnalogInput::k4, 0, 20, "mA"},
}};
constexpr std::array<CauseName, 10> kCauses{{
    {"earth_fault", &Causes::earth_fault},
    {"output_phase_open", &Causes::output_phase_open},
    {"brake_transistor", &Causes::brake_transistor},
    {"eeprom_write", &Causes::eeprom_write},
    {"option", &Causes::option},
    {"external_thermal", &Causes::external_thermal},
    {"pu_disconnected", &Causes::pu_disconnected},
    {"current_sensor", &Causes::current_sensor},
    {"dc_link_sensor", &Causes::dc_link_sensor},
    {"heat_sink_sensor", &Causes::heat_sink_sensor},
}};

}  // namespace

const FamilyData& family_data() {
  static const FamilyData data = load_family({data::mitsubishi_e500_parameters, data::mitsubishi_e500_alarms,
                                              data::mitsubishi_e500_terminals, data::mitsubishi_e500_models});
  return data;
}

const mitsubishi::Personality& personality() {
  static const mitsubishi::Personality p{
      .family = kFamily,
      .data = &family_data(),
      .inputs = kInputs,
      .input_functions = "Pr.180-183 give to RL, RM, RH or MRS",
      .outputs = kOutputs,
      .analogs = kAnalogs,
      .causes = kCauses,
      .counters = {},
  };
  return p;
}

Result<std::unique_ptr<Inverter>, std::string> make_e500(const InverterConfig& config) {
  auto prepared = mitsubishi::prepare(personality(), config);
  if (!prepared) return Unexpected(prepared.error());
  return std::unique_ptr<Inverter>(
      std::make_unique<E500Inverter>(config, *prepared->model, std::move(prepared->store)));
}

}  // namespace vinv::inverter::e500
