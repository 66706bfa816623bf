// What is true of every answer of a unit to a request PDU, however bad the request.
#pragma once

#include <algorithm>

#include "option_boards/modbus/pdu.hpp"
#include "sim/base/check.hpp"

namespace vinv::fuzz {

inline void check_answer(ByteView request, ByteView answer) {
  const std::uint8_t function = modbus::function_of(request);
  VINV_CHECK(answer.size() >= 2 && answer.size() <= modbus::kMaxPdu);
  if (answer[0] == (function | 0x80) && answer.size() == 2) {
    VINV_CHECK((answer[1] >= 1 && answer[1] <= 6) || answer[1] == 0x0b);
    VINV_CHECK((answer[1] == 1) == (function != 3 && function != 6) || answer[1] == 0x0b || answer[1] == 6);
    return;
  }
  VINV_CHECK(answer[0] == function);
  if (function == 3) {
    VINV_CHECK(request.size() == 5 && answer[1] == answer.size() - 2 && answer[1] == 2 * read_be16(request, 3));
  } else {
    VINV_CHECK(function == 6 && std::equal(request.begin(), request.end(), answer.begin(), answer.end()));
  }
}

}  // namespace vinv::fuzz
