// A board is saved and goes on as another one, in the middle of whatever its masters do.
#include <gtest/gtest.h>

#include <string>

#include "option_boards/modbus/crc16.hpp"
#include "option_boards/modbus/pdu.hpp"
#include "sim/base/random.hpp"
#include "tests/option_boards/canopen/can_text.hpp"
#include "tests/option_boards/support/bench.hpp"
#include "tests/support/snapshot_checks.hpp"

namespace vinv {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::Bench;

// What two masters, a person and the inverter do at random: CANopen of every kind, Modbus RTU in whole frames, pieces
// and noise, alarms, restarts, supply, switches.
class Story {
 public:
  explicit Story(std::uint64_t seed) : random_(seed) {}

  void step(Bench& bench) {
    switch (random_.below(12)) {
      case 0: bench.receive_frame(nmt()); break;
      case 1:
      case 2: bench.receive_frame(sdo()); break;
      case 3: bench.receive_frame(rpdo()); break;
      case 4: bench.receive_frame(CanFrame::standard(0x80, {})); break;
      case 5: bench.receive_frame(CanFrame::remote_request(pick({0x719, 0x199, 0x299, 0x399}), 8)); break;
      case 6:
      case 7: send_modbus(bench); break;
      case 8: disturb(bench); break;
      default: break;
    }
    bench.drive.monitors[1] = static_cast<std::uint16_t>(random_.below(3) * 100);
    bench.advance(microseconds(random_.below(2500)));
  }

 private:
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_.below(256)); }
  std::uint32_t pick(std::initializer_list<std::uint32_t> values) {
    return *(values.begin() + static_cast<std::ptrdiff_t>(random_.below(values.size())));
  }
  CanFrame nmt() {
    const std::uint32_t command = random_.below(3) == 0 ? pick({2, 128, 129, 130}) : 1;
    return CanFrame::standard(0, {static_cast<std::uint8_t>(command), 0x19});
  }
  CanFrame sdo() {
    struct Object {
      std::uint32_t index, sub, size;
    };
    constexpr Object kObjects[] = {{0x100c, 0, 2}, {0x100d, 0, 1}, {0x1800, 2, 1}, {0x1802, 5, 2}, {0x1400, 2, 1},
                                   {0x6040, 0, 2}, {0x6042, 0, 2}, {0x6007, 0, 2}, {0x6041, 0, 2}, {0x1014, 0, 4},
                                   {0x1800, 1, 4}, {0x1a00, 0, 1}, {0x1a00, 1, 4}, {0x1600, 0, 1}, {0x2000, 1, 2}};
    const Object o = kObjects[random_.below(std::size(kObjects))];
    const bool read = random_.below(3) == 0;
    const std::uint32_t value = pick({0, 1, 2, 6, 7, 15, 252, 254, 100, 0x199, 0x80000199, 0x60410010});
    return CanFrame::standard(
        0x619, {static_cast<std::uint8_t>(read ? 0x40 : 0x23 | (4 - o.size) << 2), static_cast<std::uint8_t>(o.index),
                static_cast<std::uint8_t>(o.index >> 8), static_cast<std::uint8_t>(o.sub),
                static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
                static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 24)});
  }
  CanFrame rpdo() {
    CanFrame frame = CanFrame::standard(pick({0x219, 0x319, 0x419, 0x519}), {});
    frame.length = static_cast<std::uint8_t>(random_.below(4) == 0 ? random_.below(8) : 8);
    for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = static_cast<std::uint8_t>(random_.below(4) * 15);
    return frame;
  }
  void send_modbus(Bench& bench) {
    Bytes frame{static_cast<std::uint8_t>(pick({25, 25, 25, 0, 7}))};
    const modbus::Request request =
        random_.below(2) == 0
            ? modbus::Request(modbus::ReadHoldingRegisters{static_cast<std::uint16_t>(random_.below(40)), 1})
            : modbus::Request(modbus::WriteSingleRegister{static_cast<std::uint16_t>(pick({26000, 14, 0, 6})),
                                                          static_cast<std::uint16_t>(random_.below(3))});
    const Bytes pdu = modbus::emit(request);
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    const std::uint16_t crc = modbus::crc16(frame);
    frame.push_back(static_cast<std::uint8_t>(crc));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    if (random_.below(5) == 0) frame.resize(1 + random_.below(frame.size()));
    bench.receive(frame, random_.below(10) == 0);
  }
  void disturb(Bench& bench) {
    switch (random_.below(9)) {
      case 0: bench.power_cycle(); break;
      case 1: bench.drive.is_ready = !bench.drive.is_ready; break;
      case 2:
        bench.drive.status_now.alarm = !bench.drive.status_now.alarm;
        bench.drive.history[0] = static_cast<std::uint8_t>(pick({0x10, 0x20, 0x30, 0xa3}));
        break;
      case 3: bench.drive.status_now.running = !bench.drive.status_now.running; break;
      case 4: bench.bus().set_bus_off(bench.now, random_.below(2) == 0); break;
      case 5: static_cast<void>(bench.board->set_switch("SW2", static_cast<unsigned>(random_.below(10)))); break;
      case 6: bench.drive.ticks_to_decide = 1 + static_cast<unsigned>(random_.below(9)); break;
      case 7: bench.drive.storage_fails = !bench.drive.storage_fails; break;
      default: bench.drive.parameters[347].value = pick({4, 0x84, 0x64, 6, 0x14}); break;
    }
  }

  Random random_;
};

std::string taken(Bench& bench) {
  std::string out;
  for (const auto& f : bench.frames) out += std::to_string(to_ns(f.at)) + " " + test::text_of(f.frame) + "\n";
  for (const auto& s : bench.sent) {
    out += std::to_string(to_ns(s.at));
    for (const std::uint8_t b : s.bytes) out += " " + std::to_string(b);
    out += "\n";
  }
  bench.frames.clear();
  bench.sent.clear();
  return out + std::string(bench.board->status_led()) + "\n";
}

// The same inverter, another board with the first one's memory.
std::unique_ptr<Bench> relay(Bench& from) {
  auto to = std::make_unique<Bench>();
  to->drive = from.drive;
  to->now = from.now;
  to->next_tick_at = from.next_tick_at;
  const Bytes saved = save_snapshot(*from.board);
  const auto loaded = load_snapshot(*to->board, saved);
  EXPECT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(save_snapshot(*to->board), saved);
  EXPECT_EQ(to->board->next_deadline(), from.board->next_deadline());
  return to;
}

class BoardSnapshot : public testing::TestWithParam<std::uint64_t> {};

TEST_P(BoardSnapshot, ABoardThatIsRelayedAtEveryStepOfARandomStorySaysWhatOneBoardSays) {
  constexpr int kSteps = 400;
  auto one = std::make_unique<Bench>();
  one->power_on();
  auto relayed = std::make_unique<Bench>();
  relayed->power_on();
  Story first(GetParam());
  Story second(GetParam());
  std::size_t said = 0;
  for (int i = 0; i < kSteps; ++i) {
    first.step(*one);
    second.step(*relayed);
    const std::string expected = taken(*one);
    said += static_cast<std::size_t>(std::count(expected.begin(), expected.end(), '\n')) - 1;
    ASSERT_EQ(taken(*relayed), expected) << "step " << i;
    relayed = relay(*relayed);
  }
  EXPECT_EQ(save_snapshot(*relayed->board), save_snapshot(*one->board));
  EXPECT_GT(said, 100u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, BoardSnapshot, testing::Range<std::uint64_t>(1, 9));

TEST(BoardSnapshots, DamageIsRefusedAndTheBoardIsWhatItWas) {
  Bench bench;
  bench.power_on();
  Story story(5);
  for (int i = 0; i < 60; ++i) story.step(bench);
  Bench other;
  other.power_on();
  expect_forged_leave_no_trace(*other.board, save_snapshot(*bench.board), 2000, 3, 100, [&](auto&) {
    for (int k = 0; k < 3; ++k) story.step(other);
  });
}

}  // namespace
}  // namespace vinv
