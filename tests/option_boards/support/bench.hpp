// A board on the bench: fake drive, serial line, CAN bus, one fake time that jumps from event to event, ticks of 1 ms.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "option_boards/boards/make_board.hpp"
#include "sim/base/check.hpp"
#include "tests/option_boards/support/fake_drive.hpp"

namespace vinv::test {

class Bench {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds(1);
  struct Sent {
    Instant at{};
    Bytes bytes;
  };

  struct SentFrame {
    Instant at{};
    CanFrame frame;
  };

  explicit Bench(unsigned node = 25) {
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
    while (auto frame = bus().poll_transmit(now)) frames.push_back({now, *frame});
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
  boards::CanChannel& bus() {
    boards::CanChannel* channel = board->can_channel();
    VINV_CHECK(channel != nullptr);
    return *channel;
  }
  void receive_frame(const CanFrame& frame) {
    bus().handle_frame(now, frame);
    drain();
  }
  void receive(const Bytes& bytes, bool line_error = false) {
    line().handle_bytes(now, bytes, line_error);
    drain();
  }

  FakeDrive drive;
  std::unique_ptr<boards::OptionBoard> board;
  Instant now = instant_from_ns(7'000'000'000);
  Instant next_tick_at = now + kTick;
  std::vector<Sent> sent;
  std::vector<SentFrame> frames;
};

}  // namespace vinv::test
