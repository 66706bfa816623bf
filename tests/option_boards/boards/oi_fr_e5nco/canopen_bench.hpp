// The board on a CAN bus, in the words of a master. Node 25 (19H), a fake inverter that decides at its next tick.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "tests/option_boards/canopen/can_text.hpp"
#include "tests/option_boards/support/bench.hpp"

namespace vinv::test {

using namespace std::chrono_literals;

class CanopenBench : public ::testing::Test, protected Bench {
 protected:
  using Kind = port::WriteRequest::Kind;
  using Terminal = port::NetTerminal;

  CanopenBench() {
    power_on();
    frames.clear();
  }
  // On the bus and commanding.
  void network() {
    tell("000#0119");
    wait(5ms);
    ASSERT_EQ(drive.mode, port::OperationMode::kNetwork);
    drive.posted.clear();
    drive.executed.clear();
    frames.clear();
  }

  // What comes back at once.
  std::string tell(std::string_view text) {
    frames.clear();
    receive_frame(can(text));
    return taken();
  }
  // What comes in this time.
  std::string wait(Duration time) {
    frames.clear();
    advance(time);
    return taken();
  }
  // The same with the milliseconds since the beginning: "40:099#...".
  std::string transcript(Duration time) {
    const Instant begin = now;
    frames.clear();
    advance(time);
    std::string all;
    for (const SentFrame& sent_frame : frames) {
      const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(sent_frame.at - begin).count();
      all += (all.empty() ? "" : " ") + std::to_string(ms) + ":" + text_of(sent_frame.frame);
    }
    frames.clear();
    return all;
  }
  std::string taken() {
    std::string all;
    for (const SentFrame& sent_frame : frames) all += (all.empty() ? "" : " ") + text_of(sent_frame.frame);
    frames.clear();
    return all;
  }

  static CanFrame sdo(unsigned command, unsigned index, unsigned sub, std::uint32_t value = 0) {
    const auto byte = [](std::uint32_t v, unsigned n) { return static_cast<std::uint8_t>(v >> 8 * n); };
    return CanFrame::standard(0x619, {byte(command, 0), byte(index, 0), byte(index, 1), byte(sub, 0), byte(value, 0),
                                      byte(value, 1), byte(value, 2), byte(value, 3)});
  }
  static std::string hex(std::uint32_t value, int digits) {
    char buffer[16];
    std::snprintf(buffer, sizeof buffer, "%0*X", digits, value);
    return buffer;
  }
  // "=" and the value in as many digits as it has, or the abort code.
  std::string read(unsigned index, unsigned sub = 0) {
    frames.clear();
    receive_frame(sdo(0x40, index, sub));
    return answer(index, sub);
  }
  // "ok" or the abort code, within a second.
  std::string write(unsigned index, unsigned sub, std::uint32_t value, unsigned size) {
    frames.clear();
    receive_frame(sdo(0x23 | (4 - size) << 2, index, sub, value));
    for (int i = 0; i < 1000 && frames_of(0x599) == 0; ++i) advance(1ms);
    return answer(index, sub);
  }
  std::size_t frames_of(std::uint32_t id) const {
    std::size_t count = 0;
    for (const SentFrame& f : frames) count += f.frame.id == id ? 1u : 0u;
    return count;
  }
  std::string answer(unsigned index, unsigned sub) {
    std::optional<CanFrame> found;
    for (const SentFrame& f : frames) {
      if (f.frame.id != 0x599) continue;
      EXPECT_FALSE(found) << "two answers";
      found = f.frame;
    }
    if (!found) return "";
    EXPECT_EQ(read_le16(found->bytes(), 1), index);
    EXPECT_EQ(found->data[3], sub);
    const std::uint32_t value = read_le32(found->bytes(), 4);
    switch (found->data[0]) {
      case 0x80: return hex(value, 8);
      case 0x60: return "ok";
      case 0x43: return "=" + hex(value, 8);
      case 0x4b: return "=" + hex(value, 4);
      case 0x4f: return "=" + hex(value, 2);
      default: return "?" + text_of(*found);
    }
  }
  std::string emergencies() {
    std::string all;
    for (const SentFrame& f : frames) {
      if (f.frame.id == 0x99) all += (all.empty() ? "" : " ") + text_of(f.frame).substr(4);
    }
    return all;
  }
  void map(unsigned mapping, const std::vector<std::uint32_t>& entries) {
    const unsigned communication = mapping - 0x200;
    const auto cob_id = static_cast<std::uint32_t>(std::stoul(read(communication, 1).substr(1), nullptr, 16));
    ASSERT_EQ(write(communication, 1, cob_id | 0x80000000, 4), "ok");
    ASSERT_EQ(write(mapping, 0, 0, 1), "ok");
    unsigned sub = 0;
    for (const std::uint32_t entry : entries) ASSERT_EQ(write(mapping, ++sub, entry, 4), "ok");
    ASSERT_EQ(write(mapping, 0, sub, 1), "ok");
    ASSERT_EQ(write(communication, 1, cob_id & 0x7fffffff, 4), "ok");
  }
  void alarm(std::uint8_t code) {
    if (code != 0) {
      for (std::size_t i = drive.history.size() - 1; i > 0; --i) drive.history[i] = drive.history[i - 1];
      drive.history[0] = code;
    }
    drive.status_now.alarm = code != 0;
    if (code != 0) drive.status_now.running = false;
  }
  std::uint16_t terminals(std::size_t n) const { return drive.executed.at(n).terminals.bits; }
  static constexpr std::uint16_t bit(Terminal t) { return static_cast<std::uint16_t>(t); }
};

}  // namespace vinv::test
