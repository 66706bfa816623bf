#include "sim/masters/modbus_request.hpp"

#include <cstdio>
#include <utility>

namespace vinv::masters {
namespace {

constexpr std::size_t kMaxReadQuantity = 125;
constexpr std::size_t kMaxWriteQuantity = 123;
constexpr std::uint8_t kExceptionBit = 0x80;

}  // namespace

ModbusRequest ModbusRequest::read(std::uint8_t unit, std::uint16_t address, std::uint16_t quantity) {
  return {unit, ModbusFunction::kReadHoldingRegisters, address, quantity, {}};
}
ModbusRequest ModbusRequest::write(std::uint8_t unit, std::uint16_t address, std::uint16_t value) {
  return {unit, ModbusFunction::kWriteSingleRegister, address, 1, {value}};
}
ModbusRequest ModbusRequest::write_several(std::uint8_t unit, std::uint16_t address,
                                           std::vector<std::uint16_t> values) {
  const auto quantity = static_cast<std::uint16_t>(values.size());
  return {unit, ModbusFunction::kWriteMultipleRegisters, address, quantity, std::move(values)};
}
ModbusRequest ModbusRequest::diagnose(std::uint8_t unit, std::uint16_t sub_function, std::uint16_t data) {
  return {unit, ModbusFunction::kDiagnostics, sub_function, 1, {data}};
}

bool ModbusRequest::is_legal() const {
  switch (function) {
    case ModbusFunction::kReadHoldingRegisters:
      return unit != kModbusBroadcast && quantity >= 1 && quantity <= kMaxReadQuantity && values.empty();
    case ModbusFunction::kWriteSingleRegister: return values.size() == 1;
    case ModbusFunction::kDiagnostics: return unit != kModbusBroadcast && values.size() == 1;
    case ModbusFunction::kWriteMultipleRegisters: return !values.empty() && values.size() <= kMaxWriteQuantity;
  }
  return false;
}

std::string text_of(ModbusFailure failure) {
  switch (failure.kind) {
    case ModbusFailure::Kind::kTimeout: return "no answer";
    case ModbusFailure::Kind::kBadFrame: return "damaged answer";
    case ModbusFailure::Kind::kWrongAnswer: return "an answer that does not fit the request";
    case ModbusFailure::Kind::kException: {
      char text[16];
      std::snprintf(text, sizeof text, "exception %02X", failure.exception);
      return text;
    }
    case ModbusFailure::Kind::kNotConnected: return "no connection";
  }
  return {};
}

Bytes emit_pdu(const ModbusRequest& request) {
  VINV_CHECK(request.is_legal());
  Bytes pdu{static_cast<std::uint8_t>(request.function)};
  append_be16(pdu, request.address);
  switch (request.function) {
    case ModbusFunction::kReadHoldingRegisters: append_be16(pdu, request.quantity); break;
    case ModbusFunction::kWriteSingleRegister:
    case ModbusFunction::kDiagnostics: append_be16(pdu, request.values.front()); break;
    case ModbusFunction::kWriteMultipleRegisters:
      append_be16(pdu, static_cast<std::uint16_t>(request.values.size()));
      pdu.push_back(static_cast<std::uint8_t>(2 * request.values.size()));
      for (const std::uint16_t value : request.values) append_be16(pdu, value);
      break;
  }
  return pdu;
}

ModbusAnswer parse_answer(const ModbusRequest& request, ByteView pdu) {
  const auto wrong = Unexpected(ModbusFailure{ModbusFailure::Kind::kWrongAnswer});
  const auto function = static_cast<std::uint8_t>(request.function);
  if (pdu.size() == 2 && pdu[0] == (function | kExceptionBit))
    return Unexpected(ModbusFailure{ModbusFailure::Kind::kException, pdu[1]});
  if (pdu.empty() || pdu[0] != function) return wrong;
  if (request.function == ModbusFunction::kReadHoldingRegisters) {
    const std::size_t bytes = std::size_t{2} * request.quantity;
    if (pdu.size() != 2 + bytes || pdu[1] != bytes) return wrong;
    std::vector<std::uint16_t> values;
    for (std::size_t i = 0; i < request.quantity; ++i) values.push_back(read_be16(pdu, 2 + 2 * i));
    return values;
  }
  if (pdu.size() != 5 || read_be16(pdu, 1) != request.address) return wrong;
  const std::uint16_t word = read_be16(pdu, 3);
  switch (request.function) {
    case ModbusFunction::kWriteSingleRegister:
      if (word != request.values.front()) return wrong;
      return request.values;
    case ModbusFunction::kDiagnostics: return std::vector<std::uint16_t>{word};
    default:
      if (word != request.values.size()) return wrong;
      return request.values;
  }
}

}  // namespace vinv::masters
