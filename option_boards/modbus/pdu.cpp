#include "option_boards/modbus/pdu.hpp"

namespace vinv::modbus {
namespace {

constexpr std::size_t kRequestLength = 5;  // functions 03 and 06: function, two words

}  // namespace

Result<Request, Exception> parse_request(ByteView pdu) {
  switch (static_cast<Function>(function_of(pdu))) {
    case Function::kReadHoldingRegisters: {
      if (pdu.size() != kRequestLength) return Unexpected(Exception::kIllegalDataValue);
      const ReadHoldingRegisters read{read_be16(pdu, 1), read_be16(pdu, 3)};
      if (read.quantity == 0 || read.quantity > kMaxReadQuantity) return Unexpected(Exception::kIllegalDataValue);
      return Request{read};
    }
    case Function::kWriteSingleRegister: {
      if (pdu.size() != kRequestLength) return Unexpected(Exception::kIllegalDataValue);
      return Request{WriteSingleRegister{read_be16(pdu, 1), read_be16(pdu, 3)}};
    }
  }
  return Unexpected(Exception::kIllegalFunction);
}

Bytes emit(const Request& request) {
  Bytes pdu;
  pdu.reserve(kRequestLength);
  if (const auto* read = std::get_if<ReadHoldingRegisters>(&request)) {
    pdu.push_back(static_cast<std::uint8_t>(Function::kReadHoldingRegisters));
    append_be16(pdu, read->address);
    append_be16(pdu, read->quantity);
  } else {
    const auto& write = std::get<WriteSingleRegister>(request);
    pdu.push_back(static_cast<std::uint8_t>(Function::kWriteSingleRegister));
    append_be16(pdu, write.address);
    append_be16(pdu, write.value);
  }
  return pdu;
}

Bytes emit_read_answer(std::span<const std::uint16_t> values) {
  VINV_CHECK(!values.empty() && values.size() <= kMaxReadQuantity);
  Bytes pdu;
  pdu.reserve(2 + 2 * values.size());
  pdu.push_back(static_cast<std::uint8_t>(Function::kReadHoldingRegisters));
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const std::uint16_t value : values) append_be16(pdu, value);
  return pdu;
}

Bytes emit_exception(std::uint8_t function, Exception code) {
  return {static_cast<std::uint8_t>(function | 0x80u), static_cast<std::uint8_t>(code)};
}

}  // namespace vinv::modbus
