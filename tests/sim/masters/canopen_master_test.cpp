// Timed transcripts of the CANopen master: NMT, guarding, heartbeat, SYNC, EMCY, SDO, PDO.
#include "sim/masters/canopen_master.hpp"

#include <gtest/gtest.h>

#include "sim/masters/canopen_station.hpp"
#include "tests/option_boards/canopen/can_text.hpp"

namespace vinv::masters {
namespace {

using canopen::NmtState;
using std::chrono::milliseconds;
using test::can;

constexpr Instant kStart = instant_from_ns(7'000'000'000);
using Sent = std::vector<std::string>;

struct Bench {
  explicit Bench(const CanopenMasterSettings& settings = {}) : master(settings) { master.start(now); }
  // Frames sent on the way, with their time since kStart in ms.
  Sent run(Duration d) {
    Sent sent;
    const Instant end = now + d;
    for (;;) {
      while (const auto f = master.poll_transmit(now))
        sent.push_back(std::to_string((now - kStart) / milliseconds(1)) + " " + test::text_of(*f));
      const auto next = master.next_deadline();
      if (!next || *next > end) break;
      now = *next;
      master.handle_timeout(now);
    }
    now = end;
    return sent;
  }
  void hear(std::string_view text) { master.handle_frame(now, can(text)); }
  std::string event() {
    const auto e = master.poll_event();
    if (!e) return "none";
    const std::string node = std::to_string(e->node);
    switch (e->kind) {
      case CanopenEvent::Kind::kBootUp: return "boot-up " + node;
      case CanopenEvent::Kind::kState: return "state " + node + " " + std::to_string(static_cast<int>(e->state));
      case CanopenEvent::Kind::kGuardToggle: return "toggle " + node;
      case CanopenEvent::Kind::kGuardLost: return "lost " + node;
      case CanopenEvent::Kind::kGuardBack: return "back " + node;
      case CanopenEvent::Kind::kHeartbeatLost: return "heartbeat lost " + node;
      case CanopenEvent::Kind::kEmergency:
        return "emergency " + node + " " + std::to_string(e->emergency.error_code) + " " +
               std::to_string(e->emergency.error_register) + " " + std::to_string(e->emergency.manufacturer[0]);
      case CanopenEvent::Kind::kSdo:
        return e->sdo->value
                   ? "sdo " + std::to_string(e->sdo->value->raw) + " of " + std::to_string(e->sdo->value->size)
                   : text_of(e->sdo->value.error());
      case CanopenEvent::Kind::kPdo: return "pdo " + node + " " + test::text_of(e->pdo);
    }
    return {};
  }
  CanopenMaster master;
  Instant now = kStart;
};

TEST(CanopenMasterNmt, EveryCommandIsItsFrame) {
  Bench b;
  using canopen::NmtCommand;
  b.master.command(NmtCommand::kStart, 5);
  b.master.command(NmtCommand::kStop, 5);
  b.master.command(NmtCommand::kEnterPreOperational, 5);
  b.master.command(NmtCommand::kResetNode, 5);
  b.master.command(NmtCommand::kResetCommunication, 0);
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{"0 000#0105", "0 000#0205", "0 000#8005", "0 000#8105", "0 000#8200"}));
}

TEST(CanopenMasterNmt, BootUpIsSeen) {
  Bench b;
  EXPECT_EQ(b.master.state_of(5), NmtState::kOff);
  b.hear("705#00");
  EXPECT_EQ(b.event(), "boot-up 5");
  EXPECT_EQ(b.master.state_of(5), NmtState::kPreOperational);
}

TEST(CanopenMasterGuarding, AsksEachGuardTimeAndFollowsTheState) {
  Bench b;
  b.master.guard(b.now, 5, milliseconds(100), 3);
  EXPECT_EQ(b.run(milliseconds(50)), (Sent{"0 705#R1"}));
  b.hear("705#7F");
  EXPECT_EQ(b.event(), "state 5 127");
  EXPECT_EQ(b.run(milliseconds(100)), (Sent{"100 705#R1"}));
  b.hear("705#85");
  EXPECT_EQ(b.event(), "state 5 5");
  EXPECT_EQ(b.event(), "none");
}

TEST(CanopenMasterGuarding, ToggleBitThatStaysIsReported) {
  Bench b;
  b.master.guard(b.now, 5, milliseconds(100), 3);
  b.hear("705#05");
  b.event();
  b.hear("705#05");
  EXPECT_EQ(b.event(), "toggle 5");
  b.hear("705#85");
  EXPECT_EQ(b.event(), "none");
}

TEST(CanopenMasterGuarding, BootUpStartsTheToggleBitAnew) {
  Bench b;
  b.master.guard(b.now, 5, milliseconds(100), 3);
  b.hear("705#05");
  b.hear("705#00");
  b.hear("705#7F");
  EXPECT_EQ(b.event(), "state 5 5");
  EXPECT_EQ(b.event(), "boot-up 5");
  EXPECT_EQ(b.event(), "none");
}

TEST(CanopenMasterGuarding, LostOnceAfterTheLifeTimeAndBackWithTheNextAnswer) {
  Bench b;
  b.master.guard(b.now, 5, milliseconds(100), 3);
  b.hear("705#05");
  EXPECT_EQ(b.event(), "state 5 5");
  EXPECT_EQ(b.run(milliseconds(299)).size(), 3u);
  EXPECT_EQ(b.event(), "none");
  b.run(milliseconds(1));
  EXPECT_EQ(b.event(), "lost 5");
  EXPECT_EQ(b.run(milliseconds(1000)).size(), 10u) << "it goes on asking";
  EXPECT_EQ(b.event(), "none");
  b.hear("705#85");
  EXPECT_EQ(b.event(), "back 5");
  b.master.guard(b.now, 5, Duration{}, 1);
  EXPECT_EQ(b.run(milliseconds(1000)), Sent{});
  EXPECT_EQ(b.event(), "none");
}

TEST(CanopenMasterHeartbeat, IsWatchedFromTheFirstOneOn) {
  Bench b;
  b.master.watch_heartbeat(9, milliseconds(200));
  b.run(milliseconds(1000));
  EXPECT_EQ(b.event(), "none");
  b.hear("709#05");
  EXPECT_EQ(b.event(), "state 9 5");
  b.run(milliseconds(150));
  b.hear("709#05");
  b.run(milliseconds(199));
  EXPECT_EQ(b.event(), "none");
  b.run(milliseconds(1));
  EXPECT_EQ(b.event(), "heartbeat lost 9");
}

TEST(CanopenMasterHeartbeat, MasterSendsItsOwn) {
  CanopenMasterSettings s;
  s.heartbeat_interval = milliseconds(50);
  Bench b(s);
  EXPECT_EQ(b.run(milliseconds(100)), (Sent{"0 77F#05", "50 77F#05", "100 77F#05"}));
}

TEST(CanopenMasterSync, CarriesTheCyclicOutputsAheadOfIt) {
  CanopenMasterSettings s;
  s.sync_interval = milliseconds(10);
  Bench b(s);
  b.master.set_output(5, 1, 0, 2, 2);
  b.master.set_output(5, 1, 2, 2, 5000);
  EXPECT_EQ(b.run(milliseconds(10)), (Sent{"10 080#"}));
  b.master.send_output_cyclically(5, 1, true);
  EXPECT_EQ(b.run(milliseconds(10)), (Sent{"20 205#02008813", "20 080#"}));
}

TEST(CanopenMasterPdo, OutputsAreImagesAndInputsAreEvents) {
  Bench b;
  b.master.set_output(5, 2, 2, 2, 0xfb50);
  b.master.send_output(5, 2);
  b.master.request_input(5, 1, 8);
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{"0 305#000050FB", "0 185#R8"}));
  b.hear("185#4B80881364000000");
  EXPECT_EQ(b.event(), "pdo 5 185#4B80881364000000");
  b.hear("485#01");
  EXPECT_EQ(b.event(), "pdo 5 485#01");
}

TEST(CanopenMasterEmergency, IsTakenApart) {
  Bench b;
  b.hear("085#1032040022050000");
  EXPECT_EQ(b.event(), "emergency 5 12816 4 0");
  b.hear("085#10320400");
  EXPECT_EQ(b.event(), "none") << "an emergency has eight bytes";
  EXPECT_EQ(b.master.emergencies_of(5), 1u);
  EXPECT_EQ(b.master.emergency_of(5)->manufacturer[1], 0x22);
}

TEST(CanopenMasterSdo, ReadsEverySize) {
  Bench b;
  struct Case {
    const char* answer;
    const char* event;
  };
  for (const Case& c :
       {Case{"585#4F07300032FFFFFF", "sdo 50 of 1"}, Case{"585#4B07300032000000", "sdo 50 of 2"},
        Case{"585#4707300001020300", "sdo 197121 of 3"}, Case{"585#4307300078563412", "sdo 305419896 of 4"},
        Case{"585#4207300032000000", "sdo 50 of 0"}}) {
    b.master.transfer({5, 0x3007, 0, false, 0, 0});
    EXPECT_EQ(b.run(milliseconds(1)).size(), 1u);
    b.hear(c.answer);
    EXPECT_EQ(b.event(), c.event);
  }
}

TEST(CanopenMasterSdo, WritesEverySize) {
  Bench b;
  b.master.transfer({5, 0x6060, 0, true, 1, 2});
  b.master.transfer({6, 0x4000, 0, true, 2, 0xffff0002});
  b.master.transfer({7, 0x1014, 0, true, 4, 0x80000087});
  EXPECT_EQ(b.run(milliseconds(1)),
            (Sent{"0 605#2F60600002000000", "0 606#2B00400002000000", "0 607#2314100087000080"}));
  b.hear("585#6060600000000000");
  EXPECT_EQ(b.event(), "sdo 2 of 1");
}

TEST(CanopenMasterSdo, OneTransferAtATimeWithEachNode) {
  Bench b;
  b.master.transfer({5, 0x3007, 0, false, 0, 0});
  b.master.transfer({5, 0x3008, 0, false, 0, 0});
  b.master.transfer({6, 0x3009, 0, false, 0, 0});
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{"0 605#4007300000000000", "0 606#4009300000000000"}));
  b.hear("585#4B08300001000000");
  EXPECT_EQ(b.event(), "none") << "of the transfer that has not begun";
  b.hear("585#4B07300032000000");
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{"1 605#4008300000000000"}));
}

TEST(CanopenMasterSdo, AbortHasItsText) {
  Bench b;
  b.master.transfer({5, 0x5000, 0, false, 0, 0});
  b.run(milliseconds(1));
  b.hear("585#8000500000000206");
  EXPECT_EQ(b.event(), "SDO abort 06020000 (object does not exist)");
}

TEST(CanopenMasterSdo, TimeoutIsAbortedAndReported) {
  Bench b;
  b.master.transfer({5, 0x3007, 0, false, 0, 0});
  EXPECT_EQ(b.run(milliseconds(600)), (Sent{"0 605#4007300000000000", "500 605#8007300000000405"}));
  EXPECT_EQ(b.event(), "no SDO answer");
  b.hear("585#4B07300032000000");
  EXPECT_EQ(b.event(), "none") << "too late";
}

TEST(CanopenMasterSdo, SegmentedAnswerIsAborted) {
  Bench b;
  b.master.transfer({5, 0x1008, 0, false, 0, 0});
  b.run(milliseconds(1));
  b.hear("585#410810000A000000");
  EXPECT_EQ(b.event(), "an SDO answer that is not expedited");
  EXPECT_EQ(b.run(milliseconds(1)), (Sent{"1 605#8008100001000405"}));
}

TEST(CanopenMasterSdo, EveryAbortCodeOfTheDocumentHasAText) {
  for (const std::uint32_t code :
       {0x05030000u, 0x05040000u, 0x05040001u, 0x06010001u, 0x06010002u, 0x06020000u, 0x06040041u, 0x06040042u,
        0x06060000u, 0x06070010u, 0x06090011u, 0x06090030u, 0x08000000u, 0x08000021u, 0x08000022u})
    EXPECT_FALSE(abort_text(code).empty()) << std::hex << code;
  EXPECT_EQ(text_of(SdoFailure{SdoFailure::Kind::kAbort, 0x12345678}), "SDO abort 12345678");
}

TEST(CanopenMaster, ASavedSessionGoesOnTheSame) {
  CanopenMasterSettings s;
  s.sync_interval = milliseconds(70);
  Bench a(s);
  a.master.guard(a.now, 5, milliseconds(30), 2);
  a.master.set_output(5, 1, 0, 2, 2);
  a.master.send_output_cyclically(5, 1, true);
  a.master.transfer({5, 0x3007, 0, false, 0, 0});
  a.run(milliseconds(45));
  Bench b(s);
  b.now = a.now;
  ASSERT_TRUE(load_snapshot(b.master, save_snapshot(a.master)));
  const Sent first = a.run(milliseconds(700));
  EXPECT_EQ(first, b.run(milliseconds(700)));
  EXPECT_GT(first.size(), 20u);
}

TEST(WireBytes, HaveTheFlagsOfSocketCan) {
  for (const char* text : {"000#0105", "185#R8", "7FF#", "00000001#0102030405060708", "1FFFFFFF#R3"}) {
    const CanFrame frame = can(text);
    EXPECT_EQ(can_frame(wire_bytes(frame)), frame) << text;
  }
  EXPECT_FALSE(can_frame(Bytes{0, 0, 8, 0}).has_value()) << "a standard identifier has 11 bits";
  EXPECT_FALSE(can_frame(Bytes{0, 0, 1}).has_value());
  EXPECT_FALSE(can_frame(Bytes(13)).has_value());
}

}  // namespace
}  // namespace vinv::masters
