// The tables of FR-A7NE manual 4.5 and 4.6 at the board: bytes in, motor out.
#include "tests/option_boards/boards/fr_a7ne/a700_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using test::A700OnEthernetIp;
using namespace std::chrono_literals;

constexpr const char* kRun30Hz = "61 00 84 03";  // 900 r/min of four poles
constexpr const char* kReset = "64 00 84 03";    // fault reset, no run
constexpr const char* kStop = "60 00 84 03";
constexpr unsigned kLineErrorCode = 0xA3;

test::Settings with(int pr502, double pr500 = 0, test::Settings more = {}) {
  more.emplace_back("Pr.502", pr502);
  more.emplace_back("Pr.500", pr500);
  return more;
}
void run_up(A700OnEthernetIp& b) {
  ASSERT_EQ(b.own(), "00");
  b.say(kRun30Hz);
  b.run(600ms);
  ASSERT_NEAR(b.hz(), 30, 0.1) << b.alarm();
}
void reset_by_terminal(A700OnEthernetIp& b) {
  EXPECT_TRUE(b.inverter->set_terminal("RES", true));
  b.run(200ms);
  EXPECT_TRUE(b.inverter->set_terminal("RES", false));
  b.run(1500ms);
}
void fall_silent(A700OnEthernetIp& b) { b.feeding = false; }
void come_back(A700OnEthernetIp& b) { ASSERT_EQ(b.own(), "00"); }

// 4.5.1 (1) and (2): within Pr.500 nothing happens but Pr.501 counting.
TEST(FrA7neLineError, BackWithinPr500TheDriveGoesOn) {
  for (const int pr502 : {0, 1, 2, 3}) {
    A700OnEthernetIp b(with(pr502, 1));
    run_up(b);
    fall_silent(b);
    b.run(800ms);
    EXPECT_NEAR(b.hz(), 30, 0.1) << pr502;
    EXPECT_EQ(b.inverter->display(), "30.00") << pr502;
    come_back(b);
    b.run(2s);
    EXPECT_NEAR(b.hz(), 30, 0.1) << pr502;
    EXPECT_EQ(b.alarm(), "") << pr502;
    EXPECT_EQ(b.ask("0E 03 20 67 24 01 30 C1"), "00 01 00") << pr502;
    EXPECT_EQ(b.ask("10 03 20 67 24 01 30 C1 00 00"), "00");
    EXPECT_EQ(b.ask("0E 03 20 67 24 01 30 C1"), "00 00 00") << "erased";
  }
}

// 4.5.1 (3), at recognition: by Pr.502 coast, decelerate with alarm, decelerate without, go on.
TEST(FrA7neLineError, AfterPr500TheDriveDoesWhatPr502Says) {
  struct Row {
    int pr502;
    bool at_once_tripped, slows;
    const char* alarm;    // in the end
    const char* display;  // in the end
  };
  for (const Row& row : {Row{0, true, false, "E.OP3", "E.OP3"}, Row{1, false, true, "E.OP3", "E.OP3"},
                         Row{2, false, true, "", "E.OP3"}, Row{3, false, false, "", "30.00"}}) {
    A700OnEthernetIp b(with(row.pr502, 0.5));
    run_up(b);
    fall_silent(b);
    b.run(500ms);
    EXPECT_NEAR(b.hz(), 30, 0.1) << row.pr502;
    b.run(200ms);
    EXPECT_EQ(b.alarm(), row.at_once_tripped ? "E.OP3" : "") << row.pr502;
    if (row.slows) {
      EXPECT_LT(b.hz(), 29) << row.pr502;
      EXPECT_GT(b.hz(), 10) << row.pr502;
    }
    b.run(1s);
    EXPECT_EQ(b.alarm(), row.alarm) << row.pr502;
    EXPECT_EQ(b.inverter->display(), row.display) << row.pr502;
    EXPECT_EQ(b.running(), row.pr502 == 3) << row.pr502;
    EXPECT_EQ(b.history(0), row.pr502 != 3 ? kLineErrorCode : 0) << row.pr502;
    // Caution 3: without alarm output the entry is there as long as the error.
    come_back(b);
    b.run(1s);
    EXPECT_EQ(b.history(0), row.alarm[0] != 0 ? kLineErrorCode : 0) << row.pr502;
  }
}

// ... at removal.
TEST(FrA7neLineError, WhenTheOwnerIsBackOnlyPr502Is2Restarts) {
  for (const int pr502 : {0, 1, 2, 3}) {
    A700OnEthernetIp b(with(pr502));
    run_up(b);
    fall_silent(b);
    b.run(2s);
    come_back(b);
    b.run(1s);
    const bool runs = pr502 >= 2;
    EXPECT_NEAR(b.hz(), runs ? 30 : 0, 0.1) << pr502;
    EXPECT_EQ(b.inverter->display(), runs ? "30.00" : "E.OP3") << pr502;
    const std::string input = b.input();
    EXPECT_EQ(input.substr(0, 2), runs ? "F4" : "71") << pr502 << ": " << input;
  }
}

// Caution 7: the error goes during the deceleration.
TEST(FrA7neLineError, BackDuringTheDecelerationTheDriveRestartsFromThere) {
  A700OnEthernetIp b(with(2, 0, {{"Pr.8", 5}}));
  run_up(b);
  fall_silent(b);
  b.run(1s);
  const double low = b.hz();
  EXPECT_LT(low, 25);
  EXPECT_GT(low, 10);
  come_back(b);
  b.run(100ms);
  EXPECT_GT(b.hz(), low);
  b.run(1s);
  EXPECT_NEAR(b.hz(), 30, 0.1);
}

TEST(FrA7neLineError, CloseClass3TimeOutAndTcpCloseAreNone) {
  A700OnEthernetIp b(with(0));
  run_up(b);
  test::OpenWish explicit_wish;
  explicit_wish.serial = 9;
  explicit_wish.transport = 0xA3;
  explicit_wish.o2t = explicit_wish.t2o = 0x4000 | 100;
  explicit_wish.path = "20 02 24 01";
  ASSERT_EQ(b.scanner.open_status(explicit_wish), "00");
  b.run(11s);
  EXPECT_EQ(b.adapter.connections().explicit_connections(), 0u);
  EXPECT_EQ(network_led(b.unit->led_situation()), "red flashing");
  EXPECT_NEAR(b.hz(), 30, 0.1) << "class 3 timed out";
  b.adapter.handle_tcp_closed(b.now, b.scanner.tcp);
  b.run(1s);
  EXPECT_NEAR(b.hz(), 30, 0.1) << "TCP closed; the I/O goes on";
  EXPECT_EQ(b.input().substr(0, 2), "F4");
  b.scanner.connect();
  b.scanner.register_session();
  b.feeding = false;
  EXPECT_EQ(b.scanner.status_of(b.scanner.close(b.wish)), "00");
  b.run(2s);
  EXPECT_EQ(b.alarm(), "");
  EXPECT_NEAR(b.hz(), 30, 0.1) << "Forward_Close: the last command stays";
}

TEST(FrA7neLineError, LostLinkIsOne) {
  A700OnEthernetIp b(with(0));
  run_up(b);
  b.unit->set_link(b.now, false);
  b.run(5ms);
  EXPECT_EQ(b.alarm(), "E.OP3");
}

// 4.5.2 (1), rows "inverter" and "communication line", by operation mode.
TEST(FrA7neLineError, OutsideNetworkOperationTheDriveGoesOn) {
  A700OnEthernetIp b(with(0, 0, {{"Pr.340", 0}, {"Pr.4", 30}}));
  ASSERT_EQ(b.own(), "00");
  EXPECT_TRUE(b.inverter->set_terminal("STF", true));
  EXPECT_TRUE(b.inverter->set_terminal("RH", true));
  b.run(1s);
  ASSERT_NEAR(b.hz(), 30, 0.1);
  fall_silent(b);
  b.run(1s);
  EXPECT_EQ(b.adapter.connections().io_connections(), 0u) << "data communication stops";
  EXPECT_NEAR(b.hz(), 30, 0.1);
  EXPECT_EQ(b.alarm(), "");
}

TEST(FrA7neLineError, DataCommunicationContinuesWhileTheInverterIsTripped) {
  A700OnEthernetIp b(with(0));
  run_up(b);
  EXPECT_TRUE(b.inverter->inject_fault("E.OV1", true));
  b.run(50ms);
  EXPECT_EQ(b.input().substr(0, 2), "71");
  EXPECT_EQ(b.adapter.connections().io_connections(), 1u);
  EXPECT_EQ(b.ask("0E 03 20 2A 24 01 30 8D"), "00 20 00");
}

// 4.5.1 and 4.5.2 (1), error of the option itself: E.3, coasting with Pr.502 = 0 and 3, decelerating with 1 and 2.
TEST(FrA7neLineError, FailedOptionIsE3) {
  for (const int pr502 : {0, 1, 2, 3}) {
    A700OnEthernetIp b(with(pr502));
    run_up(b);
    b.unit->set_failed(b.now, true);
    EXPECT_FALSE(b.unit->on_network());
    b.run(100ms);
    const bool coasts = pr502 == 0 || pr502 == 3;
    EXPECT_EQ(b.alarm(), coasts ? "E.3" : "") << pr502;
    b.run(1s);
    EXPECT_EQ(b.alarm(), "E.3") << pr502;
    EXPECT_FALSE(b.adapter.is_started()) << "data communication stops";
    EXPECT_EQ(module_led(b.unit->led_situation()), "red");
    b.unit->set_failed(b.now, false);
    b.run(1s);
    EXPECT_EQ(b.inverter->display(), "E.  3") << "kept: " << pr502;
    EXPECT_EQ(b.history(0), 0xF3u);
    EXPECT_FALSE(b.adapter.is_started()) << "until the next start";
    reset_by_terminal(b);
    EXPECT_EQ(b.alarm(), "") << pr502;
    EXPECT_TRUE(b.adapter.is_started());
    EXPECT_EQ(module_led(b.unit->led_situation()), "green flashing");
    EXPECT_EQ(b.inverter->get_parameter("Pr.501").value(), 0) << "no line error";
  }
}

TEST(FrA7neLineError, OptionThatIsNotMendedFailsAgainAfterAReset) {
  A700OnEthernetIp b;
  b.unit->set_failed(b.now, true);
  b.run(100ms);
  ASSERT_EQ(b.alarm(), "E.3");
  reset_by_terminal(b);
  EXPECT_EQ(b.alarm(), "E.3");
  EXPECT_FALSE(b.unit->on_network());
}

// 4.5.2 (1), last row: outside NET operation the drive goes on, without its network.
TEST(FrA7neLineError, FailedOptionMattersInNetworkOperationOnly) {
  A700OnEthernetIp b({{"Pr.340", 0}, {"Pr.4", 30}});
  EXPECT_TRUE(b.inverter->set_terminal("STF", true));
  EXPECT_TRUE(b.inverter->set_terminal("RH", true));
  b.run(1s);
  b.unit->set_failed(b.now, true);
  b.run(1s);
  EXPECT_EQ(b.alarm(), "");
  EXPECT_NEAR(b.hz(), 30, 0.1);
  EXPECT_FALSE(b.adapter.is_started());
}

// 4.6 (1): inverter reset from the network by operation mode.
TEST(FrA7neReset, InverterResetOnlyInNetworkOperation) {
  constexpr const char* kInverterReset = "10 03 20 2A 24 01 30 65 01 00";
  A700OnEthernetIp b({{"Pr.540", 0x800}, {"Pr.340", 1}});
  EXPECT_EQ(b.mode("10"), "00");
  b.run(200ms);
  EXPECT_EQ(b.ask(kInverterReset), "0C") << "external";
  EXPECT_EQ(b.mode("14"), "00");
  b.run(200ms);
  ASSERT_EQ(b.own(), "00");
  EXPECT_EQ(b.ask(kInverterReset), "00") << "at any time";
  // Not controllable for about 1 s; the option goes on (Pr.540, bit 11).
  b.run(200ms);
  EXPECT_EQ(b.ask("10 03 20 2A 24 01 30 70 B8 0B"), "10");
  EXPECT_EQ(b.ask("0E 03 20 29 24 01 30 06"), "00 02") << "Not_Ready";
  b.run(1500ms);
  EXPECT_EQ(b.adapter.connections().io_connections(), 1u);
  EXPECT_EQ(b.ask("10 03 20 2A 24 01 30 70 B8 0B"), "00");
}

TEST(FrA7neReset, WithoutPr540Bit11TheOptionRestartsWithTheInverter) {
  A700OnEthernetIp b;
  ASSERT_EQ(b.own(), "00");
  EXPECT_EQ(b.ask("10 03 20 2A 24 01 30 65 01 00"), "00");
  b.run(200ms);
  EXPECT_FALSE(b.adapter.is_started());
  EXPECT_EQ(b.closed.back(), b.scanner.tcp);
  b.run(2s);
  EXPECT_TRUE(b.adapter.is_started());
  EXPECT_EQ(b.adapter.connections().io_connections(), 0u);
  EXPECT_EQ(b.alarm(), "") << "no line error";
}

// 4.2.5: bit 11 of Pr.540 keeps the connections, except after E.3.
TEST(FrA7neReset, AfterE3TheOptionRestartsInSpiteOfPr540Bit11) {
  A700OnEthernetIp b({{"Pr.540", 0x800}});
  ASSERT_EQ(b.own(), "00");
  b.run(100ms);
  EXPECT_TRUE(b.inverter->inject_fault("E.OV1", true));
  b.run(50ms);
  reset_by_terminal(b);
  EXPECT_EQ(b.adapter.connections().io_connections(), 1u);
  EXPECT_TRUE(b.inverter->inject_fault("option", true));
  b.run(50ms);
  ASSERT_EQ(b.alarm(), "E.3");
  EXPECT_EQ(b.adapter.connections().io_connections(), 1u) << "a bad contact: data communication goes on";
  EXPECT_TRUE(b.inverter->inject_fault("option", false));
  b.feeding = false;
  EXPECT_TRUE(b.inverter->set_terminal("RES", true));
  b.run(20ms);
  EXPECT_EQ(b.adapter.connections().io_connections(), 0u);
}

// What was on is forgotten with the reset, by the inverter and by the option.
TEST(FrA7neReset, RunBitsAreGoneAfterAResetThatTheOptionOutlives) {
  A700OnEthernetIp b({{"Pr.540", 0x800}});
  EXPECT_EQ(b.ask("10 03 20 29 24 01 30 03 01"), "00");
  EXPECT_EQ(b.ask("0E 03 20 29 24 01 30 03"), "00 01");
  b.run(100ms);
  EXPECT_EQ(b.ask("10 03 20 2A 24 01 30 65 01 00"), "00");
  b.run(2s);
  EXPECT_EQ(b.ask("0E 03 20 29 24 01 30 03"), "00 00");
  // Another command must not bring the start signal back.
  EXPECT_EQ(b.ask("10 03 20 29 24 01 30 04 00"), "00");
  b.run(200ms);
  EXPECT_FALSE(b.running());
}

// 4.6 (1) and (2): error reset by the polled bit, Pr.349 and operation mode.
TEST(FrA7neReset, ErrorResetFollowsPr349) {
  for (const int pr349 : {0, 1}) {
    for (const bool net : {true, false}) {
      A700OnEthernetIp b({{"Pr.349", pr349}, {"Pr.340", net ? 10 : 0}, {"Pr.540", 0x800}});
      ASSERT_EQ(b.own(), "00");
      b.say(kStop);
      EXPECT_TRUE(b.inverter->inject_fault("E.OV1", true));
      b.run(50ms);
      ASSERT_EQ(b.alarm(), "E.OV1");
      b.say(kReset);
      b.run(2s);
      EXPECT_EQ(b.alarm(), pr349 == 1 && !net ? "E.OV1" : "") << pr349 << net;
      EXPECT_EQ(b.history(0), 0x20u) << "the history stays";
    }
  }
}

// 4.6, caution 1.
TEST(FrA7neReset, LineErrorIsNotResetFromTheNetwork) {
  A700OnEthernetIp b(with(0, 0, {{"Pr.540", 0x800}}));
  run_up(b);
  fall_silent(b);
  b.run(200ms);
  ASSERT_EQ(b.alarm(), "E.OP3");
  EXPECT_EQ(b.ask("10 03 20 29 24 01 30 0C 01"), "0C");
  EXPECT_EQ(b.ask("10 03 20 2A 24 01 30 65 01 00"), "0C");
  EXPECT_EQ(b.ask("05 02 20 01 24 01 00"), "0C");
  EXPECT_EQ(b.alarm(), "E.OP3");
  come_back(b);
  b.say(kStop);
  b.say(kReset);
  b.run(2s);
  EXPECT_EQ(b.alarm(), "E.OP3") << "not after it either";
  reset_by_terminal(b);
  EXPECT_EQ(b.alarm(), "");
  b.say(kRun30Hz);
  b.run(1s);
  EXPECT_NEAR(b.hz(), 30, 0.1);
}

// 7.1.2 *1: Identity reset as Pr.75 has it (14: at any time; 1 and 15: with an alarm only).
TEST(FrA7neReset, IdentityResetFollowsPr75) {
  for (const auto& [pr75, at_any_time] : {std::pair{14, true}, {15, false}, {1, false}, {0, true}}) {
    A700OnEthernetIp b({{"Pr.75", pr75}, {"Pr.540", 0x800}});
    EXPECT_EQ(b.ask("05 02 20 01 24 01 00"), at_any_time ? "00" : "10") << pr75;
    b.run(2s);
    EXPECT_TRUE(b.inverter->inject_fault("E.OV1", true));
    b.run(50ms);
    EXPECT_EQ(b.ask("05 02 20 01 24 01 00"), "00") << pr75;
    b.run(2s);
    EXPECT_EQ(b.alarm(), "") << pr75;
  }
}

// 7.1.2: with type 1 parameters and flash go first; nothing does if the inverter does not accept the order.
TEST(FrA7neReset, IdentityResetOneIsDoneAsAWholeOrNotAtAll) {
  constexpr const char* kClearAndReset = "05 02 20 01 24 01 01";
  constexpr const char* kGetPr7 = "0E 03 20 66 24 01 30 11";
  A700OnEthernetIp b({{"Pr.75", 15}, {"Pr.340", 1}, {"Pr.7", 1.2}});
  EXPECT_EQ(b.ask(kClearAndReset), "10") << "Pr.75: without an alarm";
  EXPECT_EQ(b.ask(kGetPr7), "00 0C 00");
  b.run(100ms);
  EXPECT_EQ(b.mode("10"), "00");
  b.run(100ms);
  EXPECT_EQ(b.ask(kClearAndReset), "0C") << "external operation";
  EXPECT_EQ(b.ask(kGetPr7), "00 0C 00");
  EXPECT_EQ(b.mode("14"), "00");
  b.run(100ms);
  Flash flash;
  flash.host_name = "m1";
  b.unit->set_flash(flash);
  EXPECT_TRUE(b.inverter->inject_fault("E.OV1", true));
  b.run(50ms);
  EXPECT_EQ(b.ask(kClearAndReset), "00");
  b.run(2s);
  EXPECT_EQ(b.inverter->get_parameter("Pr.7").value(), 5);
  EXPECT_EQ(b.unit->flash(), Flash{});
  EXPECT_EQ(b.inverter->port().operation_mode(), port::OperationMode::kExternal) << "Pr.340 is 0";
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
