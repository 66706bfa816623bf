// The board on a bus with masters that do everything wrong: every length at every COB-ID of the node, unknown command
// specifiers, interleaved and aborted transfers, floods. The standard's answer or silence, nothing lost, and Modbus and
// neighbours do not notice. CiA DS-301 v4.0, 9.2; OI-FR-E5NCO manual, 6.
#include "option_boards/boards/oi_fr_e5nco/write_queue.hpp"
#include "option_boards/canopen/slave.hpp"
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {
namespace {

class OiFrE5ncoCanopenBadFrames : public CanopenBench {
 protected:
  static CanFrame of(std::uint32_t id, std::uint8_t length, std::uint8_t fill, bool remote = false) {
    CanFrame frame;
    frame.id = id;
    frame.length = length;
    frame.remote = remote;
    if (!remote) std::fill_n(frame.data.begin(), length, fill);
    return frame;
  }
  std::string send(const CanFrame& frame) {
    frames.clear();
    receive_frame(frame);
    return taken();
  }
  // Whatever happened: the node and the inverter behind it still work.
  void check_alive() {
    tell("000#8219");
    wait(300ms);
    EXPECT_EQ(read(0x1000), "=00010192");
    EXPECT_EQ(tell("719#R1"), "719#7F");
    tell("000#0119");
    wait(5ms);
    drive.executed.clear();
    EXPECT_EQ(tell("219#02008813"), "");
    EXPECT_EQ(wait(10ms), "");
    ASSERT_EQ(drive.executed.size(), 2u);
    EXPECT_EQ(terminals(0), bit(Terminal::kStf));
    EXPECT_EQ(drive.executed[1].value, 5000u);
  }
};

TEST_F(OiFrE5ncoCanopenBadFrames, EveryLengthAtEveryCobIdOfTheNode) {
  for (unsigned n = 1; n < 4; ++n) {
    map(0x1600 + n, {0x40010010, 0x60420010});
    map(0x1a00 + n, {0x20000010});
    EXPECT_EQ(write(0x1800 + n, 2, 253, 1), "ok");
  }
  network();
  bool toggle = false;
  for (std::uint8_t length = 0; length <= 8; ++length) {
    SCOPED_TRACE(std::to_string(length) + " bytes");
    // Nobody asks at these: NMT without a command, SYNC without synchronous PDOs, what the node itself sends.
    for (const std::uint32_t id : {0x000u, 0x080u, 0x099u, 0x199u, 0x299u, 0x399u, 0x499u, 0x599u, 0x719u}) {
      for (const std::uint8_t fill : {0x00, 0xff}) EXPECT_EQ(send(of(id, length, fill)), "") << id;
    }
    // SDO: 8 bytes or nothing. 00 is a segment, FF no specifier at all.
    for (const std::uint8_t fill : {0x00, 0xff}) {
      EXPECT_EQ(send(of(0x619, length, fill)), length < 8 ? "" : "599#8000000001000405");
    }
    // RPDOs of 4 bytes: too short is an emergency, once; then they act, and what is past the mapping does not count.
    for (const std::uint32_t id : {0x219u, 0x319u, 0x419u, 0x519u}) {
      drive.executed.clear();
      // The last of the four that is good again ends the error.
      EXPECT_EQ(send(of(id, length, 0)), length == 0                  ? "099#1082112A00050000"
                                         : length == 4 && id == 0x519 ? "099#0000000000050000"
                                                                      : "")
          << id;
      EXPECT_EQ(wait(10ms), "");
      EXPECT_EQ(drive.executed.size(), length < 4 ? 0u : id == 0x219 ? 2u : 1u) << id;
    }
    // Remote requests: TPDOs and guarding, whatever length they ask for.
    for (const std::uint32_t id : {0x000u, 0x080u, 0x099u, 0x219u, 0x319u, 0x419u, 0x519u, 0x599u, 0x619u}) {
      EXPECT_EQ(send(of(id, length, 0, true)), "") << id;
    }
    EXPECT_EQ(send(of(0x199, length, 0, true)), "199#0000000000000000");
    for (const std::uint32_t id : {0x299u, 0x399u, 0x499u}) {
      EXPECT_EQ(send(of(id, length, 0, true)), hex(id, 3) + "#0000");
    }
    EXPECT_EQ(send(of(0x719, length, 0, true)), std::exchange(toggle, !toggle) ? "719#85" : "719#05");
  }
  check_alive();
}

TEST_F(OiFrE5ncoCanopenBadFrames, CobIdsOfNeighboursAreNotOurs) {
  network();
  for (std::uint32_t id = 0; id <= 0x7ff; ++id) {
    const bool ours = id == 0x000 || id == 0x080 || id == 0x219 || id == 0x199 || id == 0x619 || id == 0x719;
    if (ours) continue;
    for (const bool remote : {false, true}) {
      for (const std::uint8_t length : {std::uint8_t{0}, std::uint8_t{8}}) {
        EXPECT_EQ(send(of(id, length, 1, remote)), "") << std::hex << id;
      }
    }
  }
  EXPECT_EQ(tell("000#8118"), "");  // a command to another node
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_EQ(tell("719#R1"), "719#05");
}

TEST_F(OiFrE5ncoCanopenBadFrames, EveryCommandByteHasOneAnswerOrIsAnAbort) {
  network();
  for (unsigned command = 0; command < 256; ++command) {
    frames.clear();
    receive_frame(sdo(command, 0x3007, 0, 60));
    advance(5ms);
    const unsigned specifier = command >> 5;
    const bool upload = specifier == 2, download = specifier == 1 && (command & 2) != 0;
    const std::size_t expected = specifier == 4 ? 0u : 1u;
    ASSERT_EQ(frames_of(0x599), expected) << command;
    if (expected == 0) continue;
    const std::string answer = text_of(frames[0].frame);
    if (upload) {
      EXPECT_EQ(answer.substr(0, 12), "599#4B073000") << command;
    } else if (download) {
      // Two bytes, or no length indicated.
      const bool right_length = (command & 1) == 0 || (command >> 2 & 3) == 2;
      EXPECT_EQ(answer, right_length ? "599#6007300000000000" : "599#8007300010000706") << command;
    } else {
      EXPECT_EQ(answer.substr(4, 2) + answer.substr(12), "8001000405") << command;
    }
  }
}

TEST_F(OiFrE5ncoCanopenBadFrames, InterleavedTransfersAreAnsweredEachForItself) {
  network();
  drive.ticks_to_decide = 10;
  EXPECT_EQ(tell("619#2B0730003C000000"), "");                      // a download that the inverter has yet to decide,
  EXPECT_EQ(tell("619#4000100000000000"), "599#4300100092010100");  // an upload in the middle takes its place
  EXPECT_EQ(wait(30ms), "");
  EXPECT_EQ(drive.parameters[7].value, 60u);
  EXPECT_EQ(tell("619#2B0730003D000000"), "");
  EXPECT_EQ(tell("619#0041424344454647"), "599#8000000001000405");  // a segment of a transfer that was never begun
  EXPECT_EQ(wait(30ms), "");
  EXPECT_EQ(tell("619#2107300008000000"), "599#8007300001000405");  // segmented: refused
  EXPECT_EQ(tell("619#2B0730003E000000"), "");                      // and the expedited one after it is taken
  EXPECT_EQ(wait(30ms), "599#6007300000000000");
  EXPECT_EQ(drive.parameters[7].value, 62u);
}

TEST_F(OiFrE5ncoCanopenBadFrames, AbortedTransfersLeaveNothingBehind) {
  network();
  EXPECT_EQ(tell("619#8000000000000405"), "");  // nothing to abort
  drive.ticks_to_decide = 10;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(tell("619#2B0730003C000000"), "");
    EXPECT_EQ(tell("619#8007300000000405"), "");
    wait(20ms);
  }
  drive.ticks_to_decide = 1;
  EXPECT_EQ(write(0x3007, 0, 63, 2), "ok");
  EXPECT_EQ(drive.parameters[7].value, 63u);
}

TEST_F(OiFrE5ncoCanopenBadFrames, FloodOfDownloadsIsRefusedAtTheLimitAndOverSoonAfter) {
  network();
  drive.ticks_to_decide = 3;
  constexpr std::size_t kLimit = boards::oi_fr_e5nco::WriteQueue::kCapacity;
  for (std::size_t i = 0; i < 1000; ++i) {
    // One is with the inverter, the others wait for it.
    EXPECT_EQ(tell("619#2B0730003C000000"), i < kLimit + 1 ? "" : "599#8007300022000008") << i;
  }
  EXPECT_EQ(tell("719#R1"), "719#05");
  wait(kLimit * 3ms + 10ms);
  EXPECT_EQ(drive.executed.size(), kLimit + 1);
  check_alive();
}

TEST_F(OiFrE5ncoCanopenBadFrames, FloodWhileTheControllerCannotSendIsBounded) {
  network();
  for (int i = 0; i < 10'000; ++i) {
    bus().handle_frame(now, sdo(0x40, 0x1000, 0));
    bus().handle_frame(now, can("719#R1"));
    bus().handle_frame(now, can("199#R8"));
    bus().handle_frame(now, can(i % 2 == 0 ? "219#" : "219#00000000"));
    if (i % 10 == 0) board->handle_drive_tick(now);
  }
  frames.clear();
  drain();
  EXPECT_EQ(frames_of(0x099), canopen::Slave::kMaxEmergencies);
  EXPECT_EQ(frames_of(0x199), 1u);
  EXPECT_EQ(frames_of(0x599), canopen::Slave::kMaxSdoAnswers);
  EXPECT_EQ(frames_of(0x719), 1u);
  check_alive();
}

TEST_F(OiFrE5ncoCanopenBadFrames, FloodsDoNotReachTheModbusSide) {
  network();
  for (int i = 0; i < 200; ++i) {
    for (int n = 0; n < 20; ++n) {
      tell("219#02008813");
      tell("619#2B0730003C000000");
      tell("319#");
      tell("719#R1");
    }
    if (i % 50 == 10) {
      sent.clear();
      receive(with_crc({25, 6, 0x4e, 0x22, 0, static_cast<std::uint8_t>(i)}));  // Pr.1
    }
    advance(1ms);
    if (i % 50 == 40) {
      ASSERT_EQ(sent.size(), 1u) << i;
      EXPECT_EQ(sent[0].bytes[1], 6) << i;
      EXPECT_EQ(drive.parameters[1].value, static_cast<std::uint32_t>(i - 30));
    }
  }
  check_alive();
}

}  // namespace
}  // namespace vinv::test
