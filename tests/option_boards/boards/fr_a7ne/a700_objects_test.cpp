// Objects and assemblies of the FR-A7NE with an FR-A700 behind them: bytes in, inverter out. FR-A7NE manual, 4.2.1, 7.2
// and 7.5.
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

}  // namespace
}  // namespace vinv::boards::fr_a7ne
