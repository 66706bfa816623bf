// What a Modbus master asks and what it makes of the answer: PDUs of the four functions that it speaks.
// MODBUS Application Protocol V1.1b3: 6.3 (03), 6.6 (06), 6.8 (08), 6.12 (16), 7 (exceptions).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"

namespace vinv::masters {

enum class ModbusFunction : std::uint8_t {
  kReadHoldingRegisters = 0x03,
  kWriteSingleRegister = 0x06,
  kDiagnostics = 0x08,
  kWriteMultipleRegisters = 0x10,
};

VINV_ENUM_RANGE(ModbusFunction, kReadHoldingRegisters, kWriteMultipleRegisters);

inline constexpr std::uint8_t kModbusBroadcast = 0;

struct ModbusRequest {
  std::uint8_t unit = 1;  // kModbusBroadcast: every unit of a serial line; nobody answers
  ModbusFunction function = ModbusFunction::kReadHoldingRegisters;
  std::uint16_t address = 0;          // 08: the sub-function
  std::uint16_t quantity = 1;         // 03: items, 1-125
  std::vector<std::uint16_t> values;  // 06 and 08: one; 16: 1-123

  static ModbusRequest read(std::uint8_t unit, std::uint16_t address, std::uint16_t quantity = 1);
  static ModbusRequest write(std::uint8_t unit, std::uint16_t address, std::uint16_t value);
  static ModbusRequest write_several(std::uint8_t unit, std::uint16_t address, std::vector<std::uint16_t> values);
  static ModbusRequest diagnose(std::uint8_t unit, std::uint16_t sub_function, std::uint16_t data);

  // The numbers of words are those that the function allows, and a broadcast writes.
  bool is_legal() const;
  friend bool operator==(const ModbusRequest&, const ModbusRequest&) = default;
  friend void archive(Archive& a, ModbusRequest& request) {
    VINV_MEMBERS(request, unit, function, address, quantity, values);
    VINV_FIELDS(a, ModbusRequest, unit, function, address, quantity, values);
    a.require(request.is_legal(), "a Modbus request is none");
  }
};

struct ModbusFailure {
  enum class Kind : std::uint8_t {
    kTimeout,       // nothing came within the time, in every attempt
    kBadFrame,      // wrong CRC, a line error, a frame that is too short or too long, in the last attempt
    kWrongAnswer,   // whole, but not what was asked for
    kException,     // the unit refuses: exception
    kNotConnected,  // no connection, or it ended before the answer
  };
  friend VINV_ENUM_RANGE(Kind, kTimeout, kNotConnected);
  Kind kind = Kind::kTimeout;
  std::uint8_t exception = 0;  // kException: the code
  friend bool operator==(ModbusFailure, ModbusFailure) = default;
  VINV_ARCHIVE(ModbusFailure, kind, exception);
};
// "exception 05", "no answer".
std::string text_of(ModbusFailure failure);

// 03: the words read; 08: the data word; 06 and 16: the words written.
using ModbusAnswer = Result<std::vector<std::uint16_t>, ModbusFailure>;

// The request is legal.
Bytes emit_pdu(const ModbusRequest& request);
ModbusAnswer parse_answer(const ModbusRequest& request, ByteView pdu);

}  // namespace vinv::masters
