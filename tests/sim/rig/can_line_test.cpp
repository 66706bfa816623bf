// A plant's CAN buses in virtual time: stand-ins for the boards, and a master that is a node like them.
#include "sim/rig/can_line.hpp"

#include <gtest/gtest.h>

#include "sim/rig/commands.hpp"
#include "sim/rig/plant.hpp"
#include "tests/sim/rig/fakes.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;
using test::FakeBoard;
using transports::CanState;

class CanLineTest : public testing::Test {
 protected:
  void start(const std::string& text) {
    PlantOptions options;
    options.catalogue = test::fake_catalogue(journal_);
    plant_ = std::make_unique<Plant>(parse_plant_file(text, "p.yaml", options.catalogue), scheduler_, options);
    master_ = plant_->can_line(0).bus().attach(scheduler_.now(), {.name = "master"});
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant at, const CanFrame& f) { heard_.push_back(f.id), times_.push_back(at); };
    master_->set_handlers(std::move(handlers));
    plant_->start();
    run_ms(2);
  }
  void run_ms(int ms) { scheduler_.run_until(scheduler_.now() + milliseconds(ms)); }
  void send(std::uint32_t id) { master_->send(scheduler_.now(), CanFrame::standard(id, {1})); }
  FakeBoard& board(const std::string& drive) { return dynamic_cast<FakeBoard&>(*plant_->find(drive)->board); }
  CanState state(const std::string& drive) {
    return plant_->can_line_of(*plant_->find(drive))->controller(*plant_->find(drive)->controller).status().state;
  }
  Json command(const std::string& drive, const std::string& name, const std::vector<std::string>& words) {
    const auto r = execute_words(*plant_, name, drive, words);
    return r ? *r : Json(r.error().message);
  }

  test::Journal journal_;
  kernel::Scheduler scheduler_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<transports::CanNode> master_;
  std::vector<std::uint32_t> heard_;
  std::vector<Instant> times_;
};

constexpr const char* kTwo =
    "networks: { line: { can: virtual, bitrate: 500k } }\n"
    "drives:\n  - { name: a, board: { node: 5, network: line } }\n  - { name: b, board: { node: 6, network: line } }\n";

TEST_F(CanLineTest, FramesReachEveryBoardAndWhatTheyAnswerGoesOutInItsFrameTime) {
  start(kTwo);
  board("a").can.rate = board("b").can.rate = 500'000;
  run_ms(1);
  const Instant before = scheduler_.now();
  send(0x100);
  run_ms(1);
  // Both give the same answer at once, which is one frame on the wire.
  ASSERT_EQ(heard_.size(), 1u);
  EXPECT_EQ(heard_[0], 0x101u);
  EXPECT_EQ(board("a").can.heard.front().id, 0x100u);
  EXPECT_EQ(board("b").can.heard.front().id, 0x100u);
  // Two frames of one byte: about 55 bits each at 2 us.
  EXPECT_GT(times_[0] - before, std::chrono::microseconds(200));
  EXPECT_LT(times_[0] - before, std::chrono::microseconds(300));
}

TEST_F(CanLineTest, TheBitRateOfTheNetworkIsAFactoryValueOfTheParameterThatSetsIt) {
  start(kTwo);
  EXPECT_EQ(plant_->find("a")->inverter->get_parameter("Pr.346").value_or(0), 0x82);
}

TEST_F(CanLineTest, ABoardWithAnotherBitRateHearsNothingAndEndsBusOffWhenItSends) {
  start(kTwo);
  board("a").can.rate = 500'000;
  run_ms(5);
  board("b").can.to_send.push_back(CanFrame::standard(0x186, {}));
  run_ms(1);
  bool was_off = false;
  for (int i = 0; i < 200; ++i) {
    run_ms(1);
    was_off |= state("b") == CanState::kBusOff;
  }
  EXPECT_TRUE(was_off);
  ASSERT_FALSE(board("b").can.bus_off.empty());
  EXPECT_TRUE(board("b").can.bus_off.front());
  EXPECT_TRUE(heard_.empty());
  EXPECT_GT(plant_->can_line(0).bus().stats(scheduler_.now()).error_frames, 15u);
}

TEST_F(CanLineTest, APoweredOffBoardLeavesTheBus) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  EXPECT_EQ(state("a"), CanState::kErrorActive);
  plant_->set_power(*plant_->find("a"), false);
  EXPECT_EQ(state("a"), CanState::kOffline);
  send(0x100);
  run_ms(5);
  EXPECT_TRUE(board("a").can.heard.empty());
  plant_->set_power(*plant_->find("a"), true);
  run_ms(5);
  EXPECT_EQ(board("a").can.heard.size(), 1u) << "the master's frame waited for somebody to acknowledge it";
}

TEST_F(CanLineTest, AFloodOfTheBoardWaitsInTheBoardAndNothingIsLost) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  for (std::uint32_t i = 0; i < 300; ++i) board("a").can.to_send.push_back(CanFrame::standard(0x180, {}));
  run_ms(1);
  EXPECT_GT(board("a").can.to_send.size(), 290u);
  run_ms(300);
  EXPECT_EQ(heard_.size(), 300u);
}

TEST_F(CanLineTest, AnUnpluggedBoardHearsNothingUntilItIsPluggedAgain) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  EXPECT_EQ(command("a", "wire", {"unplugged"})["plugged"], false);
  send(0x100);
  run_ms(5);
  EXPECT_TRUE(board("a").can.heard.empty());
  command("a", "wire", {"plugged"});
  run_ms(5);
  EXPECT_EQ(heard_, (std::vector<std::uint32_t>{0x101}));
}

TEST_F(CanLineTest, FaultsActOnTheFramesTheyNameUntilTheyAreCleared) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  command("a", "wire", {"drop", "100", "%", "id", "101", "of", "own"});
  send(0x100);
  send(0x200);
  run_ms(5);
  EXPECT_EQ(heard_, (std::vector<std::uint32_t>{0x201}));
  EXPECT_EQ(command("", "buses", {})[0]["faults_injected"], 1);
  EXPECT_EQ(command("a", "wire", {"drop", "0", "%", "id", "101", "of", "own"})["faults"], Json::array());
  send(0x100);
  run_ms(5);
  EXPECT_EQ(heard_.back(), 0x101u);

  command("a", "wire", {"duplicate=100 %", "of=own"});
  heard_.clear();
  send(0x300);
  run_ms(5);
  EXPECT_EQ(heard_, (std::vector<std::uint32_t>{0x301, 0x301}));
  command("a", "wire", {"none"});

  command("a", "wire", {"delay", "20", "ms", "of", "own"});
  const Instant before = scheduler_.now();
  times_.clear();
  send(0x400);
  run_ms(30);
  ASSERT_EQ(times_.size(), 1u);
  EXPECT_GT(times_[0] - before, milliseconds(20));
  EXPECT_LT(times_[0] - before, milliseconds(22));
  command("a", "wire", {"none"});

  const auto errors = [&] { return command("", "buses", {})[0]["error_frames"].get<int>(); };
  int count = errors();
  command("a", "wire", {"corrupt", "100", "%", "id", "500"});
  send(0x500);
  run_ms(5);
  EXPECT_EQ(heard_.back(), 0x501u) << "sent again";
  EXPECT_EQ(errors(), ++count);
  command("a", "wire", {"none"});
  command("a", "wire", {"error_frame"});
  run_ms(5);
  EXPECT_EQ(errors(), ++count);
}

TEST_F(CanLineTest, BusOffIsToldToTheBoardAndEndsByItself) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  command("a", "wire", {"bus_off"});
  EXPECT_EQ(command("a", "status", {})["can"]["state"], "bus off");
  run_ms(15);  // 128 times 11 bits of 8 us
  EXPECT_EQ(command("a", "status", {})["can"]["state"], "error active");
  EXPECT_EQ(board("a").can.bus_off, (std::vector<bool>{true, false}));
}

TEST_F(CanLineTest, StatusAndBusesTellLoadStateAndLed) {
  start(
      "networks: { one: { can: virtual, bitrate: 250k }, idle: { can: virtual } }\n"
      "drives:\n  - { name: a, board: { node: 5, network: one } }\n  - { name: b, board: { network: none } }\n");
  board("a").can.rate = 250'000;
  EXPECT_EQ(command("a", "led", {}), "green");
  for (int i = 0; i < 10; ++i) send(0x100);
  run_ms(1000);
  const Json can = command("a", "status", {})["can"];
  EXPECT_EQ(can["network"], "one");
  EXPECT_EQ(can["node"], 5);
  EXPECT_EQ(can["sent"], 10);
  EXPECT_EQ(can["received"], 10);
  EXPECT_GT(can["bus_load_percent"], 0.3);
  const Json buses = command("", "buses", {});
  ASSERT_EQ(buses.size(), 1u) << "a bus without boards is none";
  EXPECT_EQ(buses[0]["bitrate"], 250'000);
  EXPECT_EQ(buses[0]["frames"], 20);
  EXPECT_FALSE(command("b", "status", {}).contains("can"));
  EXPECT_EQ(command("b", "wire", {"bus_off"}), "the drive is on no CAN bus.");
}

TEST_F(CanLineTest, WrongWordsOfWireAreToldWithWhatIsAllowed) {
  start("drives:\n  - { name: a, board: { node: 5 } }\n");
  const auto told = [&](const std::vector<std::string>& words) {
    return command("a", "wire", words).get<std::string>();
  };
  EXPECT_NE(told({"drop", "110", "%"}).find("allowed: 0 to 100 % of the frames"), std::string::npos);
  EXPECT_NE(told({"drp=10 %"}).find("Did you mean \"drop\"?"), std::string::npos);
  EXPECT_NE(told({"drop", "10", "%", "id", "800"}).find("\"0\" to \"7FF\""), std::string::npos);
  EXPECT_NE(told({"drop", "10", "%", "of", "b"}).find("allowed: own, master, all"), std::string::npos);
  EXPECT_NE(told({"bus_off", "drop", "10", "%"}).find("bus_off stands alone"), std::string::npos);
  EXPECT_NE(told({"share", "10", "%"}).find("share belongs to delay"), std::string::npos);
  EXPECT_NE(told({"id", "185"}).find("wire lacks a fault"), std::string::npos);
}

// A bus elsewhere, as a test has it.
struct Elsewhere : transports::CanPort {
  struct Shared {
    transports::CanHandlers handlers;
    transports::CanStatus status;
    std::vector<std::uint32_t> sent;
    std::size_t room = 64;
  };
  explicit Elsewhere(std::shared_ptr<Shared> s) : shared(std::move(s)) {}
  void set_handlers(transports::CanHandlers h) override { shared->handlers = std::move(h); }
  transports::CanSend send(Instant, const CanFrame& f) override {
    shared->sent.push_back(f.id);
    --shared->room;
    return transports::CanSend::kQueued;
  }
  std::size_t queue_room() const override { return shared->room; }
  void clear_queue() override {}
  void set_online(Instant, bool) override {}
  Result<void, std::string> set_bitrate(Instant, std::uint32_t) override { return {}; }
  transports::CanStatus status() const override { return shared->status; }
  std::string name() const override { return "vcan0"; }
  std::shared_ptr<Shared> shared;
};

TEST_F(CanLineTest, OnABusElsewhereTheBoardsFollowItsInterface) {
  start("drives:\n  - { name: a, board: { node: 5, network: \"socketcan:vcan0\" } }\n");
  const auto vcan = std::make_shared<Elsewhere::Shared>();
  plant_->can_line(0).join(scheduler_.now(), std::make_unique<Elsewhere>(vcan));
  vcan->handlers.on_frame(scheduler_.now(), CanFrame::remote_request(0x705, 1));
  run_ms(1);
  ASSERT_EQ(board("a").can.heard.size(), 1u);
  EXPECT_TRUE(board("a").can.heard[0].remote);
  EXPECT_EQ(vcan->sent, (std::vector<std::uint32_t>{0x706}));

  const auto enter = [&](CanState to) {
    vcan->status.state = to;
    vcan->handlers.on_state(scheduler_.now(), vcan->status);
  };
  enter(CanState::kOffline);
  EXPECT_EQ(state("a"), CanState::kOffline);
  board("a").can.to_send.push_back(CanFrame::standard(0x85, {}));
  run_ms(5);
  EXPECT_EQ(vcan->sent.size(), 1u);
  enter(CanState::kErrorActive);
  run_ms(1);
  EXPECT_EQ(vcan->sent.back(), 0x85u) << "what the board had to say waited";
  enter(CanState::kBusOff);
  enter(CanState::kErrorActive);
  EXPECT_EQ(board("a").can.bus_off, (std::vector<bool>{true, false}));
}

TEST_F(CanLineTest, WhatABusElsewhereHasNoRoomForWaitsInOrder) {
  start("drives:\n  - { name: a, board: { node: 5, network: \"socketcan:vcan0\" } }\n");
  const auto vcan = std::make_shared<Elsewhere::Shared>();
  vcan->room = 1;
  plant_->can_line(0).join(scheduler_.now(), std::make_unique<Elsewhere>(vcan));
  for (std::uint32_t id : {0x181u, 0x281u, 0x381u}) board("a").can.to_send.push_back(CanFrame::standard(id, {}));
  run_ms(1);
  EXPECT_EQ(vcan->sent, (std::vector<std::uint32_t>{0x181}));
  vcan->room = 5;
  vcan->handlers.on_sent(scheduler_.now(), CanFrame::standard(0x181, {}));
  EXPECT_EQ(vcan->sent, (std::vector<std::uint32_t>{0x181, 0x281, 0x381}));
}

}  // namespace
}  // namespace vinv::rig
