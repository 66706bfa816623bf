// RTU framing as timed transcripts. MODBUS over Serial Line V1.02: 2.2, 2.4.2, 2.5.1.
#include "option_boards/modbus/rtu_server.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "sim/base/random.hpp"
#include "tests/option_boards/modbus/scripted_unit.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::modbus {
namespace {

using namespace std::chrono_literals;
using test::frame;
using test::from_hex;
using test::to_hex;

constexpr ClientId kClient = 7;

TEST(SilentIntervals, FollowTheBaudRateUpTo19200AndAreFixedAbove) {
  EXPECT_EQ(silent_intervals(9600, 10).character, 1041666ns);
  EXPECT_EQ(silent_intervals(9600, 10).t1_5, 1562500ns);
  EXPECT_EQ(silent_intervals(9600, 10).t3_5, 3645833ns);
  EXPECT_EQ(silent_intervals(9600, 11).t3_5, 4010416ns);
  EXPECT_EQ(silent_intervals(1200, 11).t3_5, 32083333ns);
  EXPECT_EQ(silent_intervals(19200, 11).t3_5, 2005208ns);
  EXPECT_EQ(silent_intervals(38400, 10).t1_5, 750us);
  EXPECT_EQ(silent_intervals(38400, 10).t3_5, 1750us);
  EXPECT_EQ(silent_intervals(38400, 10).character, 260416ns);
}

// One line at 19200 baud, 11 bits: character 572.9 us, t1.5 859.4 us, t3.5 2.005 ms. Time starts away from zero.
class RtuServerTest : public ::testing::Test {
 protected:
  RtuServerTest() {
    server.add_unit(unit);
    open({.baud = 19200, .bits_per_character = 11});
  }

  void open(const RtuServer::Settings& settings) {
    server.start(now, settings);
    advance(100ms);
  }
  // Lets time pass from deadline to deadline; what is sent meanwhile is kept.
  void advance(Duration by) {
    const Instant end = now + by;
    while (const auto at = server.next_deadline()) {
      if (*at > end) break;
      now = std::max(now, *at);
      server.handle_timeout(now);
      drain();
    }
    now = end;
    drain();
  }
  void drain() {
    while (auto bytes = server.poll_transmit(now)) {
      sent = std::move(bytes);
      sent_at = now;
      ++frames_sent;
    }
  }
  void receive(const Bytes& bytes, bool line_error = false) {
    server.handle_bytes(now, bytes, line_error);
    drain();
  }
  // Each byte when its last bit is over, gap of silence between them.
  void receive_slowly(const Bytes& bytes, Duration per_byte) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i != 0) advance(per_byte);
      receive({bytes[i]});
    }
  }

  Instant now = instant_from_ns(5'000'000'000);
  test::ScriptedUnit unit{25};
  RtuServer server{kClient};
  std::optional<Bytes> sent;
  Instant sent_at{};
  int frames_sent = 0;
  const Bytes request = frame("19 03 4E 20 00 02");
  const Duration character = silent_intervals(19200, 11).character;
  const Duration t3_5 = silent_intervals(19200, 11).t3_5;
};

TEST_F(RtuServerTest, AnswersWhenThreeAndAHalfCharactersOfSilenceHaveEndedTheFrame) {
  const Instant last_byte_at = now;
  receive(request);
  EXPECT_FALSE(sent);
  EXPECT_EQ(server.next_deadline(), last_byte_at + t3_5);
  advance(t3_5 - 1ns);
  EXPECT_FALSE(sent);
  EXPECT_TRUE(unit.asked.empty());
  advance(1ns);
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent_at, last_byte_at + t3_5);
  EXPECT_EQ(to_hex(*sent), to_hex(request));  // the unit echoes
  ASSERT_EQ(unit.asked.size(), 1u);
  EXPECT_EQ(unit.asked[0].client, kClient);
  EXPECT_EQ(to_hex(unit.asked[0].pdu), "03 4E 20 00 02");
  EXPECT_EQ(server.next_deadline(), std::nullopt);
}

TEST_F(RtuServerTest, TimeoutsBeforeTheDeadlineAreHarmless) {
  receive(request);
  server.handle_timeout(now);
  server.handle_timeout(now + 1ms);
  now += 1ms;
  EXPECT_FALSE(server.poll_transmit(now));
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, FrameMayComeByteByByteWithoutSilence) {
  receive_slowly(request, character);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, FrameMayComeInTwoChunksWhoseCharactersFillTheGap) {
  receive({request.begin(), request.begin() + 3});
  advance(5 * character);  // the clock cannot know what is still to come: 3.5 characters without one end the frame
  receive({request.begin() + 3, request.end()});
  advance(10ms);
  EXPECT_EQ(frames_sent, 0);

  receive({request.begin(), request.begin() + 5});
  advance(3 * character);
  receive({request.begin() + 5, request.end()});
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, OneAndAHalfCharactersOfSilenceInsideAFrameMakeItVoid) {
  const Duration t1_5 = silent_intervals(19200, 11).t1_5;
  receive_slowly(request, t1_5);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
  receive_slowly(request, t1_5 + 1ns);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
  EXPECT_EQ(unit.asked.size(), 1u);
}

TEST_F(RtuServerTest, TwoFramesWithoutSilenceBetweenThemAreOneBadFrame) {
  Bytes both = request;
  both.insert(both.end(), request.begin(), request.end());
  receive(both);
  advance(10ms);
  EXPECT_EQ(frames_sent, 0);
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, FrameThatEndedBeforeTheTimeoutWasCalledIsSeparateFromTheNextBytes) {
  receive(request);
  now += t3_5;  // the owner was late: bytes come before handle_timeout
  server.handle_bytes(now, Bytes{0xff}, false);
  EXPECT_EQ(unit.asked.size(), 1u);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, OneBytePerSecondIsNeverAFrameAndDelaysNothing) {
  receive_slowly(request, 1s);
  advance(1s);
  EXPECT_EQ(frames_sent, 0);
  receive(request);
  advance(t3_5);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, WrongCrcOtherUnitAndWrongLengthAreSilence) {
  Bytes wrong_crc = request;
  wrong_crc.back() ^= 1;
  const Bytes too_short = test::with_crc({0x19});
  const Bytes too_long = test::with_crc(Bytes(255, 0x19));
  for (const Bytes& bytes : {wrong_crc, frame("1A 03 4E 20 00 02"), too_short, Bytes{0x19}, too_long, Bytes(5000, 0)}) {
    receive(bytes);
    advance(10ms);
  }
  EXPECT_EQ(frames_sent, 0);
  EXPECT_TRUE(unit.asked.empty());
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, LongestFrameIsTwoHundredFiftySixBytes) {
  Bytes longest(254, 0x55);
  longest[0] = 0x19;
  longest = test::with_crc(longest);
  receive(longest);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
  ASSERT_EQ(unit.asked.size(), 1u);
  EXPECT_EQ(unit.asked[0].pdu.size(), 253u);
}

TEST_F(RtuServerTest, LineErrorVoidsTheFrameItTouches) {
  receive(request, true);
  advance(10ms);
  receive({request.begin(), request.begin() + 4}, true);
  receive({request.begin() + 4, request.end()});
  advance(10ms);
  receive({}, true);  // a break
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 0);
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, BroadcastReachesEveryListeningUnitAndIsNotAnswered) {
  test::ScriptedUnit second{26}, off{0};
  server.add_unit(second);
  server.add_unit(off);
  receive(frame("00 06 65 90 00 01"));
  advance(100ms);
  EXPECT_EQ(frames_sent, 0);
  ASSERT_EQ(unit.asked.size(), 1u);
  EXPECT_EQ(unit.asked[0].addressing, Addressing::kBroadcast);
  EXPECT_EQ(second.asked.size(), 1u);
  EXPECT_TRUE(off.asked.empty());
  receive(frame("1A 06 65 90 00 01"));
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
  EXPECT_EQ(second.asked.size(), 2u);
}

TEST_F(RtuServerTest, AnswerDelayRunsFromTheDecision) {
  open({.baud = 19200, .bits_per_character = 11, .answer_delay = 3ms});
  const Instant end_of_request = now + t3_5;
  receive(request);
  advance(20ms);
  ASSERT_EQ(frames_sent, 1);
  EXPECT_EQ(sent_at, end_of_request + 3ms);

  unit.answer_at_once = false;
  receive(request);
  advance(10ms);
  unit.decide();
  const Instant decided_at = now;
  drain();
  EXPECT_EQ(frames_sent, 1);
  advance(20ms);
  ASSERT_EQ(frames_sent, 2);
  EXPECT_EQ(sent_at, decided_at + 3ms);
}

TEST_F(RtuServerTest, AnswerComesWhenTheUnitHasDecided) {
  unit.answer_at_once = false;
  receive(request);
  advance(40ms);
  EXPECT_EQ(frames_sent, 0);
  unit.decide();
  drain();
  EXPECT_EQ(frames_sent, 1);
  EXPECT_EQ(sent_at, now);
}

TEST_F(RtuServerTest, FrameThatArrivesWhileAnAnswerIsPreparedIsDroppedAndTheAnswerWaitsForSilence) {
  unit.answer_at_once = false;
  receive(request);
  advance(10ms);
  const Bytes impatient = frame("19 03 4E 20 00 09");
  receive(impatient);
  unit.decide();
  drain();
  EXPECT_EQ(frames_sent, 0);  // the line is not silent
  const Instant last_byte_at = now;
  advance(10ms);
  ASSERT_EQ(frames_sent, 1);
  EXPECT_EQ(sent_at, last_byte_at + t3_5);
  EXPECT_EQ(to_hex(*sent), to_hex(request));
  EXPECT_EQ(unit.asked.size(), 1u);
  unit.answer_at_once = true;
  receive(impatient);
  advance(10ms);
  EXPECT_EQ(frames_sent, 2);
}

TEST_F(RtuServerTest, FirstFrameNeedsSilenceAfterTheLineOpened) {
  server.start(now, {.baud = 19200, .bits_per_character = 11});
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 0);
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, ClosedLineHearsAndSaysNothingAndForgetsItsRequest) {
  unit.answer_at_once = false;
  receive(request);
  advance(10ms);
  server.stop();
  EXPECT_EQ(unit.forgotten, std::vector<ClientId>{kClient});
  unit.decide();
  receive(request);
  advance(1s);
  EXPECT_EQ(frames_sent, 0);
  EXPECT_EQ(server.next_deadline(), std::nullopt);
}

TEST_F(RtuServerTest, UnitThatStopsListeningLeavesTheLineFree) {
  unit.answer_at_once = false;
  receive(request);
  advance(10ms);
  unit.address_ = 0;
  advance(10ms);
  unit.address_ = 25;
  unit.answer_at_once = true;
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, RequestThatTheUnitLostLeavesTheLineFree) {
  unit.answer_at_once = false;
  receive(request);
  advance(10ms);
  unit.outstanding.clear();  // off and on again before anybody asked
  drain();
  unit.answer_at_once = true;
  receive(request);
  advance(10ms);
  EXPECT_EQ(frames_sent, 1);
}

TEST_F(RtuServerTest, ReceiveSlackBridgesTheBurstsOfARealTty) {
  open({.baud = 19200, .bits_per_character = 11, .receive_slack = 16ms});
  receive({request.begin(), request.begin() + 5});
  advance(16ms);
  receive({request.begin() + 5, request.end()});
  const Instant last_byte_at = now;
  advance(50ms);
  ASSERT_EQ(frames_sent, 1);
  EXPECT_EQ(sent_at, last_byte_at + t3_5 + 16ms);
}

TEST_F(RtuServerTest, EverySplitIntoTwoChunksAtOneTimeGivesTheSameAnswer) {
  for (std::size_t cut = 0; cut <= request.size(); ++cut) {
    const auto middle = request.begin() + static_cast<std::ptrdiff_t>(cut);
    receive({request.begin(), middle});
    receive({middle, request.end()});
    advance(10ms);
    ASSERT_EQ(frames_sent, static_cast<int>(cut) + 1);
  }
}

TEST_F(RtuServerTest, AnswersAGoodFrameAfterAnyNoise) {
  Random random(11);
  for (int round = 0; round < 300; ++round) {
    for (std::uint64_t chunk = random.below(6); chunk > 0; --chunk) {
      Bytes noise(random.below(300));
      for (auto& byte : noise) byte = static_cast<std::uint8_t>(random.below(256));
      receive(noise, random.below(8) == 0);
      advance(Duration{static_cast<std::int64_t>(random.below(4'000'000))});
    }
    advance(10ms);
    const int before = frames_sent;
    receive(request);
    advance(10ms);
    ASSERT_EQ(frames_sent, before + 1) << round;
  }
}

}  // namespace
}  // namespace vinv::modbus
