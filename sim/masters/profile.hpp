// How a board wants to be spoken to, as data: which register, object or PDO does what a word says. A further board or
// protocol is a table of these rows; the code that carries them out (word_runner.hpp) knows none.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/masters/words.hpp"

namespace vinv::masters {

// Where a value lives. Modbus: the address of the register. CANopen: index << 8 | sub-index, or for kOutput and kSend
// the number of the RPDO << 8 | offset in bytes. EtherNet/IP: eip_item.hpp.
using Item = std::uint32_t;

enum class Act : std::uint8_t {
  kWrite,    // the operand to the item, and wait for the answer
  kAwait,    // read the item until (value & mask) == constant, at most for time_ms; a refused read is no end
  kSkipIf,   // read the item once; (value & mask) == constant: leave out the next `skip` steps
  kCommand,  // the protocol's own command (CANopen: NMT), by number in constant
  kOutput,   // the operand into the output image
  kSend,     // the output image, which nobody acknowledges
  kListen,   // for time_ms: an emergency whose byte `item` is constant refuses the word
};

enum class Operand : std::uint8_t {
  kConstant,
  kConstantPlusNode,  // COB-IDs
  kHz,                // the order's value / scale
  kRpm,               // the order's value / scale
  kSignedRpm,         // the last reference in rpm, negative for reverse
};

struct ProfileStep {
  Word word;
  Act act = Act::kWrite;
  Item item = 0;
  std::uint8_t size = 2;  // bytes
  Operand operand = Operand::kConstant;
  std::uint32_t constant = 0;
  std::uint32_t mask = 0xffffffff;
  double scale = 1;  // physical value of a raw 1
  unsigned time_ms = 0;
  unsigned skip = 0;
  std::string_view source = {};
};

// Parameter n of first..last (and its sub) is the item base + n_step * (n - first) + sub.
struct ParameterRule {
  std::uint16_t first;
  std::uint16_t last;
  Item base;
  Item n_step;
  std::uint8_t first_sub = 0;
  std::uint8_t last_sub = 0;
  std::string_view source = {};
};

struct MonitorRow {
  std::string_view name;
  Item item;
  std::uint8_t size = 2;
  bool is_signed = false;
  double scale = 1;
  std::string_view unit = {};
  std::uint32_t mask = 0xffff;
  std::string_view source = {};
};

// What the board's manual calls a code of the protocol.
struct CodeText {
  std::uint32_t code;
  std::string_view text;
};

// The I/O connection of a board on EtherNet/IP: connection points and bytes of data.
struct IoLayout {
  std::uint16_t output_point = 0, input_point = 0;
  std::uint8_t output_size = 0, input_size = 0;
  std::uint16_t input_only_point = 0, listen_only_point = 0;  // that stand for no output data
};

struct BoardProfile {
  std::string_view board;              // as in the plant file
  std::string_view protocol;           // "modbus", "canopen", "canopen-402"
  std::span<const ProfileStep> steps;  // of one word in their order
  std::span<const ParameterRule> parameters;
  std::span<const MonitorRow> monitors;
  std::span<const CodeText> codes = {};
  // Raw words that stand for the values 9999 ("not used") and 8888.
  std::uint32_t raw_9999 = 0xffff;
  std::uint32_t raw_8888 = 0xfff0;
  // For a drive profile that counts in rpm: a reference in Hz at this number of poles.
  unsigned poles = 4;
  IoLayout io = {};

  // What the board can be told this way.
  std::vector<Word> words() const;
  const ParameterRule* parameter(std::uint16_t number, std::uint8_t sub) const;
  const MonitorRow* monitor(std::string_view name) const;
};

std::span<const BoardProfile> profiles();
// nullptr: the board cannot be spoken to this way.
const BoardProfile* find_profile(std::string_view board, std::string_view protocol);

}  // namespace vinv::masters
