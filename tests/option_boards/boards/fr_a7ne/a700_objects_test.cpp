// Objects and assemblies of the FR-A7NE with an FR-A700 behind them: bytes in, inverter out. FR-A7NE manual, 4.2.1, 7.2
// and 7.5.
#include <cmath>

#include "tests/option_boards/boards/fr_a7ne/a700_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using test::A700OnEthernetIp;
using namespace std::chrono_literals;

constexpr const char* kGetPr346 = "0E 03 20 67 24 01 30 2E";
constexpr const char* kGetInput = "0E 03 20 29 24 01 30 8C";
constexpr const char* kGetOutput = "0E 03 20 29 24 01 30 8D";
constexpr const char* kInverterReset = "10 03 20 2A 24 01 30 65 01 00";
constexpr const char* kPair126 = "20 04 2C 7E 2C B0";

// A written value has its time before the next one.
std::string write(A700OnEthernetIp& b, std::string_view hex) {
  const std::string answer = b.ask(hex);
  b.run(100ms);
  return answer;
}
std::string set_input(A700OnEthernetIp& b, std::string_view instance) {
  return write(b, "10 03 20 29 24 01 30 8C " + std::string(instance));
}
std::string set_output(A700OnEthernetIp& b, std::string_view instance) {
  return write(b, "10 03 20 29 24 01 30 8D " + std::string(instance));
}
void reset(A700OnEthernetIp& b) {
  ASSERT_EQ(b.ask(kInverterReset), "00");
  b.feeding = false;
  b.run(2s);
  b.scanner.connect();
  b.scanner.register_session();
}

TEST(FrA7neAssemblySelection, Attributes140And141ActAfterAReset) {
  A700OnEthernetIp b;
  const test::OpenWish before = b.wish;
  EXPECT_EQ(set_input(b, "B0"), "00");
  EXPECT_EQ(b.ask(kGetPr346), "00 04 03") << "bits 7 to 11: 6; the output still 1";
  EXPECT_EQ(set_output(b, "7E"), "00");
  EXPECT_EQ(b.ask(kGetPr346), "00 18 03");
  EXPECT_EQ(b.ask(kGetInput), "00 47") << "updated by the reset";
  EXPECT_EQ(b.ask(kGetOutput), "00 15");
  EXPECT_EQ(b.own(), "00") << "21/71 until then";
  b.choose_long_pair(kPair126);
  b.wish.serial = 2;
  EXPECT_NE(b.scanner.open_status(b.wish), "00");
  reset(b);
  EXPECT_EQ(b.ask(kGetInput), "00 B0");
  EXPECT_EQ(b.ask(kGetOutput), "00 7E");
  EXPECT_EQ(b.scanner.open_status(before), "01 012A") << "no such output any more";
  test::OpenWish old_size = b.wish;
  old_size.o2t = before.o2t;
  EXPECT_EQ(b.scanner.open_status(old_size), "01 0127 000C");
  ASSERT_EQ(b.own(), "00");
  b.say("61 00 84 03 00 00");
  b.run(1s);
  EXPECT_NEAR(b.hz(), 30, 0.1);
}

TEST(FrA7neAssemblySelection, SelectionIsAParameterWriteWithItsConditions) {
  A700OnEthernetIp b({{"Pr.340", 1}});
  EXPECT_EQ(set_output(b, "16"), "09") << "no instance of this number";
  EXPECT_EQ(set_output(b, "47"), "09") << "an input";
  ASSERT_EQ(b.own(), "00");
  b.say("61 00 84 03");
  b.run(600ms);
  ASSERT_TRUE(b.running());
  EXPECT_EQ(set_output(b, "14"), "0C") << "running";
  b.say("60 00 84 03");
  b.run(1s);
  ASSERT_FALSE(b.running());
  EXPECT_EQ(write(b, "10 03 20 2A 24 01 30 78 10 00"), "00");
  EXPECT_EQ(set_output(b, "14"), "0C") << "external operation";
  EXPECT_EQ(b.ask(kGetPr346), "00 84 00");
}

// 7.11: Get; so in class 0x73, whose parameters are the same.
TEST(FrA7neAssemblySelection, ParameterItselfIsNotWritable) {
  A700OnEthernetIp b({{"Pr.346", 792}});
  for (const char* request : {"10 03 20 67 24 01 30 2E 84 00", "10 03 20 73 24 01 30 38 84 00"})
    EXPECT_EQ(write(b, request), "0E");
  // Nor by polled data; class 0x29 is.
  b.choose_long_pair(kPair126);
  ASSERT_EQ(b.own(), "00");
  b.say("80 00 84 00 67 2E");
  b.run(200ms);
  EXPECT_EQ(b.input().substr(12), "18 03") << "read all the same";
  b.say("80 00 84 00 73 38");
  b.run(200ms);
  EXPECT_EQ(b.ask(kGetPr346), "00 18 03");
  b.say("80 00 15 00 29 8D");
  EXPECT_EQ(b.input().substr(3, 2), "80") << "PrEnd";
  b.run(200ms);
  EXPECT_EQ(b.ask(kGetPr346), "00 04 03");
}

// 4.4: with Pr.338 = 1 and Pr.339 = 0 STF is the terminal's and RH is the network's; one must not keep the other away.
TEST(FrA7neSources, StartBitThatIsTheTerminalsLeavesTheOtherSignalsAlone) {
  A700OnEthernetIp b({{"Pr.346", 924}, {"Pr.338", 1}, {"Pr.4", 40}});
  b.choose_long_pair("20 04 2C 81 2C B3");
  ASSERT_EQ(b.own(), "00");
  EXPECT_TRUE(b.inverter->set_terminal("STF", true));
  b.say("61 10 84 03 00 00");
  b.run(1s);
  EXPECT_NEAR(b.hz(), 40, 0.1);
  EXPECT_TRUE(b.inverter->set_terminal("STF", false));
  b.run(1s);
  EXPECT_FALSE(b.running());
}

// 4.3.2: every row, by what attribute 120 of class 0x2A reads after power-on.
TEST(FrA7neMode, AtPowerOnPr79AndPr340Choose) {
  constexpr const char *kExternal = "00 00 00", *kPanel = "00 01 00", *kNetwork = "00 04 00", *kCombined = "00 05 00";
  struct Row {
    int pr79;
    bool x12;  // Pr.79 = 7: MRS, without a terminal for X12
    const char *pr340_0, *pr340_1, *pr340_10;
  };
  for (const Row& row :
       {Row{0, false, kExternal, kNetwork, kNetwork}, Row{1, false, kPanel, kPanel, kPanel},
        Row{2, false, kExternal, kNetwork, kNetwork}, Row{3, false, kCombined, kCombined, kCombined},
        Row{4, false, kCombined, kCombined, kCombined}, Row{6, false, kExternal, kNetwork, kNetwork},
        Row{7, true, kExternal, kNetwork, kExternal}, Row{7, false, kExternal, kExternal, kExternal}}) {
    for (const int pr340 : {0, 1, 2, 10, 12}) {
      A700OnEthernetIp b({{"Pr.79", row.pr79}, {"Pr.340", pr340}, {"Pr.75", 14}});
      if (row.x12) {
        EXPECT_TRUE(b.inverter->set_terminal("MRS", true));
        b.inverter->set_power(false);
        b.run(5s);
        b.inverter->set_power(true);
        b.run(2s);
        b.scanner.connect();
        b.scanner.register_session();
      }
      const char* const expected = pr340 == 0 ? row.pr340_0 : pr340 < 10 ? row.pr340_1 : row.pr340_10;
      EXPECT_EQ(b.ask("0E 03 20 2A 24 01 30 78"), expected) << row.pr79 << " " << pr340 << " " << row.x12;
    }
  }
}

// 4.3.2, column "operation mode switchover": what the network may switch to. Each from the mode of power-on.
TEST(FrA7neMode, NetworkSwitchesAsTheMatrixSays) {
  struct Row {
    int pr79, pr340;
    const char *to_external, *to_network, *to_panel;
  };
  for (const Row& row : {Row{0, 0, "00", "00", "0C"}, Row{0, 1, "00", "00", "0C"}, Row{0, 10, "0C", "00", "0C"},
                         Row{1, 0, "0C", "0C", "0C"}, Row{1, 10, "0C", "0C", "0C"}, Row{2, 0, "00", "00", "0C"},
                         Row{2, 1, "00", "00", "0C"}, Row{2, 10, "0C", "00", "0C"}, Row{3, 1, "0C", "0C", "0C"},
                         Row{4, 10, "0C", "0C", "0C"}, Row{6, 0, "00", "00", "00"}, Row{6, 12, "0C", "00", "00"},
                         Row{7, 0, "00", "0C", "0C"}, Row{7, 10, "00", "0C", "0C"}}) {
    for (const auto& [value, expected] :
         {std::pair{"10", row.to_external}, {"14", row.to_network}, {"11", row.to_panel}}) {
      A700OnEthernetIp b({{"Pr.79", row.pr79}, {"Pr.340", row.pr340}});
      EXPECT_EQ(b.mode(value), expected) << row.pr79 << " " << row.pr340 << " " << value;
    }
  }
}

// 4.7: r/min or machine speed in the speed items, Hz in the frequency items, by every combination of Pr.37 and Pr.144.
TEST(FrA7neSpeed, EveryCombinationOfPr37AndPr144) {
  const auto words = [](std::string_view hex) { return read_le16(test::from_hex(hex), 1); };
  for (const int pr37 : {0, 1000, 9998}) {
    for (const int pr144 : {0, 2, 4, 6, 8, 10, 102, 104, 106, 108, 110}) {
      A700OnEthernetIp b({{"Pr.37", pr37}, {"Pr.144", pr144}, {"Pr.505", 50}});
      const double hz = 20;
      const bool machine = pr37 != 0 && pr144 < 100;
      const int poles = pr144 > 100 ? pr144 - 100 : pr144 == 0 ? 4 : pr144;
      const auto speed = static_cast<unsigned>(std::lround(machine ? pr37 * hz / 50 : hz * 120 / poles));
      ASSERT_EQ(b.own(), "00");
      char data[16];
      std::snprintf(data, sizeof data, "61 00 %02X %02X", speed & 0xFF, speed >> 8);
      b.say(data);
      b.run(1s);
      SCOPED_TRACE(std::to_string(pr37) + " " + std::to_string(pr144));
      EXPECT_NEAR(b.hz(), hz, 0.01) << "set by instance 21";
      EXPECT_EQ(b.input(), "F4 00 " + std::string(data).substr(6)) << "instance 71";
      EXPECT_EQ(words(b.ask("0E 03 20 2A 24 01 30 07")), speed) << "SpeedActual";
      EXPECT_EQ(words(b.ask("0E 03 20 2A 24 01 30 08")), speed) << "SpeedRef";
      EXPECT_EQ(words(b.ask("0E 03 20 2A 24 01 30 70")), 2000u) << "set frequency";
      EXPECT_EQ(words(b.ask("0E 03 20 80 24 01 30 0B")), 2000u) << "output frequency monitor";
      EXPECT_EQ(words(b.ask("0E 03 20 80 24 01 30 0F")), 2000u) << "set frequency monitor";
      EXPECT_EQ(words(b.ask("0E 03 20 66 24 01 30 0D")), 5000u) << "Pr.3";
      EXPECT_NEAR(words(b.ask("0E 03 20 80 24 01 30 10")), speed, 1) << "running speed monitor";
    }
  }
}

// 7.3: no attributes.
TEST(FrA7neConnectionManager, HasNoAttributes) {
  A700OnEthernetIp b;
  EXPECT_EQ(b.ask("0E 03 20 06 24 01 30 01"), "08");
  EXPECT_EQ(b.ask("0E 03 20 06 24 00 30 01"), "08");
  EXPECT_EQ(b.ask("10 03 20 06 24 01 30 01 00 00"), "08");
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
