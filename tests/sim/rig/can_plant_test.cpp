// CANopen masters in a script, the product's own drives and boards, in virtual time.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "sim/rig/commands.hpp"
#include "sim/rig/plant.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;

class CanPlantTest : public testing::Test {
 protected:
  void start(const std::string& text) {
    PlantOptions options;
    options.catalogue = shipped_catalogue();
    plant_ = std::make_unique<Plant>(parse_plant_file(text, "p.yaml", options.catalogue), scheduler_, options);
    master_ = plant_->can_line(0).bus().attach(scheduler_.now(), {.name = "master", .queue_frames = 256});
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant, const CanFrame& f) { heard_[f.id].push_back(f); };
    master_->set_handlers(std::move(handlers));
    plant_->start();
  }
  void run_ms(int ms) { scheduler_.run_until(scheduler_.now() + milliseconds(ms)); }
  void send(const CanFrame& frame) { ASSERT_EQ(master_->send(scheduler_.now(), frame), transports::CanSend::kQueued); }
  std::vector<CanFrame> ask(const CanFrame& frame, std::uint32_t answer_id, int ms = 20) {
    heard_[answer_id].clear();
    send(frame);
    run_ms(ms);
    return heard_[answer_id];
  }
  double hz(const std::string& drive) {
    for (const auto& s : plant_->find(drive)->inverter->signals())
      if (s.name == "output_frequency") return s.value;
    return -1;
  }
  std::string led(const std::string& drive) { return std::string(plant_->find(drive)->board->status_led()); }

  kernel::Scheduler scheduler_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<transports::CanNode> master_;
  std::map<std::uint32_t, std::vector<CanFrame>> heard_;
};

constexpr const char* kTwoDrives =
    "networks: { line: { can: virtual, bitrate: 250k } }\n"
    "drives:\n"
    "  - { name: a, board: { node: 5, network: line }, parameters: { Pr.7: 1.0, Pr.8: 1.0 } }\n"
    "  - { name: b, board: { node: 6, network: line } }\n";

const CanFrame kStartAll = CanFrame::standard(0, {1, 0});
// RPDO1: command word, set frequency in 0.01 Hz.
CanFrame rpdo1(std::uint32_t node, std::uint8_t command, unsigned centihertz) {
  return CanFrame::standard(0x200 + node, {command, 0, static_cast<std::uint8_t>(centihertz & 0xff),
                                           static_cast<std::uint8_t>(centihertz >> 8), 0, 0, 0, 0});
}

TEST_F(CanPlantTest, AMasterFindsTwoDrivesStartsThemAndSeesOneRampInItsTime) {
  start(kTwoDrives);
  run_ms(1500);
  ASSERT_EQ(heard_[0x705].size(), 1u);
  EXPECT_EQ(heard_[0x705][0].bytes()[0], 0);
  ASSERT_EQ(heard_[0x706].size(), 1u);
  EXPECT_EQ(led("a"), "green flashing");

  send(kStartAll);
  run_ms(50);
  EXPECT_EQ(led("a"), "green");
  EXPECT_EQ(execute(*plant_, "status", "a", {})->at("mode"), "NET");
  send(rpdo1(5, 2, 4000));
  run_ms(500);
  EXPECT_NEAR(hz("a"), 25, 1.5);  // half of 50 Hz in half of Pr.7
  run_ms(500);
  EXPECT_NEAR(hz("a"), 40, 0.01);
  EXPECT_EQ(hz("b"), 0);

  const auto monitors = ask(CanFrame::remote_request(0x185, 8), 0x185);
  ASSERT_EQ(monitors.size(), 1u);
  EXPECT_EQ(monitors[0].data[2] | monitors[0].data[3] << 8, 4000);
  send(rpdo1(5, 1, 4000));
  run_ms(1200);
  EXPECT_EQ(hz("a"), 0);
}

TEST_F(CanPlantTest, ADriveWithoutPowerIsSilentAndItsNeighbourIsNot) {
  start(kTwoDrives);
  run_ms(1500);
  plant_->set_power(*plant_->find("a"), false);
  run_ms(3000);
  EXPECT_TRUE(ask(CanFrame::remote_request(0x705, 1), 0x705).empty());
  EXPECT_EQ(ask(CanFrame::remote_request(0x706, 1), 0x706).size(), 1u);
  heard_.clear();
  plant_->set_power(*plant_->find("a"), true);
  run_ms(1500);
  ASSERT_EQ(heard_[0x705].size(), 1u) << "boot-up";
  EXPECT_EQ(ask(CanFrame::remote_request(0x705, 1), 0x705).size(), 1u);
}

TEST_F(CanPlantTest, AddressAndBitRateOfTheBoardAreTakenAtPowerOn) {
  start(kTwoDrives);
  run_ms(1500);
  const auto command = [&](const std::string& name, const std::vector<std::string>& words) {
    const auto r = execute_words(*plant_, name, "b", words);
    ASSERT_TRUE(r) << r.error().message;
  };
  command("mode", {"PU"});
  run_ms(20);
  command("parameter", {"Pr.345=100"});
  command("switch", {"SW1=4", "SW2=2"});
  run_ms(20);
  EXPECT_EQ(ask(CanFrame::remote_request(0x706, 1), 0x706).size(), 1u) << "not before the next power-on";
  command("power", {"cycle"});
  run_ms(4000);
  EXPECT_EQ(ask(CanFrame::remote_request(0x700 + 42, 1), 0x700 + 42).size(), 1u);
  EXPECT_EQ(execute(*plant_, "status", "b", {})->at("can")["node"], 42);

  // Another rate than the bus: b cannot talk, and once it is error passive a can again.
  command("mode", {"PU"});
  run_ms(20);
  command("parameter", {"Pr.346=132"});
  command("power", {"cycle"});
  run_ms(4000);
  EXPECT_EQ(execute(*plant_, "status", "b", {})->at("can")["bitrate"], 125'000);
  EXPECT_TRUE(ask(CanFrame::remote_request(0x700 + 42, 1), 0x700 + 42).empty());
  EXPECT_GT(plant_->can_line(0).bus().stats(scheduler_.now()).error_frames, 10u);
}

TEST_F(CanPlantTest, NinetyNineDrivesBootAndAnswerOnOneBus) {
  std::string text = "networks: { line: { can: virtual, bitrate: 1M } }\ndrives:\n";
  for (int node = 1; node <= 99; ++node)
    text +=
        "  - { board: { node: " + std::to_string(node) + ", network: line, modbus_rtu: none, modbus_tcp: none } }\n";
  start(text);
  run_ms(1200);
  for (std::uint32_t node = 1; node <= 99; ++node) EXPECT_EQ(heard_[0x700 + node].size(), 1u) << node;
  send(kStartAll);
  heard_.clear();
  for (std::uint32_t node = 1; node <= 99; ++node) send(CanFrame::remote_request(0x700 + node, 1));
  run_ms(100);
  for (std::uint32_t node = 1; node <= 99; ++node) {
    ASSERT_EQ(heard_[0x700 + node].size(), 1u) << node;
    EXPECT_EQ(heard_[0x700 + node][0].data[0] & 0x7f, 5) << node << " is not OPERATIONAL";
  }
  EXPECT_EQ(plant_->can_line(0).bus().stats(scheduler_.now()).nodes, 100u);
}

}  // namespace
}  // namespace vinv::rig
