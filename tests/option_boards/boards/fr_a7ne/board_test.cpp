// FR-A7NE as a board: supply, cable, lamps and flash memory. FR-A7NE manual, 1.2, 4.2.5, 7.8, 7.9.
#include "option_boards/boards/fr_a7ne/board.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/support/fake_drive.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

struct Rig {
  explicit Rig(const CipUnitConfig& c = config()) : board(drive, c) {
    for (std::uint16_t number = 434; number <= 445; ++number) drive.parameters[number] = {0, 0, 255};
    drive.parameters[346] = {132, 0, 4095};
    drive.parameters[540] = {0, 0, 4095};
    drive.is_ready = false;
  }
  static CipUnitConfig config() {
    CipUnitConfig c;
    c.ethernet.lease.address = 0x7f000002;
    return c;
  }
  void tick(unsigned milliseconds = 1) {
    for (unsigned i = 0; i < milliseconds; ++i) {
      now += std::chrono::milliseconds(1);
      drive.tick();
      board.handle_drive_tick(now);
    }
  }
  void start() {
    board.handle_power(now, true);
    drive.is_ready = true;
    tick();
  }
  EthernetChannel& channel() { return *static_cast<OptionBoard&>(board).ethernet_channel(); }
  std::string lamps() {
    std::string out;
    for (const Led& l : board.leds()) out += (out.empty() ? "" : ", ") + std::string(l.state);
    return out;
  }
  test::FakeDrive drive;
  Board board;
  Instant now = instant_from_ns(5'000'000'000);
};

TEST(FrA7neBoard, LampsFollowStartUpAndConnections) {
  Rig r;
  EXPECT_EQ(r.lamps(), "off, off, off");
  r.board.handle_power(r.now, true);
  r.tick();
  EXPECT_EQ(r.lamps(), "green and red flashing, green and red flashing, off");
  EXPECT_EQ(r.channel().address(), 0u);
  r.drive.is_ready = true;
  r.tick();
  EXPECT_EQ(r.lamps(), "green flashing, green flashing, green");
  EXPECT_EQ(r.channel().address(), 0x7f000002u);
  EXPECT_TRUE(r.channel().take_restart());
  EXPECT_FALSE(r.channel().take_restart());
  r.channel().cip_device().on_explicit_connection(r.now, cip::IoEvent::kOpened);
  r.channel().handle_activity(r.now);
  EXPECT_EQ(r.lamps(), "green flashing, green, green flashing");
  r.tick(60);
  EXPECT_EQ(r.lamps(), "green flashing, green, green");
  r.channel().set_duplicate_address(true);
  r.drive.status_now.alarm = true;
  EXPECT_EQ(r.lamps(), "red flashing, red, green");
  EXPECT_EQ(r.board.status_led(), "red") << "of several the one of the network";
  r.board.handle_power(r.now, false);
  EXPECT_EQ(r.lamps(), "off, off, off");
}

TEST(FrA7neBoard, LostCableIsALineErrorAsLongAsItLasts) {
  Rig r;
  r.start();
  EXPECT_FALSE(r.drive.communication_lost);
  r.channel().plug(r.now, false);
  EXPECT_TRUE(r.drive.communication_lost);
  EXPECT_FALSE(r.channel().has_link());
  EXPECT_FALSE(r.channel().plugged());
  r.channel().plug(r.now, true);
  EXPECT_FALSE(r.drive.communication_lost);
  EXPECT_TRUE(r.channel().has_link());
}

// Every pair of 4.2.5: what Pr.540 sets against the other end.
TEST(FrA7neBoard, LinkFollowsTheTableOfSpeedAndDuplex) {
  const std::vector<std::string_view> words{"auto", "10_half", "100_half", "10_full", "100_full"};
  // Pr.540 with DHCP on and ComSet in bits 2-4.
  const std::vector<std::uint32_t> own{1, 1 | 4 << 2, 1 | 6 << 2, 1 | 5 << 2, 1 | 7 << 2};
  for (std::size_t i = 0; i < own.size(); ++i) {
    std::string links;
    for (const std::string_view partner : words) {
      CipUnitConfig c = Rig::config();
      c.ethernet.line_partner = *parse_line_setting(partner);
      Rig r(c);
      r.drive.parameters[540].value = own[i];
      r.start();
      EXPECT_FALSE(r.drive.communication_lost) << "chapter 8: 0.00, and the lamp is dark";
      links += r.channel().has_link() ? '1' : '0';
    }
    const char* const expected[] = {"11100", "11000", "10100", "00010", "00001"};
    EXPECT_EQ(links, expected[i]) << words[i];
  }
}

TEST(FrA7neBoard, FlashIsTheSameAfterWritingAndReading) {
  Flash flash;
  flash.dhcp = false;
  flash.ip = {0xc0a80009, 0xffffff00, 0xc0a80001, 1, 2, "plant.example"};
  flash.host_name = std::string("a b%\0\xff", 6);
  flash.line = {false, true, 100};
  const std::string text = flash_text(flash);
  EXPECT_EQ(text.substr(0, 72), "vinverter flash 1 fr-a7ne\ndhcp = off\naddress = 192.168.0.9\nmask = 255.25");
  const auto read = parse_flash(text);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(*read, flash);
  EXPECT_EQ(*parse_flash(flash_text(Flash{})), Flash{});
}

TEST(FrA7neBoard, DamagedFlashIsRefusedWithItsLineAndChangesNothing) {
  const std::string good = flash_text(Flash{});
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 1);
    EXPECT_FALSE(parse_flash(bad)) << i;
    EXPECT_FALSE(parse_flash(good.substr(0, i))) << i;
  }
  EXPECT_EQ(parse_flash("").error(), "line 1: this is no flash memory of an fr-a7ne");
  EXPECT_EQ(parse_flash(good + "x").error(), "line 11: something follows the checksum");
  Rig r;
  const std::string before = r.board.flash_text();
  EXPECT_FALSE(r.board.load_flash(good.substr(0, 40)));
  EXPECT_EQ(r.board.flash_text(), before);
}

// A file that somebody wrote, with the right checksum.
TEST(FrA7neBoard, FlashValuesThatAreNoneAreRefused) {
  const auto with = [](std::string_view from, std::string_view to) {
    std::string text = flash_text(Flash{});
    text.replace(text.find(from), from.size(), to);
    text.erase(text.find("checksum"));
    char line[40];
    std::snprintf(line, sizeof line, "checksum = %016llx\n",
                  static_cast<unsigned long long>(
                      snapshot_checksum({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()})));
    return parse_flash(text + line);
  };
  ASSERT_TRUE(with("host_name = ", "host_name = a%25"));
  EXPECT_EQ(with("host_name = ", "host_name = a%25")->host_name, "a%");
  EXPECT_TRUE(with("host_name = ", "host_name = " + std::string(48, 'a')));
  EXPECT_EQ(with("host_name = ", "host_name = " + std::string(49, 'a')).error(), "line 9: host_name has no such value");
  for (const char* bad : {"%", "%2", "%2G", "%G2"}) {
    EXPECT_FALSE(with("host_name = ", std::string("host_name = ") + bad)) << bad;
  }
  EXPECT_EQ(with("dhcp = on", "dhcp = yes").error(), "line 2: dhcp has no such value");
  EXPECT_FALSE(with("line = auto", "line = 1000_full"));
  EXPECT_FALSE(with("address = 0.0.0.0", "address = 0.0.0"));
}

TEST(FrA7neBoard, FailureTakesItOffTheNetwork) {
  Rig r;
  r.start();
  EXPECT_TRUE(r.board.can_fail());
  r.board.set_failed(r.now, true);
  EXPECT_EQ(r.channel().address(), 0u);
  EXPECT_EQ(r.lamps(), "red, green flashing, green");
  EXPECT_TRUE(r.drive.option_failed);
}

TEST(FrA7neBoard, ChangeOfTheFlashIsToldOnceAndActsFromTheNextStart) {
  Rig r;
  r.start();
  EXPECT_FALSE(r.board.take_flash_changed());
  Flash flash;
  flash.dhcp = false;
  flash.ip.address = 0x0a000001;
  ASSERT_TRUE(r.board.load_flash(flash_text(flash)));
  EXPECT_FALSE(r.board.take_flash_changed()) << "its owner has this one";
  EXPECT_EQ(r.channel().address(), 0x7f000002u);
  r.board.handle_power(r.now, false);
  r.start();
  EXPECT_EQ(r.channel().address(), 0x0a000001u);
  // Host name, 0xF5 attribute 6.
  const Bytes request = [] {
    Bytes b{0x10, 3, 0x20, 0xf5, 0x24, 1, 0x30, 6, 2, 0, 'm', '1'};
    return b;
  }();
  cip::Reply reply;
  const auto parsed = cip::parse_request(request);
  ASSERT_TRUE(parsed.request);
  static_cast<void>(r.channel().cip_device().router().handle(r.now, *parsed.request, reply));
  EXPECT_TRUE(r.board.take_flash_changed());
  EXPECT_FALSE(r.board.take_flash_changed());
  EXPECT_NE(r.board.flash_text().find("host_name = m1\n"), std::string::npos);
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
