// A board on the bench: fake drive, serial line, one fake time that jumps from event to event, ticks of 1 ms.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "option_boards/boards/make_board.hpp"
#include "tests/option_boards/support/fake_drive.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {

class BoardBench : public ::testing::Test {
 protected:
  static constexpr Duration kTick = std::chrono::milliseconds(1);
  struct Sent {
    Instant at{};
    Bytes bytes;
  };

  explicit BoardBench(unsigned node = 25) {
    auto made = boards::make_board({"oi-fr-e5nco", node}, drive);
    board = std::move(made).value();
  }

  void power_on() {
    board->handle_power(now, true);
    advance(std::chrono::milliseconds(50));
  }
  void power_cycle() {
    board->handle_power(now, false);
    drive.lose_mailbox();
    advance(std::chrono::milliseconds(10));
    power_on();
  }
  // Ticks come on whole milliseconds, deadlines in between; what the board sends is kept.
  void advance(Duration by) {
    const Instant end = now + by;
    while (now < end) {
      Instant next = std::min(end, next_tick_at);
      if (const auto at = board->next_deadline()) next = std::min(next, std::max(*at, now));
      now = next;
      board->handle_timeout(now);
      drain();
      if (now == next_tick_at) {
        drive.tick();
        board->handle_drive_tick(now);
        drain();
        next_tick_at += kTick;
      }
    }
  }
  void drain() {
    while (auto bytes = line().poll_transmit(now)) sent.push_back({now, std::move(*bytes)});
  }
  modbus::Unit& unit() {
    modbus::Unit* found = board->modbus_unit();
    VINV_CHECK(found != nullptr);
    return *found;
  }
  boards::SerialChannel& line() {
    boards::SerialChannel* channel = board->serial_channel();
    VINV_CHECK(channel != nullptr);
    return *channel;
  }
  void receive(const Bytes& bytes, bool line_error = false) {
    line().handle_bytes(now, bytes, line_error);
    drain();
  }
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

  FakeDrive drive;
  std::unique_ptr<boards::OptionBoard> board;
  Instant now = instant_from_ns(7'000'000'000);
  Instant next_tick_at = now + kTick;
  std::vector<Sent> sent;
};

}  // namespace vinv::test
