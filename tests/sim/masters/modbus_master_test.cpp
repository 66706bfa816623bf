// Timed transcripts of the Modbus master: what it sends when, and what it makes of what comes.
#include "sim/masters/modbus_master.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::masters {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::adu;
using test::frame;
using test::to_hex;

constexpr Instant kStart = instant_from_ns(7'000'000'000);

struct Bench {
  explicit Bench(ModbusMasterSettings settings = {}) : master(settings) { master.handle_connected(now); }
  // Lets the time pass; what is sent on the way, with its time since kStart in us.
  std::vector<std::pair<long, std::string>> run(Duration d) {
    std::vector<std::pair<long, std::string>> sent;
    const Instant end = now + d;
    for (;;) {
      while (const auto f = master.poll_transmit(now)) sent.emplace_back((now - kStart) / microseconds(1), to_hex(*f));
      const auto next = master.next_deadline();
      if (!next || *next > end) break;
      EXPECT_GT(*next, now) << "a deadline that does not pass";
      if (*next <= now) break;
      now = *next;
      master.handle_timeout(now);
    }
    now = end;
    master.handle_timeout(now);
    return sent;
  }
  void hear(const Bytes& bytes, bool line_error = false) { master.handle_bytes(now, bytes, line_error); }
  // The next result as text: "[1388]" or the failure.
  std::string result() {
    const auto r = master.poll_result();
    if (!r) return "none";
    attempts = r->attempts;
    if (!r->answer) return text_of(r->answer.error());
    std::string text = "[";
    for (const std::uint16_t v : *r->answer) text += (text.size() > 1 ? " " : "") + std::to_string(v);
    return text + "]";
  }
  ModbusMaster master;
  Instant now = kStart;
  unsigned attempts = 0;
};

using Sent = std::vector<std::pair<long, std::string>>;

ModbusMasterSettings tcp() {
  ModbusMasterSettings s;
  s.framing = ModbusFraming::kTcp;
  s.retries = 0;
  return s;
}

// 9600 baud, 10 bits: a character takes 1041.66 us, 3.5 characters 3645 us.
TEST(ModbusMasterRtu, WaitsForTheSilenceBeforeItsFirstFrame) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::read(5, 23100, 3));
  EXPECT_EQ(b.run(milliseconds(10)), (Sent{{3645, to_hex(frame("05 03 5A 3C 00 03"))}}));
}

TEST(ModbusMasterRtu, AnswerEndsWithTheSilenceAndTheNextRequestFollows) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::read(5, 23100, 3));
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  b.hear(frame("05 03 06 13 88 00 64 0F A0"));
  EXPECT_EQ(b.result(), "none");
  EXPECT_EQ(b.run(milliseconds(10)), (Sent{{23645, to_hex(frame("05 06 5D C0 00 02"))}}));
  EXPECT_EQ(b.result(), "[5000 100 4000]");
  EXPECT_EQ(b.attempts, 1u);
}

TEST(ModbusMasterRtu, AnswerMayComeInPieces) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  const Bytes answer = frame("05 06 5D C0 00 02");
  for (const std::uint8_t byte : answer) {
    b.run(microseconds(1100));
    b.hear({byte});
  }
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "[2]");
}

TEST(ModbusMasterRtu, AsksAgainAfterTheTimeoutAndReportsAfterTheLastAttempt) {
  ModbusMasterSettings s;
  s.timeout = milliseconds(100);
  s.retries = 2;
  Bench b(s);
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  // 8 characters are 8333 us on the line; the time-out runs from the last.
  const std::string hex = to_hex(frame("05 03 5D C0 00 01"));
  EXPECT_EQ(b.run(milliseconds(400)), (Sent{{3645, hex}, {111979, hex}, {220312, hex}}));
  EXPECT_EQ(b.result(), "no answer");
  EXPECT_EQ(b.attempts, 3u);
}

TEST(ModbusMasterRtu, DamagedAnswerIsAskedForAgainAtOnce) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  Bytes broken = frame("05 06 5D C0 00 02");
  broken[3] ^= 4;
  b.hear(broken);
  EXPECT_EQ(b.run(milliseconds(20)), (Sent{{23645, to_hex(frame("05 06 5D C0 00 02"))}}));
  b.hear(frame("05 06 5D C0 00 02"));
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "[2]");
  EXPECT_EQ(b.attempts, 2u);
}

TEST(ModbusMasterRtu, DamageThatStaysIsReportedAsSuch) {
  ModbusMasterSettings s;
  s.retries = 1;
  Bench b(s);
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  for (int i = 0; i < 2; ++i) {
    b.run(milliseconds(20));
    b.hear(frame("05 06 5D C0 00 02"), true);
  }
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "damaged answer");
}

TEST(ModbusMasterRtu, AnswerOfAnotherUnitDoesNotEndTheWaiting) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  b.hear(frame("06 06 5D C0 00 02"));
  EXPECT_EQ(b.run(milliseconds(20)), Sent{});
  b.hear(frame("05 06 5D C0 00 02"));
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "[2]");
  EXPECT_EQ(b.attempts, 1u);
}

TEST(ModbusMasterRtu, ExceptionIsAnAnswer) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  b.hear(frame("05 86 05"));
  EXPECT_EQ(b.run(milliseconds(600)), Sent{});
  EXPECT_EQ(b.result(), "exception 05");
  EXPECT_EQ(b.attempts, 1u);
}

TEST(ModbusMasterRtu, EchoOfAnotherValueIsAWrongAnswer) {
  ModbusMasterSettings s;
  s.retries = 0;
  Bench b(s);
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 2));
  b.run(milliseconds(20));
  b.hear(frame("05 06 5D C0 00 03"));
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "an answer that does not fit the request");
}

TEST(ModbusMasterRtu, BroadcastIsNotAnsweredAndTheLineRests) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::write(kModbusBroadcast, 24000, 1));
  b.master.submit(b.now, ModbusRequest::write(5, 24000, 1));
  // 3645 + 8333 + 100 ms.
  EXPECT_EQ(b.run(milliseconds(200)),
            (Sent{{3645, to_hex(frame("00 06 5D C0 00 01"))}, {111979, to_hex(frame("05 06 5D C0 00 01"))}}));
  EXPECT_EQ(b.result(), "[1]");
}

TEST(ModbusMasterRtu, SpeaksDiagnosticsAndSeveralRegisters) {
  Bench b;
  b.master.submit(b.now, ModbusRequest::diagnose(5, 0, 0xA537));
  EXPECT_EQ(b.run(milliseconds(20)).front().second, to_hex(frame("05 08 00 00 A5 37")));
  b.hear(frame("05 08 00 00 A5 37"));
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "[42295]");
  b.master.submit(b.now, ModbusRequest::write_several(5, 1, {10, 258}));
  EXPECT_EQ(b.run(milliseconds(20)).front().second, to_hex(frame("05 10 00 01 00 02 04 00 0A 01 02")));
  b.hear(frame("05 10 00 01 00 02"));
  b.run(milliseconds(4));
  EXPECT_EQ(b.result(), "[10 258]");
}

TEST(ModbusMasterRtu, CyclesKeepTheirIntervalAndAreNeverQueuedTwice) {
  ModbusMasterSettings s;
  s.timeout = milliseconds(50);
  s.retries = 0;
  Bench b(s);
  const auto cycle = b.master.add_cycle(b.now, ModbusRequest::read(5, 24000), milliseconds(20));
  ASSERT_TRUE(cycle.has_value());
  // Nobody answers: 58.3 ms each, so that two of three turns fall out.
  const auto sent = b.run(milliseconds(200));
  ASSERT_EQ(sent.size(), 4u);
  EXPECT_EQ(sent[0].first, 3645);
  EXPECT_EQ(sent[1].first, 80000);
  EXPECT_EQ(sent[2].first, 140000);
  b.run(milliseconds(60));
  for (int i = 0; i < 3; ++i) {
    const auto r = b.master.poll_result();
    ASSERT_TRUE(r.has_value());
    EXPECT_EQ(r->cycle, cycle);
  }
}

TEST(ModbusMasterRtu, QueueHasALimit) {
  Bench b;
  for (std::size_t i = 0; i < ModbusMaster::kMaxWaiting; ++i)
    EXPECT_TRUE(b.master.submit(b.now, ModbusRequest::read(5, 24000)).has_value());
  EXPECT_FALSE(b.master.submit(b.now, ModbusRequest::read(5, 24000)).has_value());
}

TEST(ModbusMasterTcp, NumbersItsTransactionsAndTakesAnswersInPieces) {
  Bench b(tcp());
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{{0, to_hex(adu(1, 5, "03 5D C0 00 01"))}}));
  const Bytes answer = adu(1, 5, "03 02 80 00");
  b.hear(Bytes(answer.begin(), answer.begin() + 5));
  b.run(milliseconds(1));
  b.hear(Bytes(answer.begin() + 5, answer.end()));
  EXPECT_EQ(b.result(), "[32768]");
  b.master.submit(b.now, ModbusRequest::read(5, 24002));
  EXPECT_EQ(b.run(milliseconds(1)).front().second, to_hex(adu(2, 5, "03 5D C2 00 01")));
}

TEST(ModbusMasterTcp, LateAnswerOfAnEarlierTransactionIsDropped) {
  ModbusMasterSettings s = tcp();
  s.timeout = milliseconds(100);
  Bench b(s);
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  b.run(milliseconds(150));
  EXPECT_EQ(b.result(), "no answer");
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  b.run(milliseconds(10));
  b.hear(adu(1, 5, "03 02 00 01"));
  EXPECT_EQ(b.result(), "none");
  b.hear(adu(2, 5, "03 02 00 02"));
  EXPECT_EQ(b.result(), "[2]");
}

TEST(ModbusMasterTcp, HeaderThatIsNoModbusAsksToCloseTheConnection) {
  Bench b(tcp());
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  b.run(milliseconds(1));
  b.hear(test::from_hex("00 01 00 07 00 05 05 03 02 00 00"));
  EXPECT_TRUE(b.master.close_requested());
}

TEST(ModbusMasterTcp, EndOfTheConnectionFailsWhatWaitsAndWhatComesAfter) {
  Bench b(tcp());
  b.master.submit(b.now, ModbusRequest::read(5, 24000));
  b.master.submit(b.now, ModbusRequest::read(5, 24002));
  b.run(milliseconds(1));
  b.master.handle_disconnected();
  b.master.submit(b.now, ModbusRequest::read(5, 24004));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(b.result(), "no connection");
  EXPECT_EQ(b.result(), "none");
  EXPECT_EQ(b.run(milliseconds(1000)), Sent{});
}

TEST(ModbusMaster, ASavedSessionGoesOnTheSame) {
  Bench a;
  a.master.add_cycle(a.now, ModbusRequest::read(5, 24000), milliseconds(30));
  a.master.submit(a.now, ModbusRequest::write(5, 24000, 2));
  a.run(milliseconds(20));
  Bench b;
  b.now = a.now;
  ASSERT_TRUE(load_snapshot(b.master, save_snapshot(a.master)));
  for (Bench* bench : {&a, &b}) bench->hear(frame("05 06 5D C0 00 02"));
  EXPECT_EQ(a.run(milliseconds(700)), b.run(milliseconds(700)));
  EXPECT_EQ(a.result(), "[2]");
  EXPECT_EQ(b.result(), "[2]");
}

TEST(ModbusAnswer, OnlyWhatFitsTheRequestIsTaken) {
  const auto verdict = [](const ModbusRequest& request, std::string_view pdu) {
    const auto answer = parse_answer(request, test::from_hex(pdu));
    return answer ? std::string("ok") : text_of(answer.error());
  };
  const std::string wrong = "an answer that does not fit the request";
  const auto read = ModbusRequest::read(5, 100, 2);
  EXPECT_EQ(verdict(read, "03 04 00 01 00 02"), "ok");
  for (const char* pdu :
       {"", "03", "03 04 00 01 00", "03 02 00 01", "03 04 00 01 00 02 00", "06 00 64 00 01", "86 02", "83"})
    EXPECT_EQ(verdict(read, pdu), wrong) << pdu;
  EXPECT_EQ(verdict(read, "83 0B"), "exception 0B");
  const auto several = ModbusRequest::write_several(5, 100, {1, 2});
  EXPECT_EQ(verdict(several, "10 00 64 00 02"), "ok");
  EXPECT_EQ(verdict(several, "10 00 64 00 03"), wrong);
  EXPECT_EQ(verdict(several, "10 00 65 00 02"), wrong);
}

}  // namespace
}  // namespace vinv::masters
