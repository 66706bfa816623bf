#include "sim/rig/plant.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/sim/rig/fakes.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;

class PlantTest : public testing::Test {
 protected:
  std::unique_ptr<Plant> plant(const std::string& text) {
    const Catalogue catalogue = test::fake_catalogue(journal_);
    PlantOptions options;
    options.catalogue = catalogue;
    options.stored_eeprom = [this](const std::string& drive) {
      const auto it = eeproms_.find(drive);
      return it == eeproms_.end() ? std::nullopt : std::optional(it->second);
    };
    options.damaged_eeprom = [this](const std::string& drive, const std::string& reason) { damaged_[drive] = reason; };
    return std::make_unique<Plant>(parse_plant_file(text, "p.yaml", catalogue), scheduler_, std::move(options));
  }
  void run_ms(int ms) { scheduler_.run_until(scheduler_.now() + milliseconds(ms)); }
  static test::FakeBoard& board(Plant& p, std::size_t i) {
    return dynamic_cast<test::FakeBoard&>(*p.drives()[i]->board);
  }

  // The scheduler outlives the plants; they are made and destroyed inside a test.
  kernel::Scheduler scheduler_;
  test::Journal journal_;
  std::map<std::string, std::string> eeproms_;
  std::map<std::string, std::string> damaged_;
};

constexpr const char* kTwoDrives =
    "drives:\n"
    "  - name: b\n    inverter: { model: FR-E540-0.4K }\n"
    "  - name: a\n    inverter: { model: FR-E540-1.5K }\n";

TEST_F(PlantTest, DrivesTickEachPeriodInTheOrderOfTheFile) {
  const auto p = plant(kTwoDrives);
  p->start();
  journal_.clear();
  run_ms(2);
  EXPECT_EQ(journal_, (test::Journal{"FR-E540-0.4K tick 1", "FR-E540-1.5K tick 1", "FR-E540-0.4K tick 2",
                                     "FR-E540-1.5K tick 2"}));
  EXPECT_EQ(p->ticks(), 2u);
  EXPECT_EQ(board(*p, 0).drive_ticks, 2);
}

TEST_F(PlantTest, PowerReachesTheBoardAndDrivesThatAreOffStayOff) {
  const auto p = plant("drives:\n  - {}\n  - { power: off }\n");
  p->start();
  EXPECT_EQ(journal_, (test::Journal{"FR-E540-1.5K power on", "board 1 power on"}));
  journal_.clear();
  p->set_power(*p->drives()[0], false);
  EXPECT_EQ(journal_, (test::Journal{"FR-E540-1.5K power off", "board 1 power off"}));
}

TEST_F(PlantTest, ParametersAreFirstValuesANodeIsAFactoryValueAndAStoredEepromWins) {
  const char* text = "drives:\n  - name: a\n    board: { node: 17 }\n    parameters: { Pr.7: 2.5 }\n";
  {
    const auto p = plant(text);
    EXPECT_DOUBLE_EQ(*p->drives()[0]->inverter->get_parameter("Pr.7"), 2.5);
    EXPECT_DOUBLE_EQ(*p->drives()[0]->inverter->get_parameter("Pr.345"), 17);
  }
  eeproms_["a"] = "Pr.7: 9.5\n";
  const auto p = plant(text);
  EXPECT_DOUBLE_EQ(*p->drives()[0]->inverter->get_parameter("Pr.7"), 9.5);
  EXPECT_TRUE(damaged_.empty());
}

TEST_F(PlantTest, ADamagedEepromIsReportedAndFactoryValuesCount) {
  eeproms_["a"] = "garbage";
  const auto p = plant("drives:\n  - name: a\n    parameters: { Pr.7: 2.5 }\n");
  EXPECT_EQ(damaged_.at("a"), "line 1: no parameter.");
  EXPECT_DOUBLE_EQ(*p->drives()[0]->inverter->get_parameter("Pr.7"), 5);
  EXPECT_DOUBLE_EQ(*p->drives()[0]->inverter->get_parameter("Pr.345"), 1);
}

TEST_F(PlantTest, ChangedEepromsAreHandedOutOnce) {
  const auto p = plant(kTwoDrives);
  p->start();
  std::vector<std::string> stored;
  const auto store = [&](const std::string& drive, const std::string& text) { stored.push_back(drive + " " + text); };
  p->collect_eeproms(store);  // the presets of the node
  stored.clear();
  p->collect_eeproms(store);
  EXPECT_TRUE(stored.empty());
  ASSERT_TRUE(p->drives()[1]->inverter->set_parameter("Pr.7", 3));
  p->collect_eeproms(store);
  EXPECT_EQ(stored, (std::vector<std::string>{"a Pr.7: 3.000000\n"}));
}

std::string refusal_of(const std::function<void()>& build) {
  try {
    build();
  } catch (const PlantFileError& e) {
    return e.what();
  }
  return "accepted";
}

TEST_F(PlantTest, WhatADriveRefusesOfTheFileIsToldWithItsPlace) {
  const auto told = [&](const std::string& text) { return refusal_of([&] { plant(text); }); };
  EXPECT_EQ(told("drives:\n  - terminals: { STG: on }\n"),
            "p.yaml:2:18: drive_1: there is no terminal STG. Did you mean \"STF\"?");
  EXPECT_EQ(told("drives:\n  - analog: { 9: 5 }\n"), "p.yaml:2:15: drive_1: there is no analog terminal 9.");
  EXPECT_EQ(told("drives:\n  - parameters:\n      Pr.7: 1\n      Pr.4000: 1\n"),
            "p.yaml:4:7: drive_1: there is no parameter Pr.4000.");
  EXPECT_EQ(told("drives:\n  - parameters: { Pr.7: 9999 }\n"), "p.yaml:2:19: drive_1: Pr.7 allows 0 to 3600.");
  EXPECT_EQ(told("drives:\n  - parameters: { Pr.7: 9999, Pr.4000: 1 }\n    terminals: { STG: on }\n"
                 "  - board: { node: 3 }\n    analog: { 9: 5 }\n"),
            "p.yaml:2:19: drive_1: Pr.7 allows 0 to 3600.\n"
            "p.yaml:2:31: drive_1: there is no parameter Pr.4000.\n"
            "p.yaml:3:18: drive_1: there is no terminal STG. Did you mean \"STF\"?\n"
            "p.yaml:5:15: drive_2: there is no analog terminal 9.");
  EXPECT_EQ(told("drives:\n  - board: { node: 100 }\n"), "p.yaml:2:20: drive_1: node 100; allowed: 1 to 99.");
}

// --- wires ---

TEST_F(PlantTest, SerialBytesReachTheBoardAtOnceAndItsAnswerLeavesAtItsDeadline) {
  const auto p = plant("drives: [{}]\n");
  const auto far = std::make_shared<test::FakeStream::Far>();
  p->connect_serial(0, std::make_unique<test::FakeStream>(far));
  p->start();
  run_ms(10);
  const Instant now = scheduler_.now() + std::chrono::microseconds(300);
  scheduler_.run_until(now);
  far->on_bytes(now, Bytes{1, 2}, false);
  run_ms(1);
  EXPECT_TRUE(far->sent.empty());
  run_ms(1);
  ASSERT_EQ(far->sent.size(), 1u);
  EXPECT_EQ(far->sent[0].second, (Bytes{2, 3}));
  EXPECT_EQ(far->sent[0].first, now + milliseconds(2)) << "at the deadline, not at the next tick";
}

TEST_F(PlantTest, ALineErrorOrAnotherSpeedIsSilence) {
  const auto p = plant("drives: [{}]\n");
  const auto far = std::make_shared<test::FakeStream::Far>();
  std::optional<std::uint32_t> baud;
  std::vector<std::uint32_t> settings;
  LineOptions options;
  options.far_end_baud = [&] { return baud; };
  options.on_settings = [&](const boards::LineSettings& s) { settings.push_back(s.baud); };
  p->connect_serial(0, std::make_unique<test::FakeStream>(far), options);
  p->start();
  run_ms(1);
  const auto answers = [&](bool error) {
    far->sent.clear();
    far->on_bytes(scheduler_.now(), Bytes{1}, error);
    run_ms(5);
    return far->sent.size();
  };
  EXPECT_EQ(answers(false), 1u) << "no speed set yet: taken as right";
  EXPECT_EQ(answers(true), 0u);
  baud = 19200;
  EXPECT_EQ(answers(false), 0u);
  board(*p, 0).line.baud = 19200;
  EXPECT_EQ(answers(false), 1u);
  EXPECT_EQ(settings, (std::vector<std::uint32_t>{9600, 19200})) << "the carrier follows the board";
}

TEST_F(PlantTest, BoardsOnOneLineAllHearIt) {
  const auto p = plant(
      "networks: { bus: { serial: pty } }\ndrives:\n  - board: { modbus_rtu: bus }\n  - board: { modbus_rtu: bus }\n");
  const auto far = std::make_shared<test::FakeStream::Far>();
  p->connect_serial(0, std::make_unique<test::FakeStream>(far));
  p->start();
  far->on_bytes(scheduler_.now(), Bytes{1}, false);
  run_ms(5);
  EXPECT_EQ(far->sent.size(), 2u);
}

TEST_F(PlantTest, ABoardWithoutPowerDoesNotAnswer) {
  const auto p = plant("drives: [ { power: off } ]\n");
  const auto far = std::make_shared<test::FakeStream::Far>();
  p->connect_serial(0, std::make_unique<test::FakeStream>(far));
  p->start();
  far->on_bytes(scheduler_.now(), Bytes{1}, false);
  run_ms(10);
  EXPECT_TRUE(far->sent.empty());
}

Bytes adu(std::uint8_t unit, const Bytes& pdu, std::uint8_t transaction = 1) {
  Bytes out;
  append_be16(out, transaction);
  append_be16(out, 0);
  append_be16(out, static_cast<std::uint16_t>(pdu.size() + 1));
  out.push_back(unit);
  for (const std::uint8_t byte : pdu) out.push_back(byte);
  return out;
}

TEST_F(PlantTest, TcpRequestsAreRoutedByUnitAndAnsweredAfterTheDrivesTick) {
  const auto p = plant("drives: [ { board: { node: 5 } }, { board: { node: 6 } } ]\n");
  const auto far = std::make_shared<test::FakeStream::Far>();
  p->accept_tcp(0, scheduler_.now(), std::make_unique<test::FakeStream>(far));
  p->start();
  run_ms(1);
  far->on_bytes(scheduler_.now(), adu(6, {3, 0, 0, 0, 1}), false);
  EXPECT_TRUE(far->sent.empty());
  run_ms(1);
  ASSERT_EQ(far->sent.size(), 1u);
  EXPECT_EQ(far->sent[0].second, adu(6, {3, 0, 0, 0, 1}));
}

TEST_F(PlantTest, AClientThatSendsOneByteAtATimeDelaysNobody) {
  const auto p = plant("drives: [{}]\n");
  const auto slow = std::make_shared<test::FakeStream::Far>();
  const auto fast = std::make_shared<test::FakeStream::Far>();
  p->accept_tcp(0, scheduler_.now(), std::make_unique<test::FakeStream>(slow));
  p->accept_tcp(0, scheduler_.now(), std::make_unique<test::FakeStream>(fast));
  p->start();
  run_ms(1);
  const Bytes request = adu(1, {3, 0, 0, 0, 1});
  for (std::size_t i = 0; i < request.size(); ++i) {  // one byte per second
    slow->on_bytes(scheduler_.now(), ByteView(request).subspan(i, 1), false);
    fast->sent.clear();
    fast->on_bytes(scheduler_.now(), request, false);
    run_ms(2);
    ASSERT_EQ(fast->sent.size(), 1u) << "byte " << i;
    run_ms(998);
  }
  EXPECT_EQ(slow->sent.size(), 1u);
  EXPECT_EQ(p->ticks(), 1u + 1000u * request.size());
}

TEST_F(PlantTest, ConnectionsThatEndAreForgottenAndOtherProtocolsAreCut) {
  const auto p = plant("drives: [{}]\n");
  const auto gone = std::make_shared<test::FakeStream::Far>();
  const auto http = std::make_shared<test::FakeStream::Far>();
  p->accept_tcp(0, scheduler_.now(), std::make_unique<test::FakeStream>(gone));
  p->accept_tcp(0, scheduler_.now(), std::make_unique<test::FakeStream>(http));
  p->start();
  gone->on_bytes(scheduler_.now(), adu(1, {3, 0, 0, 0, 1}), false);
  gone->on_closed(scheduler_.now(), "the peer left");
  const std::string text = "GET / HTTP/1.1\r\n\r\n";
  http->on_bytes(scheduler_.now(), ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), false);
  EXPECT_TRUE(http->closed);
  run_ms(5);
  EXPECT_TRUE(gone->sent.empty());
}

TEST_F(PlantTest, ADestroyedPlantLeavesNothingInTheScheduler) {
  {
    const auto p = plant(kTwoDrives);
    p->start();
    run_ms(3);
  }
  EXPECT_EQ(scheduler_.waiting(), 0u);
}

}  // namespace
}  // namespace vinv::rig
