// Whatever comes on the bus: the standard's answer or silence, and the next good request is answered.
#include "sim/base/random.hpp"
#include "tests/option_boards/canopen/slave_bench.hpp"

namespace vinv::test {
namespace {

class CanopenSlaveBadFrames : public SlaveBench {
 protected:
  void check_alive() {
    tell("000#8005");
    drain();
    EXPECT_EQ(read(0x1000, 0), "=00010192");
  }
};

TEST_F(CanopenSlaveBadFrames, EveryIdentifierInEveryLengthAndState) {
  for (const char* state : {"000#0105", "000#0205", "000#8005"}) {
    for (std::uint32_t id = 1; id <= 0x7ff; ++id) {
      for (std::uint8_t length = 0; length <= 8; ++length) {
        for (const bool remote : {false, true}) {
          tell(state);
          CanFrame frame;
          frame.id = id;
          frame.length = length;
          frame.remote = remote;
          slave.handle_frame(now, frame);
          int sent = 0;
          while (const auto answer = slave.poll_transmit(now)) {
            ++sent;
            EXPECT_LE(answer->length, 8);
          }
          const bool ours = id == 0x605 || id == 0x185 || id == 0x705 || id == 0x80;
          EXPECT_LE(sent, ours ? 1 : 0) << std::hex << id;
        }
      }
    }
  }
  check_alive();
}

TEST_F(CanopenSlaveBadFrames, ExtendedFramesAreNotOurs) {
  drain();
  for (const std::uint32_t id : {0x000u, 0x080u, 0x205u, 0x605u, 0x705u}) {
    CanFrame frame = can("000#4000100000000000");
    frame.id = id;
    frame.extended = true;
    slave.handle_frame(now, frame);
    frame.remote = true;
    slave.handle_frame(now, frame);
    EXPECT_EQ(drain(), "");
  }
}

TEST_F(CanopenSlaveBadFrames, RandomFloodLeavesASlaveThatAnswers) {
  Random random(20260101);
  for (int i = 0; i < 200'000; ++i) {
    CanFrame frame;
    const std::uint32_t ids[] = {0x000, 0x080, 0x205, 0x605,
                                 0x705, 0x185, 0x605, static_cast<std::uint32_t>(random.below(0x800))};
    frame.id = ids[random.below(std::size(ids))];
    frame.length = static_cast<std::uint8_t>(random.below(9));
    frame.remote = random.below(8) == 0;
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random.next());
    if (frame.id == 0x605) {
      frame.length = 8;
      const std::uint16_t indices[] = {0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1a00, 0x1005, 0x1014, 0x100c, 0x2000};
      const std::uint16_t index = indices[random.below(std::size(indices))];
      frame.data[1] = static_cast<std::uint8_t>(index);
      frame.data[2] = static_cast<std::uint8_t>(index >> 8);
      frame.data[3] = static_cast<std::uint8_t>(random.below(6));
    }
    slave.handle_frame(now, frame);
    if (random.below(3) == 0) advance(std::chrono::microseconds(random.below(5000)));
    if (random.below(4) == 0) new_data();
    if (random.below(2) == 0) drain();
  }
  tell("000#8205");
  drain();
  EXPECT_EQ(read(0x1000, 0), "=00010192");
}

}  // namespace
}  // namespace vinv::test
