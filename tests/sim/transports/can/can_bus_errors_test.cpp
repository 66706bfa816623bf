// Fault confinement on the bus: missing acknowledges, collisions, other bit rates, bus off.
#include <gtest/gtest.h>

#include "sim/transports/can/wire_format.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"

namespace vinv::transports {
namespace {

using std::chrono::milliseconds;

class ErrorLog : public CanBusObserver {
 public:
  void on_frame(Instant, const CanFrame&, std::string_view) override { text += "frame "; }
  void on_error_frame(Instant at, CanErrorCause cause, std::string_view sender) override {
    const char* names[] = {"no-ack", "corrupted", "error-frame", "collision", "bitrate"};
    text += us(at) + ":" + names[static_cast<int>(cause)] + "(" + std::string(sender) + ") ";
  }
  std::string text;
};

TEST(CanBusErrors, ALoneTransmitterBecomesPassiveAndNotBusOff) {
  BusBench b;
  const auto errors = std::make_shared<ErrorLog>();
  b.bus->observe(errors);
  auto& a = b.add("a");
  a.node->send(b.now(), CanFrame::standard(0x705, {0}));
  b.run_to_us(60'000'000);
  EXPECT_EQ(a.node->status().state, CanState::kErrorPassive);
  EXPECT_EQ(a.node->status().counters, (CanErrorCounters{128, 0}));
  EXPECT_EQ(a.node->status().sent, 0u);
  // Attempts of an active node: bits to the ACK slot, flag, delimiter, intermission.
  const auto to_ack = can_wire_bits(CanFrame::standard(0x705, {0})).count + 2;
  const auto active_us = (to_ack + 6 + 8 + 3) * 8;
  EXPECT_EQ(a.log, us(b.start + std::chrono::microseconds(11 * active_us + (to_ack + 14) * 8)) + " error warning\n" +
                       us(b.start + std::chrono::microseconds(15 * active_us + (to_ack + 14) * 8)) +
                       " error passive\n");
  EXPECT_EQ(errors->text, us(b.start + std::chrono::microseconds((to_ack + 14) * 8)) + ":no-ack(a) ");
  // 16 active attempts, then passive ones, each 8 bits longer, one after the other for the rest of the minute.
  const double expected = 16 + (60e6 - 16.0 * active_us) / (active_us + 64);
  EXPECT_NEAR(static_cast<double>(b.stats().error_frames), expected, 1.01);
  EXPECT_NEAR(b.stats().load.last_second, 1.0, 0.01);
  // Nothing changes any more, so the minute cost a handful of events.
  EXPECT_LT(b.scheduler.events_run(), 50u);
}

TEST(CanBusErrors, WhatWaitsOnAnUnattendedBusIsSentWhenTheFirstOtherNodeComes) {
  const CanFrame boot = CanFrame::standard(0x705, {0});
  const auto to_ack = can_wire_bits(boot).count + 2;
  const auto period_us = static_cast<std::int64_t>(to_ack + 14 + 3 + 8) * 8;
  // At every phase of the attempt that is under way.
  for (std::int64_t phase = 0; phase < period_us; phase += 20) {
    BusBench b;
    auto& a = b.add("a");
    a.node->send(b.now(), boot);
    a.node->send(b.now(), CanFrame::standard(0x085, {1}));
    b.run_to_us(1'000'000 + phase);
    auto& master = b.add("master");
    b.run_to_us(1'100'000);
    EXPECT_NE(master.log.find("705#00\n"), std::string::npos) << phase;
    EXPECT_NE(master.log.find("085#01\n"), std::string::npos) << phase;
    const std::int64_t heard_us = std::stoll(master.log.substr(0, master.log.find(' '))) - 2'000'000 - phase;
    // At most the rest of one attempt, one pause, and the frame.
    EXPECT_LE(heard_us, period_us + static_cast<std::int64_t>(can_wire_bits(boot).frame_bits()) * 8) << phase;
    EXPECT_EQ(a.node->status().counters.tec, 126) << phase;
    EXPECT_EQ(a.node->status().state, CanState::kErrorWarning) << phase;
    EXPECT_EQ(b.stats().frames, 2u);
  }
}

// A live bus on which nothing happens has no events, and the clock of its scheduler stands still meanwhile.
TEST(CanBusErrors, TheFirstOtherNodeMayComeLongAfterTheLastEvent) {
  BusBench b;
  auto& a = b.add("a");
  a.node->send(b.now(), CanFrame::standard(0x705, {0}));
  b.run_to_us(1'000'000);
  ASSERT_FALSE(b.scheduler.next_event_at());
  const Instant late = b.now() + std::chrono::seconds(10);
  const auto master = b.bus->attach(late, {});
  EXPECT_GE(*b.scheduler.next_event_at(), late);
  b.scheduler.run_until(late + milliseconds(10));
  EXPECT_EQ(master->status().received, 1u);
  EXPECT_NEAR(b.bus->stats(b.now()).load.total, 1.0, 0.01);
}

TEST(CanBusErrors, ALoneNodeTakesItsAttemptsWithIt) {
  BusBench b;
  auto& a = b.add("a");
  a.node->send(b.now(), CanFrame::standard(0x705, {0}));
  b.run_to_us(1'000'000);
  a.node.reset();
  b.run_to_us(2'000'000);
  auto& c = b.add("c");
  auto& d = b.add("d");
  c.node->send(b.now(), CanFrame::standard(1, {}));
  b.run_to_us(2'100'000);
  EXPECT_EQ(d.node->status().received, 1u);
  EXPECT_EQ(b.stats().nodes, 2u);
  EXPECT_NEAR(b.stats().load.total, 1.0 / 2.1, 0.01);
}

// The short cut for the lone node must not change what happens: with and without somebody who keeps it from being taken
// (a node on its way back from bus off that never gets there counts as such).
TEST(CanBusErrors, TheUneventfulWaitIsTheSameAsAttemptAfterAttempt) {
  const auto run = [](bool uneventful) {
    BusBench b;
    auto& a = b.add("a");
    CanNodeOptions off;
    off.name = "off";
    auto& c = b.add(off);
    if (uneventful)
      c.node->set_online(b.now(), false);
    else
      c.node->force_bus_off(b.now());
    for (std::uint8_t i = 0; i < 3; ++i) a.node->send(b.now(), CanFrame::standard(0x701, {i}));
    b.run_to_us(90'000);  // 128 x 11 bits take 11 ms of idle bus: meanwhile the other returns
    if (uneventful) c.node->set_online(b.now(), true);
    b.run_to_us(200'000);
    return std::pair(a.node->status().sent, a.node->status().counters.tec);
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(CanBusErrors, AListenOnlyNodeHearsButDoesNotAcknowledge) {
  BusBench b;
  auto& a = b.add("a");
  CanNodeOptions options;
  options.name = "sniffer";
  options.listen_only = true;
  auto& sniffer = b.add(options);
  a.node->send(b.now(), CanFrame::standard(1, {}));
  b.run_to_us(100'000);
  EXPECT_EQ(sniffer.log, "");
  EXPECT_EQ(a.node->status().state, CanState::kErrorPassive);
  EXPECT_EQ(sniffer.node->send(b.now(), CanFrame::standard(2, {})), CanSend::kRefusedState);
  b.add("c");
  b.run_to_us(200'000);
  EXPECT_NE(sniffer.log.find("001#\n"), std::string::npos);
  sniffer.node->set_listen_only(b.now(), false);
  EXPECT_EQ(sniffer.node->send(b.now(), CanFrame::standard(2, {})), CanSend::kQueued);
}

TEST(CanBusErrors, TheSameFrameOfTwoNodesIsOneFrame) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  auto& listener = b.add("listener");
  a.node->send(b.now(), CanFrame::standard(0x705, {0}));
  c.node->send(b.now(), CanFrame::standard(0x705, {0}));
  b.run_to_us(100'000);
  EXPECT_EQ(listener.node->status().received, 1u);
  EXPECT_EQ(a.node->status().sent, 1u);
  EXPECT_EQ(c.node->status().sent, 1u);
  EXPECT_EQ(a.node->status().received, 0u);
}

// Two devices with one node number that answer differently: no winner in arbitration, the first different bit breaks
// both.
TEST(CanBusErrors, DifferentFramesWithOneIdentifierEndInBusOff) {
  BusBench b;
  const auto errors = std::make_shared<ErrorLog>();
  b.bus->observe(errors);
  CanNodeOptions options;
  options.recovers = false;
  options.name = "a";
  auto& a = b.add(options);
  options.name = "c";
  auto& c = b.add(options);
  auto& listener = b.add("listener");
  a.node->send(b.now(), CanFrame::standard(0x585, {0x4b, 1}));
  c.node->send(b.now(), CanFrame::standard(0x585, {0x4b, 2}));
  b.run_to_us(100'000);
  EXPECT_EQ(a.node->status().state, CanState::kBusOff);
  EXPECT_EQ(c.node->status().state, CanState::kBusOff);
  EXPECT_EQ(listener.node->status().received, 0u);
  EXPECT_EQ(listener.node->status().counters.rec, 32);
  EXPECT_EQ(b.stats().error_frames, 32u);
  // SOF, identifier, RTR, IDE, r0 and DLC are 19 bits and a stuff bit, 4B is 8, and of 000000(01|10) the seventh bit
  // differs, with a stuff bit after the fifth: bit 36. Then two flags and the delimiter.
  const std::string first = errors->text.substr(0, errors->text.find(' '));
  EXPECT_EQ(first, us(b.start + std::chrono::microseconds((36 + 12 + 8) * 8)) + ":collision(a)");
}

TEST(CanBusErrors, ANodeWithAnotherBitRateDisturbsUntilItIsPassiveAndHearsNothing) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  CanNodeOptions options;
  options.name = "wrong";
  options.bitrate = 250'000;
  auto& wrong = b.add(options);
  a.node->send(b.now(), CanFrame::standard(0x123, {1, 2, 3}));
  b.run_to_us(100'000);
  EXPECT_EQ(wrong.node->status().state, CanState::kErrorPassive);
  EXPECT_EQ(wrong.node->status().received, 0u);
  EXPECT_EQ(c.node->status().received, 1u);
  EXPECT_EQ(b.stats().error_frames, 15u);  // 15 x 9 = 135
  EXPECT_EQ(a.node->status().counters.tec, 15 * 8 - 1);
  EXPECT_EQ(c.node->status().counters.rec, 15 - 1);
  // From now on it is deaf and does no harm.
  a.node->send(b.now(), CanFrame::standard(0x124, {}));
  b.run_to_us(200'000);
  EXPECT_EQ(c.node->status().received, 2u);
  EXPECT_EQ(b.stats().error_frames, 15u);
  // With the right rate it takes part.
  EXPECT_TRUE(wrong.node->set_bitrate(b.now(), 125'000));
  EXPECT_EQ(wrong.node->status().state, CanState::kErrorActive);
  a.node->send(b.now(), CanFrame::standard(0x125, {}));
  b.run_to_us(300'000);
  EXPECT_EQ(wrong.node->status().received, 1u);
  EXPECT_FALSE(wrong.node->set_bitrate(b.now(), 0));
}

TEST(CanBusErrors, WhatANodeWithAnotherBitRateSendsIsDestroyedUntilItIsBusOff) {
  BusBench b;
  auto& a = b.add("a");
  CanNodeOptions options;
  options.name = "wrong";
  options.bitrate = 500'000;
  options.recovers = false;
  auto& wrong = b.add(options);
  wrong.node->send(b.now(), CanFrame::standard(0x123, {1}));
  b.run_to_us(100'000);
  EXPECT_EQ(wrong.node->status().state, CanState::kBusOff);
  EXPECT_EQ(a.node->status().received, 0u);
  EXPECT_EQ(a.node->status().counters.rec, 32);
}

TEST(CanBusErrors, BusOffEndsAfterItsRecessiveBits) {
  BusBench b;
  auto& a = b.add("a");
  b.add("c");
  a.node->send(b.now(), CanFrame::standard(1, {}));
  a.node->force_bus_off(b.now());
  EXPECT_EQ(a.node->status().lost, 1u);
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  b.run_to_us(100'000);
  // 128 x 11 bits of 8 us on an idle bus.
  EXPECT_EQ(a.log, "1000000 bus off\n1011264 error active\n");
  EXPECT_EQ(a.node->status().counters, CanErrorCounters{});
}

TEST(CanBusErrors, AFrameThatBeginsWithinTheLastBitOfRecoveryEndsThatSequence) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  b.run_to_us(1'000);
  a.node->force_bus_off(b.now());
  a.log.clear();
  // 128 x 11 bits of 8 us are over at 12264 us; 4 us before, a frame of 50 bits begins.
  b.run_to_us(12'260);
  b.add("d").node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(13'000);
  EXPECT_NE(c.log.find("1012660 000#"), std::string::npos) << c.log;
  EXPECT_EQ(a.log, "1012684 error active\n");  // 11 recessive bits: 8 of the frame's end, 3 of intermission
}

TEST(CanBusErrors, AnErrorFrameThatAHandlerAsksForFollowsWhatHasEnded) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  c.node->set_handlers({[&](Instant now, const CanFrame&) { b.bus->inject_error_frame(now); }, {}, {}});
  auto& d = b.add("d");
  a.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(5'000);
  EXPECT_EQ(a.log, "1000400 sent 000#\n");
  EXPECT_EQ(d.log, "1000400 000#\n");
  EXPECT_EQ(b.stats().error_frames, 1u);
  EXPECT_EQ(b.stats().frames, 1u);
}

TEST(CanBusErrors, OnABusyBusEveryFrameEndIsOneSequenceOfRecessiveBits) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  b.add("d");
  c.node->set_handlers({{}, [&](Instant t, const CanFrame& f) { c.node->send(t, f); }, {}});
  c.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(100);
  a.node->force_bus_off(b.now());
  b.run_to_us(1'000'000);
  // Frames of 50 bits begin every 53 bits; each leaves 8 + 3 recessive bits, the 128th at the start of the 129th frame.
  const std::string expected =
      "1000100 bus off\n" + us(b.start + std::chrono::microseconds(128 * 53 * 8)) + " error active\n";
  EXPECT_EQ(a.log.substr(0, expected.size()), expected);
}

TEST(CanBusErrors, WithoutOwnRecoveryTheNodeWaitsToBeAsked) {
  BusBench b;
  CanNodeOptions options;
  options.name = "a";
  options.recovers = false;
  auto& a = b.add(options);
  b.add("c");
  a.node->force_bus_off(b.now());
  b.run_to_us(1'000'000);
  EXPECT_EQ(a.node->status().state, CanState::kBusOff);
  a.node->recover(b.now());
  b.run_to_us(1'011'264);
  EXPECT_EQ(a.node->status().state, CanState::kErrorActive);
  a.node->recover(b.now());  // not bus off: nothing happens
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {})), CanSend::kQueued);
}

TEST(CanBusErrors, APassiveNodeLeavesEightBitsMoreToOthers) {
  BusBench b;
  auto& a = b.add("a");
  b.run_to_us(0);
  a.node->send(b.now(), CanFrame::standard(0x001, {}));
  b.run_to_us(200'000);
  ASSERT_EQ(a.node->status().state, CanState::kErrorPassive);
  auto& c = b.add("c");
  auto& d = b.add("d");
  b.run_to_us(300'000);
  a.node->force_bus_off(b.now());
  b.run_to_us(400'000);
  // Make it passive again in company: 17 corrupted attempts.
  CanFaultRule rule;
  rule.fault = CanFault::kCorrupt;
  rule.node = "a";
  rule.when.nth = 1;
  rule.times = 17;
  b.bus->set_faults({1, {rule}});
  a.node->send(b.now(), CanFrame::standard(0x001, {}));
  b.run_to_us(500'000);
  ASSERT_EQ(a.node->status().state, CanState::kErrorPassive);
  d.log.clear();
  a.node->send(b.now(), CanFrame::standard(0x001, {1}));
  a.node->send(b.now(), CanFrame::standard(0x001, {2}));
  b.run_to_us(500'100);
  c.node->send(b.now(), CanFrame::standard(0x700, {3}));  // lower priority, yet it comes between
  b.run_to_us(600'000);
  EXPECT_LT(d.log.find("700#03"), d.log.find("001#02"));
  EXPECT_LT(d.log.find("001#01"), d.log.find("700#03"));
}

TEST(CanBusErrors, AnInjectedErrorFrameDestroysWhatIsOnTheWireOrStandsAlone) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  const auto errors = std::make_shared<ErrorLog>();
  b.bus->observe(errors);
  b.bus->inject_error_frame(b.now());
  a.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(8 * (20 + 3) + 80);  // 12 bits of flags, 8 of delimiter, 3 of intermission; ten bits into the frame
  EXPECT_EQ(errors->text, "1000160:error-frame() ");
  EXPECT_EQ(c.node->status().counters.rec, 1);
  b.bus->inject_error_frame(b.now());
  b.run_to_us(10'000);
  EXPECT_EQ(b.stats().error_frames, 2u);
  EXPECT_EQ(b.stats().frames, 1u);
  EXPECT_EQ(a.node->status().counters, (CanErrorCounters{7, 1}));
  EXPECT_EQ(c.node->status().counters.rec, 1);  // 1 + 1 for the errors, one less for the frame
  b.bus->stop_observing(errors.get());
  b.bus->inject_error_frame(b.now());
  b.run_to_us(20'000);
  EXPECT_EQ(errors->text, "1000160:error-frame() " + us(b.start + std::chrono::microseconds((23 + 11 + 20) * 8)) +
                              ":error-frame(a) frame ");
}

}  // namespace
}  // namespace vinv::transports
