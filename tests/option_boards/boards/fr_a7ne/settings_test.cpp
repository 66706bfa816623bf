// Start-up settings, TCP/IP and Ethernet Link objects. FR-A7NE manual, 4.2, 7.8, 7.9.
#include <gtest/gtest.h>

#include "option_boards/boards/fr_a7ne/leds.hpp"
#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

class FrA7neSettings : public test::UnitBench {
 protected:
  void restart_with(std::uint32_t pr540) {
    drive.parameters[540].value = pr540;
    power(false);
    power(true);
  }
};

// 4.2.5, table of combinations.
TEST(FrA7neLine, CombinationsOfThePrintedTable) {
  const LineSetting automatic{}, half10{false, false, 10}, full10{false, true, 10}, half100{false, false, 100},
      full100{false, true, 100};
  const LineSetting settings[] = {automatic, half10, full10, half100, full100};
  const bool goes[5][5] = {{true, true, false, true, false},
                           {true, true, false, false, false},
                           {false, false, true, false, false},
                           {true, false, false, true, false},
                           {false, false, false, false, true}};
  for (int partner = 0; partner < 5; ++partner) {
    for (int own = 0; own < 5; ++own) {
      EXPECT_EQ(line_state(settings[own], settings[partner]).link, goes[partner][own]) << partner << own;
    }
  }
  EXPECT_EQ(line_state(automatic, automatic), (LineState{true, true, 100, 3}));
  EXPECT_EQ(line_state(automatic, half100), (LineState{true, false, 100, 2}));
  EXPECT_EQ(line_state(automatic, full100), (LineState{false, false, 10, 1}));
  EXPECT_EQ(line_state(full10, full10), (LineState{true, true, 10, 4}));
}

TEST_F(FrA7neSettings, FlashWithDhcpIsTheFirstStart) {
  EXPECT_EQ(get(0xF5, 1, 1), "00 01 00 00 00");
  EXPECT_EQ(get(0xF5, 1, 2), "00 14 00 00 00");
  EXPECT_EQ(get(0xF5, 1, 3), "00 02 00 00 00");
  EXPECT_EQ(get(0xF5, 1, 4), "00 02 00 20 F6 24 01");
  EXPECT_EQ(get(0xF5, 1, 5), "00 02 00 00 7F 00 00 00 FF 00 00 00 00 00 00 00 00 00 00 00 00 00 00");
  EXPECT_TRUE(unit.network().dhcp);
}

TEST_F(FrA7neSettings, ParametersAreUsedWithPr540Bit0) {
  for (unsigned i = 0; i < 12; ++i) {
    const unsigned octets[] = {192, 168, 3, 40, 255, 255, 255, 0, 192, 168, 3, 1};
    drive.parameters[static_cast<std::uint16_t>(434 + i)].value = octets[i];
  }
  restart_with(0x0003);
  EXPECT_EQ(unit.network().ip.address, 0xC0A80328u);
  EXPECT_EQ(get(0xF5, 1, 3), "00 00 00 00 00");
  EXPECT_EQ(get(0xF5, 1, 5).substr(0, 38), "00 28 03 A8 C0 00 FF FF FF 01 03 A8 C0");
  EXPECT_EQ(get(0xF4, 2, 7), "00 12 0C 31 39 32 2E 31 36 38 2E 33 2E 34 30");
  restart_with(0x0001);  // DHCP is valid
  EXPECT_EQ(unit.network().ip.address, 0x7F000002u);
  restart_with(0x1003);  // key
  EXPECT_TRUE(unit.network().dhcp);
}

TEST_F(FrA7neSettings, CommunicationSettingOfPr540) {
  struct Row {
    std::uint32_t pr540;
    LineSetting line;
  };
  for (const Row& row : {Row{0x03, {}}, Row{0x0F, {}}, Row{0x13, {false, false, 10}}, Row{0x17, {false, true, 10}},
                         Row{0x1B, {false, false, 100}}, Row{0x1F, {false, true, 100}}}) {
    restart_with(row.pr540);
    EXPECT_EQ(unit.network().line, row.line) << row.pr540;
  }
  EXPECT_EQ(get(0xF6, 1, 6), "00 02 00 64 00");
}

TEST_F(FrA7neSettings, InterfaceConfigurationGoesToFlashAndActsAfterTheNextStart) {
  const std::string address = "28 03 A8 C0 00 FF FF FF 01 03 A8 C0 00 00 00 00 00 00 00 00 00 00";
  EXPECT_EQ(set(0xF5, 1, 5, address), "0C");  // DHCP
  EXPECT_EQ(set(0xF5, 1, 3, "01 00 00 00"), "09");
  EXPECT_EQ(set(0xF5, 1, 3, "00 00 00 00"), "00");
  EXPECT_EQ(set(0xF5, 1, 5, address), "00");
  EXPECT_EQ(get(0xF5, 1, 5), "00 " + address);
  EXPECT_EQ(unit.network().ip.address, 0x7F000002u);
  power(false);
  power(true);
  EXPECT_EQ(unit.network().ip.address, 0xC0A80328u);
  EXPECT_FALSE(unit.network().dhcp);
}

// 7.8.2 *1 and *2.
TEST_F(FrA7neSettings, AddressesThatAreNoneAreRefused) {
  set(0xF5, 1, 3, "00 00 00 00");
  const std::string rest = " 00 00 00 00 00 00 00 00 00 00";
  for (const char* bad : {"01 00 00 7F 00 00 00 FF 00 00 00 00", "01 00 00 E0 00 00 00 FF 00 00 00 00",
                          "01 00 00 00 00 00 00 FF 00 00 00 00", "28 03 A8 C0 FF 00 FF FF 00 00 00 00",
                          "28 03 A8 C0 00 FF FF FF 01 00 00 7F"}) {
    EXPECT_EQ(set(0xF5, 1, 5, bad + rest), "09") << bad;
  }
  EXPECT_EQ(set(0xF5, 1, 5, "00 00 00 00 00 00 00 00 00 00 00 00" + rest), "00");
  EXPECT_EQ(set(0xF5, 1, 5, "00 00 00 00"), "13");
  std::string name = "31 00";
  for (int i = 0; i < 49; ++i) name += " 61";
  EXPECT_EQ(set(0xF5, 1, 6, name + " 00"), "09");
  // 48 characters are the most.
  std::string most = "30 00";
  for (int i = 0; i < 48; ++i) most += " 61";
  EXPECT_EQ(set(0xF5, 1, 6, most), "00");
  const std::string zeros = "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 ";
  EXPECT_EQ(set(0xF5, 1, 5, zeros + most), "00");
  EXPECT_EQ(get(0xF5, 1, 5), "00 " + zeros + most);
  EXPECT_EQ(set(0xF5, 1, 5, zeros + name + " 61"), "09") << "49, with one to pad";
  EXPECT_EQ(set(0xF5, 1, 6, "03 00 61 62 63 00"), "00");
  EXPECT_EQ(get(0xF5, 1, 6), "00 03 00 61 62 63 00");
}

TEST_F(FrA7neSettings, EthernetLinkTellsAndTakesTheLine) {
  EXPECT_EQ(get(0xF6, 0, 1), "00 01 00");
  EXPECT_EQ(get(0xF6, 1, 1), "00 64 00 00 00");
  EXPECT_EQ(get(0xF6, 1, 2), "00 2F 00 00 00");
  EXPECT_EQ(get(0xF6, 1, 3), "00 02 00 00 00 00 09");
  EXPECT_EQ(get(0xF6, 1, 6), "00 01 00 00 00");
  EXPECT_EQ(set(0xF6, 1, 6, "01 00 64 00"), "0C");
  EXPECT_EQ(set(0xF6, 1, 6, "03 00 00 00"), "0C");
  EXPECT_EQ(set(0xF6, 1, 6, "00 00 E8 03"), "09");
  EXPECT_EQ(set(0xF6, 1, 6, "04 00 0A 00"), "09");
  EXPECT_EQ(set(0xF6, 1, 6, "00 00 0A 00"), "00");
  EXPECT_EQ(get(0xF6, 1, 6), "00 00 00 0A 00");
  EXPECT_EQ(get(0xF6, 1, 1), "00 64 00 00 00");
  power(false);
  power(true);
  EXPECT_EQ(get(0xF6, 1, 1), "00 0A 00 00 00");
  EXPECT_EQ(get(0xF6, 1, 2), "00 31 00 00 00");
}

// 1.2: the three tables.
TEST(FrA7neLeds, ModuleLedShowsTheWorst) {
  LedSituation s;
  EXPECT_EQ(module_led(s), "off");
  s.supplied = s.self_test = true;
  EXPECT_EQ(module_led(s), "green and red flashing");
  s.self_test = false;
  s.initializing = true;
  EXPECT_EQ(module_led(s), "green");
  s.initializing = false;
  EXPECT_EQ(module_led(s), "green flashing");
  s.minor_fault = true;
  EXPECT_EQ(module_led(s), "red flashing");
  s.major_fault = true;
  EXPECT_EQ(module_led(s), "red");
}

TEST(FrA7neLeds, NetworkLedShowsAddressAndConnections) {
  LedSituation s;
  EXPECT_EQ(network_led(s), "off");
  s.supplied = true;
  EXPECT_EQ(network_led(s), "off");
  s.has_address = true;
  EXPECT_EQ(network_led(s), "green flashing");
  s.connected = true;
  EXPECT_EQ(network_led(s), "green");
  s.timed_out = true;
  EXPECT_EQ(network_led(s), "red flashing");
  s.duplicate_address = true;
  EXPECT_EQ(network_led(s), "red");
  s.self_test = true;
  EXPECT_EQ(network_led(s), "green and red flashing");
}

TEST(FrA7neLeds, LinkLedShowsTraffic) {
  LedSituation s;
  s.link = true;
  EXPECT_EQ(link_led(s), "off");
  s.supplied = true;
  EXPECT_EQ(link_led(s), "green");
  s.traffic = true;
  EXPECT_EQ(link_led(s), "green flashing");
  s.self_test = true;
  EXPECT_EQ(link_led(s), "off");
  s.self_test = false;
  s.link = false;
  EXPECT_EQ(link_led(s), "off");
}

TEST_F(FrA7neSettings, StartWaitsUntilTheInverterCanTell) {
  drive.parameters_readable = false;
  power(false);
  power(true);
  EXPECT_FALSE(unit.online());
  drive.parameters_readable = true;
  tick();
  EXPECT_TRUE(unit.online());
}

// 7.8.2: what is read is what is configured there where the settings come from.
TEST_F(FrA7neSettings, AddressOfTheParametersIsReadWhateverTheFlashHas) {
  Flash flash;
  flash.dhcp = false;
  flash.ip.address = 0x0A000001;
  unit.set_flash(flash);
  drive.parameters[540].value = 3;
  drive.parameters[434].value = 192;
  drive.parameters[437].value = 9;
  power(false);
  power(true);
  EXPECT_EQ(get(0xF5, 1, 3), "00 00 00 00 00");
  EXPECT_EQ(get(0xF5, 1, 5).substr(0, 14), "00 09 00 00 C0");
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
