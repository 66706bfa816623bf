// Terminals, causes and counters of the FR-A700, and its factory.
#include <array>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

using mitsubishi::AnalogInput;
using mitsubishi::AnalogTerminal;
using mitsubishi::CauseName;
using mitsubishi::Causes;
using mitsubishi::InputTerminal;
using mitsubishi::OutputTerminal;
using port::NetTerminal;

constexpr std::array<InputTerminal, 12> kInputs{{
    {"STF", NetTerminal::kStf, pr::kStfFunction, {}},
    {"STR", NetTerminal::kStr, pr::kStrFunction, {}},
    {"RL", NetTerminal::kRl, pr::kRlFunction, {}},
    {"RM", NetTerminal::kRm, pr::kRmFunction, {}},
    {"RH", NetTerminal::kRh, pr::kRhFunction, {}},
    {"RT", NetTerminal::kRt, pr::kRtFunction, {}},
    {"AU", NetTerminal::kAu, pr::kAuFunction, {}},
    {"JOG", NetTerminal::kJog, pr::kJogFunction, {}},
    {"CS", NetTerminal::kCs, pr::kCsFunction, {}},
    {"MRS", NetTerminal::kMrs, pr::kMrsFunction, {}},
    {"STOP", NetTerminal::kStop, pr::kStopFunction, {}},
    {"RES", NetTerminal::kRes, pr::kResFunction, {}},
}};
// In the order of the output terminal monitor (FR-A7NE manual 7.6) and of the bits of Pr.496.
constexpr std::array<OutputTerminal, 7> kOutputs{{
    {"RUN", pr::kRunFunction},
    {"SU", pr::kSuFunction},
    {"IPF", pr::kIpfFunction},
    {"OL", pr::kOlFunction},
    {"FU", pr::kFuFunction},
    {"ABC1", pr::kAbc1Function},
    {"ABC2", pr::kAbc2Function},
}};
// Terminals 2 and 4 take V or mA, as Pr.73 and Pr.267 have it; more than 20 mA is a wiring mistake that can be made.
constexpr std::array<AnalogTerminal, 3> kAnalogs{{
    {"2", AnalogInput::k2, 0, 40, "V or mA"},
    {"4", AnalogInput::k4, 0, 40, "V or mA"},
    {"1", AnalogInput::k1, -10, 10, "V"},
}};
constexpr std::array<CauseName, 15> kCauses{{
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
    {"thermistor", &Causes::thermistor},
    {"fan", &Causes::fan},
    {"inrush_circuit", &Causes::inrush_circuit},
    {"control_capacitor", &Causes::control_capacitor},
    {"main_capacitor", &Causes::main_capacitor},
}};
constexpr std::array<std::string_view, kCounters> kCounterNames{"energized_seconds",
                                                                "energy_joule",
                                                                "line_errors",
                                                                "maintenance_seconds",
                                                                "network_frequency_0.01Hz",
                                                                "inrush_operations",
                                                                "capacitor_ageing_seconds",
                                                                "main_capacitor_percent",
                                                                "main_capacitor_measuring",
                                                                "password",
                                                                "password_errors"};

}  // namespace

const mitsubishi::Personality& personality() {
  static const mitsubishi::Personality p{
      .family = kFamily,
      .data = &family_data(),
      .inputs = kInputs,
      .input_functions = "Pr.178-189 give to a terminal",
      .outputs = kOutputs,
      .analogs = kAnalogs,
      .causes = kCauses,
      .mode_writes = 3,
      .clear_writes = 4,
      .counters = kCounterNames,
  };
  return p;
}

Result<std::unique_ptr<Inverter>, std::string> make_a700(const InverterConfig& config) {
  if (config.option_connector < 1 || config.option_connector > 3) {
    return Unexpected(std::string("option connector: takes 1 to 3"));
  }
  auto prepared = mitsubishi::prepare(personality(), config);
  if (!prepared) return Unexpected(prepared.error());
  return std::unique_ptr<Inverter>(
      std::make_unique<A700Inverter>(config, *prepared->model, std::move(prepared->store)));
}

}  // namespace vinv::inverter::a700
