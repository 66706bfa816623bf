// What a family of Mitsubishi inverters is made of, apart from behaviour: its tables, terminals, causes and counters.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "motor_model/inverter/family_data.hpp"
#include "motor_model/inverter/mitsubishi/state.hpp"
#include "motor_model/port/drive_port.hpp"

namespace vinv::inverter::mitsubishi {

// A control input by its printed name; the network's bit of the same name drives the same function.
struct InputTerminal {
  std::string_view name;
  port::NetTerminal bit{};
  unsigned function = 0;              // parameter that assigns its function; 0: fixed
  std::optional<InputSignal> signal;  // the fixed function
};

struct OutputTerminal {
  std::string_view name;
  unsigned function = 0;
};

struct AnalogTerminal {
  std::string_view name;
  AnalogInput input{};
  double minimum = 0;
  double maximum = 0;
  std::string_view unit;
};

struct CauseName {
  std::string_view name;
  bool Causes::*cause;
};

struct Personality {
  std::string_view family;  // as plant files name it
  const FamilyData* data = nullptr;
  std::span<const InputTerminal> inputs;
  std::string_view input_functions;  // "Pr.180-183 give to RL, RM, RH or MRS"
  std::span<const OutputTerminal> outputs;
  std::span<const AnalogTerminal> analogs;
  std::span<const CauseName> causes;
  std::uint32_t mode_writes = 2;               // values of WriteRequest kOperationMode that its options offer, from 0
  std::uint32_t clear_writes = 2;              // ... of kRestoreDefaults
  std::span<const std::string_view> counters;  // of the EEPROM record, beyond what every family has
};

}  // namespace vinv::inverter::mitsubishi
