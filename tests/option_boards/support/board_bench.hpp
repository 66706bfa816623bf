// The bench as a test fixture, in the words of a master: read, write, exchange.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "tests/option_boards/support/bench.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {

class BoardBench : public ::testing::Test, protected Bench {
 protected:
  using Bench::Bench;

  // The answer frame as hex with its CRC; "" is silence.
  std::string exchange(const Bytes& request) {
    sent.clear();
    receive(request);
    advance(std::chrono::milliseconds(100));
    EXPECT_LE(sent.size(), 1u);
    return sent.empty() ? "" : to_hex(sent.front().bytes);
  }
  // Without address and CRC, which are checked here.
  std::string ask(std::string_view pdu_hex, std::uint8_t node = 25) {
    Bytes request{node};
    const Bytes pdu = from_hex(pdu_hex);
    request.insert(request.end(), pdu.begin(), pdu.end());
    const Bytes answer = from_hex(exchange(with_crc(request)));
    if (answer.empty()) return "";
    EXPECT_GE(answer.size(), 4u);
    EXPECT_EQ(modbus::crc16(answer), 0);
    EXPECT_EQ(answer[0], node);
    return to_hex(ByteView(answer).subspan(1, answer.size() - 3));
  }
  static Bytes read_pdu(unsigned address, unsigned quantity) { return word_pdu(3, address, quantity); }
  static Bytes write_pdu(unsigned address, unsigned value) { return word_pdu(6, address, value); }
  static Bytes word_pdu(std::uint8_t function, unsigned first, unsigned second) {
    Bytes pdu{function};
    append_be16(pdu, static_cast<std::uint16_t>(first));
    append_be16(pdu, static_cast<std::uint16_t>(second));
    return pdu;
  }
  std::string read(unsigned address, unsigned quantity = 1) { return ask(to_hex(read_pdu(address, quantity))); }
  std::string write(unsigned address, unsigned value) { return ask(to_hex(write_pdu(address, value))); }
  // What an accepted write answers.
  static std::string echo(unsigned address, unsigned value) { return to_hex(write_pdu(address, value)); }
  static std::string words(std::initializer_list<unsigned> values) {
    Bytes pdu{3, static_cast<std::uint8_t>(2 * values.size())};
    for (const unsigned value : values) append_be16(pdu, static_cast<std::uint16_t>(value));
    return to_hex(pdu);
  }
};

}  // namespace vinv::test
