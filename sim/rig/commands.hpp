// The command set: everything that a person does at a drive, by one name each, for the control socket, `vinverter ctl`
// and scenarios. A command takes a drive, and a value as JSON or as the words of a command line.
// docs/control-socket.md is its reference.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"
#include "sim/rig/plant.hpp"

namespace vinv::rig {

using Json = nlohmann::ordered_json;

// Codes of JSON-RPC 2.0, section 5.1; -32000 and below are ours.
enum class CommandCode : int {
  kParseError = -32700,
  kInvalidRequest = -32600,
  kUnknownCommand = -32601,
  kInvalidValue = -32602,  // wrong word, unit, type, or no such drive
  kRefused = -32000,       // the drive itself refuses: mode, range, locked ...
};

struct CommandError {
  CommandCode code;
  std::string message;  // a sentence that names what is allowed
};

using CommandResult = Result<Json, CommandError>;

struct CommandInfo {
  std::string_view name;
  bool for_drive;          // false: the plant as a whole
  std::string_view value;  // what it takes, as words
  std::string_view meaning;
  std::string_view example;  // after `vinverter ctl`
};
const std::vector<CommandInfo>& commands();

// Executes at once and never waits; what takes time (a dip, a power cycle) is scheduled.
CommandResult execute(Plant& plant, std::string_view command, std::string_view drive, const Json& value);
// `terminal STF=on RH=off`, `terminal STF on`, `run forward`, `mains dip 40 % for 200 ms`: words become the value.
CommandResult execute_words(Plant& plant, std::string_view command, std::string_view drive,
                            const std::vector<std::string>& words);

// "EXT", "PU", "NET" ...
std::string_view mode_name(port::OperationMode mode);

// How a foreign client reaches a drive now: [{"protocol": "modbus-tcp", "host": ..., "port": ..., "unit": ...}, ...].
Json endpoints_json(const DriveUnit& drive);

}  // namespace vinv::rig
