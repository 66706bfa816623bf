// FR-A700 with FR-A7NE in a plant, in virtual time: reached at the address of the plant file, with faults on its wires,
// over power cycles, and through snapshots. FR-A7NE manual, 4.2, 4.5, 4.6, chapter 8.
#include <gtest/gtest.h>

#include "sim/rig/commands.hpp"
#include "tests/sim/rig/memory_scanner.hpp"

namespace vinv::rig {
namespace {

using namespace std::chrono_literals;
using test::MemoryScanner;

constexpr std::uint32_t kFirst = ipv4(127, 0, 0, 2), kSecond = ipv4(127, 0, 0, 3);
const std::string kTwo =
    "drives:\n"
    "  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K }, board: { timing: fast },\n"
    "      parameters: { Pr.7: 0.5, Pr.8: 0.5, Pr.340: 10 } }\n"
    "  - { name: b, inverter: { family: fr-a700, model: FR-A740-1.5K }, board: { timing: fast } }\n";

struct Stage {
  explicit Stage(const std::string& text = kTwo) {
    PlantOptions options;
    options.catalogue = shipped_catalogue();
    plant = std::make_unique<Plant>(parse_plant_file(text, "p.yaml", options.catalogue), scheduler, options);
    plant->start();
    while (!plant->settled()) scheduler.run_until(scheduler.now() + 10ms);
    scheduler.run_until(scheduler.now() + 50ms);
  }
  std::string command(const char* name, const char* drive, const std::vector<std::string>& words) {
    const auto done = execute_words(*plant, name, drive, words);
    return done ? done->dump() : done.error().message;
  }
  std::string led(const char* drive, const char* lamp) {
    const auto done = execute_words(*plant, "led", drive, {});
    return done ? (*done)[lamp].get<std::string>() : done.error().message;
  }
  std::string alarm(const char* drive) { return plant->find(drive)->inverter->alarm_name(); }
  double hz(const char* drive) {
    for (const auto& s : plant->find(drive)->inverter->signals())
      if (s.name == "output_frequency") return s.value;
    return -1;
  }
  kernel::Scheduler scheduler;
  std::unique_ptr<Plant> plant;
};

TEST(EthernetPlant, DrivesAreFoundAtTheirAddressesAndSayWhoTheyAre) {
  Stage s;
  MemoryScanner one(*s.plant, kFirst), two(*s.plant, kSecond, ipv4(192, 168, 1, 2)),
      none(*s.plant, ipv4(127, 0, 0, 4), ipv4(192, 168, 1, 3));
  ASSERT_TRUE(one.connect());
  ASSERT_TRUE(two.connect());
  EXPECT_FALSE(none.connect());
  EXPECT_EQ(one.get(1, 1, 1), "A1 00");
  EXPECT_EQ(one.get(1, 1, 6), "02 00 00 7F");
  EXPECT_EQ(two.get(1, 1, 6), "03 00 00 7F");
  EXPECT_EQ(two.get(0xf6, 1, 3), "02 00 7F 00 00 03");
  // DHCP with the plant file's address as lease.
  EXPECT_EQ(one.get(0xf5, 1, 5).substr(0, 23), "02 00 00 7F 00 00 00 FF");
  EXPECT_EQ(s.led("a", "NS"), "green flashing");
  EXPECT_EQ(s.led("a", "MS"), "green flashing");
  EXPECT_EQ(s.led("a", "LINK/ACT"), "green flashing");
  s.scheduler.run_until(s.scheduler.now() + 100ms);
  EXPECT_EQ(s.led("a", "LINK/ACT"), "green");
}

TEST(EthernetPlant, ListIdentityGoesToAllByBroadcastAndToOneByItsAddress) {
  Stage s;
  std::vector<std::uint32_t> answered;
  const auto udp = std::move(*s.plant->datagrams().open({ipv4(127, 9, 9, 9), 40'000}));
  udp->set_handler([&](Instant, const Ipv4Endpoint& from, ByteView) { answered.push_back(from.address); });
  udp->send(s.plant->now(), {kSecond, 44818}, test::encapsulated(0x63, 0, {}));
  s.scheduler.run_until(s.scheduler.now() + 10ms);
  EXPECT_EQ(answered, std::vector{kSecond});
  answered.clear();
  udp->send(s.plant->now(), {ipv4(127, 255, 255, 255), 44818}, test::encapsulated(0x63, 0, {}));
  s.scheduler.run_until(s.scheduler.now() + 10ms);
  EXPECT_EQ(answered, (std::vector{kFirst, kSecond}));
}

TEST(EthernetPlant, OwnerRunsTheMotorAndStopsItAgain) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.output = {0x61, 0, 0xb0, 0x04};  // NetCtrl, NetRef, forward; 1200 rpm
  scanner.run_for(2s);
  EXPECT_NEAR(s.hz("a"), 40, 0.1);
  ASSERT_EQ(scanner.input.size(), 4u);
  EXPECT_EQ(scanner.input[0] & 0x04, 0x04);
  EXPECT_EQ(read_le16(scanner.input, 2), 1200);
  EXPECT_EQ(s.led("a", "NS"), "green");
  EXPECT_EQ(s.hz("b"), 0);
  scanner.output = {0x60, 0, 0xb0, 0x04};
  scanner.run_for(2s);
  EXPECT_EQ(s.hz("a"), 0);
}

// 4.5.1: no link is a line error at once; Pr.502 = 0: the motor coasts, E.OP3.
TEST(EthernetPlant, PulledCableTripsTheDriveAndTheSessionOutlivesIt) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.output = {0x61, 0, 0xb0, 0x04};
  scanner.run_for(1s);
  const std::uint64_t before = scanner.packets;
  EXPECT_EQ(s.command("link", "a", {"down"}), "\"down\"");
  scanner.run_for(5ms);
  EXPECT_EQ(s.alarm("a"), "E.OP3");
  EXPECT_EQ(s.alarm("b"), "");
  EXPECT_EQ(s.led("a", "LINK/ACT"), "off");
  scanner.run_for(500ms);
  EXPECT_LE(scanner.packets, before + 1);
  EXPECT_EQ(s.led("a", "NS"), "red flashing");  // the connection has timed out
  // A question is held back like a repeated segment, and answered when the cable is in again.
  EXPECT_EQ(scanner.get(1, 1, 1), "nothing");
  EXPECT_EQ(s.command("wire", "a", {"plugged"}).find("refused"), std::string::npos);
  scanner.run_for(10ms);
  EXPECT_FALSE(scanner.closed);
  EXPECT_EQ(scanner.get(1, 1, 1), "A1 00");
  EXPECT_TRUE(scanner.own());
  EXPECT_EQ(s.led("a", "NS"), "green");
}

// 4.5.2: an error of the option itself; nobody reaches it until it is mended and started anew.
TEST(EthernetPlant, FailedOptionIsSilentAndTheDriveHasE3) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.run_for(100ms);
  EXPECT_NE(s.command("names", "a", {}).find("\"option_failure\""), std::string::npos);
  EXPECT_EQ(s.command("fault", "a", {"option_failure=on"}).find("refused"), std::string::npos);
  scanner.run_for(10ms);
  EXPECT_EQ(s.alarm("a"), "E.3");
  EXPECT_EQ(s.alarm("b"), "");
  EXPECT_EQ(s.led("a", "MS"), "red");
  EXPECT_TRUE(scanner.closed);
  MemoryScanner again(*s.plant, kFirst, ipv4(192, 168, 1, 7));
  EXPECT_FALSE(again.connect());
  s.command("fault", "a", {"option_failure=off"});
  s.command("reset", "a", {});
  s.scheduler.run_until(s.scheduler.now() + 2s);
  EXPECT_EQ(s.alarm("a"), "");
  EXPECT_EQ(s.led("a", "MS"), "green flashing");
  EXPECT_TRUE(again.connect());
  EXPECT_EQ(s.plant->find("a")->inverter->get_parameter("Pr.501").value(), 0) << "no line error";
}

TEST(EthernetPlant, ShortInterruptionIsBridged) {
  Stage s(
      "drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K },\n"
      "      parameters: { Pr.340: 10, Pr.500: 5 } }\n");
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.output = {0x61, 0, 0xb0, 0x04};
  scanner.run_for(1s);
  s.command("link", "a", {"down"});
  scanner.run_for(30ms);  // time-out after 80 ms
  s.command("link", "a", {"up"});
  scanner.run_for(200ms);
  EXPECT_EQ(s.alarm("a"), "");
  const std::uint64_t before = scanner.packets;
  scanner.run_for(100ms);
  EXPECT_EQ(scanner.packets, before + 10);
}

TEST(EthernetPlant, PowerCycleEndsEverythingAndTheDriveComesBack) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.run_for(100ms);
  s.command("power", "a", {"off"});
  scanner.run_for(20s);  // the control supply lives as long as the DC link
  EXPECT_TRUE(scanner.closed);
  EXPECT_EQ(s.led("a", "NS"), "off");
  EXPECT_FALSE(MemoryScanner(*s.plant, kFirst, ipv4(192, 168, 1, 7)).connect());
  s.command("power", "a", {"on"});
  scanner.run_for(3s);
  ASSERT_TRUE(scanner.connect());
  EXPECT_EQ(scanner.get(1, 1, 1), "A1 00");
  EXPECT_TRUE(scanner.own()) << "the owner from before is forgotten";
}

// Without bit 11 of Pr.540 an inverter reset is one of the option too (4.2.5).
TEST(EthernetPlant, InverterResetDropsSessionsUnlessPr540KeepsThem) {
  for (const bool keeps : {false, true}) {
    Stage s(
        "drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K }, board: { timing: fast },\n"
        "      parameters: { Pr.340: 10, Pr.540: " +
        std::string(keeps ? "2048" : "0") + " } }\n");
    MemoryScanner scanner(*s.plant, kFirst);
    ASSERT_TRUE(scanner.connect());
    s.command("reset", "a", {});
    scanner.run_for(3s);
    EXPECT_EQ(scanner.closed, !keeps);
    EXPECT_TRUE(keeps ? scanner.get(1, 1, 1) == "A1 00" : scanner.connect());
  }
}

TEST(EthernetPlant, LostDatagramsAreCountedAndThoseOfTheMasterTimeTheOwnerOut) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.run_for(100ms);
  const std::uint64_t before = scanner.packets;
  s.command("wire", "a", {"drop=on", "every=2", "of=own", "port=udp"});
  scanner.run_for(200ms);
  EXPECT_EQ(scanner.packets, before + 10);
  EXPECT_EQ(s.alarm("a"), "");
  s.command("wire", "a", {"none"});
  s.command("wire", "a", {"silence=on", "port=udp"});
  scanner.run_for(200ms);
  EXPECT_EQ(s.alarm("a"), "E.OP3");
  EXPECT_EQ(scanner.get(1, 1, 1), "A1 00") << "TCP is another wire";
}

TEST(EthernetPlant, DelayedDatagramsComeSoMuchLater) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.run_for(101ms);
  scanner.heard.clear();
  s.command("wire", "a", {"delay=7", "ms", "of=own", "port=udp"});
  scanner.run_for(25ms);
  const std::int64_t first = std::stoll(scanner.heard);
  // Deadlines of production lie 10 ms apart; 0.1 ms is the wire's own.
  s.command("wire", "a", {"none"});
  scanner.heard.clear();
  scanner.run_for(30ms);
  const std::int64_t later = std::stoll(scanner.heard.substr(scanner.heard.rfind('\n', scanner.heard.size() - 2) + 1));
  EXPECT_EQ((later - first) % 10'000'000, 3'000'000);
}

TEST(EthernetPlant, AddressThatAnotherDriveHasIsADuplicate) {
  Stage s(
      "drives:\n"
      "  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K } }\n"
      "  - { name: b, power: off, inverter: { family: fr-a700, model: FR-A740-1.5K },\n"
      "      board: { lease: { address: 127.0.0.2 } } }\n");
  s.command("power", "b", {"on"});
  s.scheduler.run_until(s.scheduler.now() + 3s);
  EXPECT_EQ(s.led("b", "NS"), "red");
  EXPECT_EQ(s.led("a", "NS"), "green flashing");
  EXPECT_FALSE(MemoryScanner(*s.plant, kSecond).connect());
}

TEST(EthernetPlant, CableOfADuplicateIsNoticedWhenItIsPluggedIn) {
  Stage s(
      "drives:\n"
      "  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K } }\n"
      "  - { name: b, power: off, inverter: { family: fr-a700, model: FR-A740-1.5K },\n"
      "      board: { lease: { address: 127.0.0.2 } } }\n");
  s.command("link", "b", {"down"});
  s.command("power", "b", {"on"});
  s.scheduler.run_until(s.scheduler.now() + 3s);
  EXPECT_NE(s.led("b", "NS"), "red");
  s.command("link", "b", {"up"});
  s.scheduler.run_until(s.scheduler.now() + 100ms);
  EXPECT_EQ(s.led("b", "NS"), "red");
  EXPECT_EQ(s.led("a", "NS"), "green flashing");
}

// 1.2 (1), chapter 8: until the cause is gone and the inverter is reset.
TEST(EthernetPlant, ForeignDeviceWithTheAddressTakesItAway) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst), other(*s.plant, kSecond, ipv4(192, 168, 1, 2));
  ASSERT_TRUE(scanner.connect() && scanner.own() && other.connect());
  scanner.output = {0x61, 0, 0xb0, 0x04};
  scanner.run_for(1s);
  EXPECT_NE(s.command("wire", "a", {"none"}).find(R"("duplicate_node":false)"), std::string::npos);
  EXPECT_NE(s.command("wire", "a", {"duplicate_node", "on"}).find(R"("duplicate_node":true)"), std::string::npos);
  scanner.run_for(10ms);
  EXPECT_TRUE(scanner.closed);
  EXPECT_EQ(s.led("a", "NS"), "red");
  EXPECT_EQ(s.alarm("a"), "E.OP3") << "the owner's data stays away";
  EXPECT_EQ(other.get(1, 1, 1), "A1 00") << "the neighbour has its own address";
  EXPECT_FALSE(MemoryScanner(*s.plant, kFirst, ipv4(192, 168, 1, 3)).connect());
  s.command("wire", "a", {"duplicate_node", "off"});
  s.scheduler.run_until(s.scheduler.now() + 1s);
  EXPECT_EQ(s.led("a", "NS"), "red") << "not before the next start";
  s.command("wire", "a", {"duplicate_node", "on"});
  s.command("reset", "a", {});
  s.scheduler.run_until(s.scheduler.now() + 3s);
  EXPECT_EQ(s.led("a", "NS"), "red") << "it is there still";
  s.command("wire", "a", {"none"});
  s.command("reset", "a", {});
  s.scheduler.run_until(s.scheduler.now() + 3s);
  EXPECT_EQ(s.led("a", "NS"), "green flashing");
  EXPECT_TRUE(MemoryScanner(*s.plant, kFirst, ipv4(192, 168, 1, 3)).connect());
}

TEST(EthernetPlant, CableThatComesBackToAForeignDeviceIsNoNewStart) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect());
  s.command("link", "a", {"down"});
  s.command("wire", "a", {"duplicate_node"});
  s.scheduler.run_until(s.scheduler.now() + 100ms);
  EXPECT_NE(s.led("a", "NS"), "red") << "nobody is seen without a cable";
  s.command("wire", "a", {"duplicate_node", "off"});
  s.command("link", "a", {"up"});
  s.scheduler.run_until(s.scheduler.now() + 100ms);
  EXPECT_EQ(scanner.get(1, 1, 1), "A1 00") << "the session has outlived it";
  s.command("link", "a", {"down"});
  s.command("wire", "a", {"duplicate_node"});
  s.command("link", "a", {"up"});
  s.scheduler.run_until(s.scheduler.now() + 100ms);
  EXPECT_EQ(s.led("a", "NS"), "red");
  EXPECT_TRUE(scanner.closed);
}

TEST(EthernetPlant, ForeignDeviceIsThereOrNot) {
  Stage s;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"duplicate_node", "50", "%"},
                                                {"duplicate_node", "on", "nth", "3"},
                                                {"duplicate_node", "on", "for", "2", "s"},
                                                {"duplicate_node", "on", "port", "tcp"}})
    EXPECT_NE(s.command("wire", "a", words).find("duplicate_node"), std::string::npos) << s.command("wire", "a", words);
  EXPECT_NE(s.command("wire", "a", {"duplicate_node", "on", "port", "ethernet"}).find("true"), std::string::npos);
  EXPECT_EQ(s.led("a", "NS"), "red");
}

// 4.2.5: a fixed full-duplex end and an automatic one do not come together.
TEST(EthernetPlant, CableEndsThatDoNotAgreeHaveNoLink) {
  Stage s(
      "drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K }, board: { link_partner: 100_full },\n"
      "      parameters: { Pr.340: 10 } }\n");
  EXPECT_EQ(s.led("a", "LINK/ACT"), "off");
  EXPECT_FALSE(MemoryScanner(*s.plant, kFirst).connect());
  EXPECT_EQ(s.alarm("a"), "") << "chapter 8: 0.00 and a dark lamp";
}

TEST(EthernetPlant, FlashOfThePlantFileCountsFromTheFirstStart) {
  Stage s(
      "drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K },\n"
      "      board: { flash: { address: 192.168.0.9, gateway: 192.168.0.1, host_name: mixer, line: 100_half },\n"
      "               link_partner: 100_half } }\n");
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect()) << "reached at the address of the plant file all the same";
  EXPECT_EQ(scanner.get(0xf5, 1, 5).substr(0, 35), "09 00 A8 C0 00 FF FF FF 01 00 A8 C0");
  EXPECT_EQ(scanner.get(0xf5, 1, 6), "05 00 6D 69 78 65 72 00");
  EXPECT_EQ(scanner.get(0xf6, 1, 1), "64 00 00 00");
}

TEST(EthernetPlant, ParametersGiveTheAddressWhenPr540SaysSo) {
  Stage s(
      "drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K },\n"
      "      parameters: { Pr.540: 3, Pr.434: 10, Pr.435: 1, Pr.436: 2, Pr.437: 3, Pr.438: 255, Pr.439: 255 } }\n");
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect());
  EXPECT_EQ(scanner.get(0xf5, 1, 5).substr(0, 23), "03 02 01 0A 00 00 FF FF");
}

TEST(EthernetPlant, NoAddressIsNoAdapter) {
  Stage s("drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K }, parameters: { Pr.540: 3 } }\n");
  EXPECT_FALSE(MemoryScanner(*s.plant, kFirst).connect());
  EXPECT_EQ(s.led("a", "NS"), "off");
  EXPECT_EQ(s.led("a", "MS"), "green flashing");
}

// Chapter 8.
TEST(EthernetPlant, WrongConnectorAndBadContactAreOptionFaults) {
  const auto alarm_with = [](const std::string& board) {
    Stage s("drives:\n  - { name: a, inverter: { family: fr-a700, model: FR-A740-1.5K }, board: { " + board + " } }\n");
    s.scheduler.run_until(s.scheduler.now() + 200ms);
    return s.alarm("a");
  };
  EXPECT_EQ(alarm_with("connector: 1"), "E.1");
  EXPECT_EQ(alarm_with("connector: 2"), "E.2");
  EXPECT_EQ(alarm_with("connector: 3"), "");
  EXPECT_EQ(alarm_with("contact: bad"), "E.3");
}

// --- snapshots ---

struct Whole {
  Plant& plant;
  MemoryScanner& scanner;
  friend void archive(Archive& a, Whole& whole) {
    a.io(whole.plant);
    whole.scanner.archive_state(a);
    whole.plant.streams().archive_owners(a);
    whole.plant.scheduler().archive_waiting(a);
  }
};

TEST(EthernetPlant, SnapshotHoldsOpenConnectionsAndGoesOnByteForByte) {
  Stage s;
  MemoryScanner scanner(*s.plant, kFirst);
  ASSERT_TRUE(scanner.connect() && scanner.own());
  scanner.output = {0x61, 0, 0xb0, 0x04};
  s.command("wire", "a", {"delay=7", "ms", "share=30", "%"});
  s.command("wire", "a", {"corrupt=5", "%", "of=own", "port=udp"});
  scanner.run_to(Instant{} + 2300ms);
  while (!s.plant->snapshot_objection().empty()) scanner.run_for(1ms);
  Whole whole{*s.plant, scanner};
  Bytes saved;
  save_snapshot(whole, saved);
  const auto story = [](Stage& stage, MemoryScanner& m) {
    m.heard.clear();
    m.run_for(250ms);
    m.output = {0x60, 0, 0xb0, 0x04};
    m.run_for(150ms);
    stage.command("link", "a", {"down"});
    m.run_for(20ms);
    stage.command("link", "a", {"up"});
    m.run_for(300ms);
    return m.heard + m.get(0x29, 1, 3) + m.get(1, 1, 6) + stage.alarm("a") + std::to_string(stage.hz("a"));
  };
  const std::string first = story(s, scanner);
  EXPECT_GT(first.size(), 1000u);

  Stage other;
  MemoryScanner second(*other.plant, kFirst);
  ASSERT_TRUE(second.connect());
  other.scheduler.run_until(other.scheduler.now() + 10ms);
  while (!other.plant->snapshot_objection().empty()) second.run_for(1ms);
  Whole into{*other.plant, second};
  const auto loaded = load_snapshot(into, saved);
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(story(other, second), first);
  // And in the plant that went on meanwhile.
  while (!s.plant->snapshot_objection().empty()) scanner.run_for(1ms);
  ASSERT_TRUE(load_snapshot(whole, saved));
  EXPECT_EQ(story(s, scanner), first);
}

}  // namespace
}  // namespace vinv::rig
