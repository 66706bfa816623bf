// Protocol data units of the two functions that drives of this project serve, and exception answers.
// MODBUS Application Protocol V1.1b3: 4.1 sizes, 6.3 function 03, 6.6 function 06, 7 exceptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"

namespace vinv::modbus {

inline constexpr std::size_t kMaxPdu = 253;
inline constexpr std::uint16_t kMaxReadQuantity = 125;  // 6.3: 007DH

enum class Function : std::uint8_t { kReadHoldingRegisters = 0x03, kWriteSingleRegister = 0x06 };

enum class Exception : std::uint8_t {
  kIllegalFunction = 0x01,
  kIllegalDataAddress = 0x02,
  kIllegalDataValue = 0x03,
  kServerDeviceFailure = 0x04,
  kAcknowledge = 0x05,
  kServerDeviceBusy = 0x06,
  kGatewayTargetFailedToRespond = 0x0b,
};

struct ReadHoldingRegisters {
  std::uint16_t address = 0;   // as it travels: 0 is the first
  std::uint16_t quantity = 1;  // 1-125
  friend constexpr bool operator==(ReadHoldingRegisters, ReadHoldingRegisters) = default;
};

struct WriteSingleRegister {
  std::uint16_t address = 0;
  std::uint16_t value = 0;
  friend constexpr bool operator==(WriteSingleRegister, WriteSingleRegister) = default;
  VINV_ARCHIVE(WriteSingleRegister, address, value);
};

using Request = std::variant<ReadHoldingRegisters, WriteSingleRegister>;

// The function byte as it came, 0 of an empty PDU.
constexpr std::uint8_t function_of(ByteView pdu) { return pdu.empty() ? std::uint8_t{0} : pdu[0]; }

// In the order of the flow charts of 6.3 and 6.6: unknown function kIllegalFunction, then a length that does not fit
// the function or a quantity outside 1-125 kIllegalDataValue. Addresses are the unit's business.
Result<Request, Exception> parse_request(ByteView pdu);
Bytes emit(const Request& request);

// The answer to function 03; 1-125 values.
Bytes emit_read_answer(std::span<const std::uint16_t> values);
// 80H + function, code. A function that has bit 7 set already keeps it.
Bytes emit_exception(std::uint8_t function, Exception code);

}  // namespace vinv::modbus
