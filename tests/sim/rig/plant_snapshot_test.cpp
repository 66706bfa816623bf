// A plant is saved and goes on as another one: drives, boards, a CAN bus with faults, a master, commands that take
// time.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/random.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/plant.hpp"
#include "sim/transports/memory_link.hpp"

namespace vinv::rig {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr const char* kTwoDrives =
    "networks: { line: { can: virtual, bitrate: 125k } }\n"
    "drives:\n"
    "  - { name: a, inverter: { model: FR-E540-0.75K }, board: { node: 5, network: line },\n"
    "      parameters: { Pr.7: 0.5, Pr.8: 0.5 } }\n"
    "  - { name: b, inverter: { model: FR-E540-1.5K }, board: { node: 6, network: line } }\n";

// A plant with a master on its bus, whose only memory is what it heard.
struct Rig {
  explicit Rig(const std::string& text = kTwoDrives, const std::string& master_name = "master") {
    PlantOptions options;
    options.catalogue = shipped_catalogue();
    plant = std::make_unique<Plant>(parse_plant_file(text, "p.yaml", options.catalogue), scheduler, options);
    master = plant->can_line(0).bus().attach(scheduler.now(), {.name = master_name});
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant at, const CanFrame& f) {
      heard += std::to_string(to_ns(at)) + " " + std::to_string(f.id) + (f.remote ? "R" : "");
      for (const std::uint8_t b : f.bytes()) heard += " " + std::to_string(b);
      heard += "\n";
    };
    handlers.on_state = [this](Instant at, const transports::CanStatus& s) {
      heard += std::to_string(to_ns(at)) + " " + text_of(s.state) + "\n";
    };
    master->set_handlers(std::move(handlers));
  }
  static std::string text_of(transports::CanState state) { return transports::text(state); }
  void run_to(Instant at) { scheduler.run_until(at); }
  void send(const CanFrame& frame) { static_cast<void>(master->send(scheduler.now(), frame)); }
  void command(const char* name, const char* drive, const std::vector<std::string>& words) {
    const auto done = execute_words(*plant, name, drive, words);
    EXPECT_TRUE(done || done.error().code == CommandCode::kRefused) << done.error().message;
    heard += done ? done->dump() + "\n" : done.error().message + "\n";
  }
  Bytes saved() {
    Bytes out;
    const auto ok = plant->save(out);
    EXPECT_TRUE(ok) << ok.error();
    return out;
  }

  kernel::Scheduler scheduler;
  std::unique_ptr<Plant> plant;
  std::unique_ptr<transports::CanNode> master;
  std::string heard;
};

CanFrame rpdo1(std::uint32_t node, std::uint64_t command, std::uint64_t centihertz) {
  return CanFrame::standard(0x200 + node, {static_cast<std::uint8_t>(command), 0, static_cast<std::uint8_t>(centihertz),
                                           static_cast<std::uint8_t>(centihertz >> 8), 0, 0, 0, 0});
}

void act(Rig& rig, Random& random) {
  const std::uint32_t node = 5 + static_cast<std::uint32_t>(random.below(2));
  const char* const drive = node == 5 ? "a" : "b";
  switch (random.below(22)) {
    case 0: rig.send(CanFrame::standard(0, {static_cast<std::uint8_t>(random.below(4) == 0 ? 128 : 1), 0})); break;
    case 1:
    case 2:
    case 3: rig.send(rpdo1(node, 1u << random.below(3), random.below(6000))); break;
    case 4: rig.send(CanFrame::remote_request(0x180 + node, 8)); break;
    case 5: rig.send(CanFrame::remote_request(0x700 + node, 1)); break;
    case 6: rig.send(CanFrame::standard(0x80, {})); break;
    case 7: rig.send(CanFrame::standard(0x600 + node, {0x2b, 0x0c, 0x10, 0, 50, 0, 0, 0})); break;  // guard time 50 ms
    case 8: rig.send(CanFrame::standard(0x600 + node, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0})); break;
    case 9: rig.command("wire", drive, {"drop", "20", "%"}); break;
    case 10: rig.command("wire", drive, {"delay", "3", "ms", "share", "50", "%", "of", "own"}); break;
    case 11: rig.command("wire", drive, {"corrupt", "30", "%"}); break;
    case 12: rig.command("wire", drive, {random.below(4) == 0 ? "bus_off" : "error_frame"}); break;
    case 13: rig.command("wire", drive, {random.below(2) == 0 ? "unplugged" : "plugged"}); break;
    case 14: rig.command("wire", drive, {"none"}); break;
    case 15: rig.command("mains", drive, {"dip", "60", "%", "for", "150", "ms"}); break;
    case 16: rig.command("load", drive, {"torque", "1", "Nm", "over", "400", "ms"}); break;
    case 17: rig.command("reset", drive, {}); break;
    case 18:
      if (random.below(4) == 0) rig.command("power", drive, {"cycle"});
      break;
    case 19: rig.command("fault", drive, {random.below(3) == 0 ? "E.OHT" : "earth_fault=off"}); break;
    case 20: rig.command("phase_loss", drive, {random.below(2) == 0 ? "L2" : "none"}); break;
    default: rig.master->set_online(rig.scheduler.now(), random.below(4) != 0); break;
  }
}

constexpr auto kGrid = milliseconds(100);

// From one grid instant to the next: a pure function of plant, seed and instant. Things happen at any time in between,
// and right after the instant itself.
void story(Rig& rig, std::uint64_t seed) {
  const Instant begin = rig.scheduler.now();
  Random random(seed * 1'000'003 + static_cast<std::uint64_t>(to_ns(begin)));
  Duration at{};
  for (std::uint64_t n = random.below(6); n > 0; --n) {
    if (random.below(3) != 0) at += microseconds(random.below(30'000));
    if (at >= kGrid) break;
    rig.run_to(begin + at);
    act(rig, random);
  }
  rig.run_to(begin + kGrid);
  if (random.below(4) == 0) act(rig, random);  // frames are on the wire, events wait for this very instant
}

std::unique_ptr<Rig> relay(Rig& from) {
  auto to = std::make_unique<Rig>();
  const auto loaded = to->plant->load(from.saved());
  EXPECT_TRUE(loaded) << loaded.error();
  to->heard = from.heard;
  return to;
}

class PlantSnapshot : public testing::TestWithParam<std::uint64_t> {};

TEST_P(PlantSnapshot, APlantInterruptedAtTwoHundredInstantsGoesOnByteForByteAsOneThatIsNot) {
  constexpr int kInstants = 200;
  Rig one;
  one.plant->start();
  auto relayed = std::make_unique<Rig>();
  relayed->plant->start();
  for (int i = 0; i < kInstants; ++i) {
    story(one, GetParam());
    story(*relayed, GetParam());
    ASSERT_EQ(relayed->heard, one.heard) << "instant " << i;
    relayed = relay(*relayed);
    ASSERT_EQ(relayed->saved(), one.saved()) << "instant " << i;
  }
  EXPECT_GT(std::count(one.heard.begin(), one.heard.end(), '\n'), 300);
  EXPECT_GT(one.plant->can_line(0).bus().stats(one.scheduler.now()).faults_injected, 10u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlantSnapshot, testing::Range<std::uint64_t>(1, 4));

TEST(PlantSnapshots, ContinuationsOfOneSnapshotAreWhatIsDoneToThemAndNothingElse) {
  Rig one;
  one.plant->start();
  for (int i = 0; i < 20; ++i) story(one, 7);
  const Bytes saved = one.saved();
  const auto continued = [&](std::uint64_t seed) {
    Rig fork;
    EXPECT_TRUE(fork.plant->load(saved));
    for (int i = 0; i < 5; ++i) story(fork, seed);
    return fork.saved();
  };
  const Bytes first = continued(7);
  EXPECT_EQ(continued(7), first);
  EXPECT_NE(continued(8), first);
  EXPECT_EQ(one.saved(), saved);
  for (int i = 0; i < 5; ++i) story(one, 7);
  EXPECT_EQ(one.saved(), first);
  // And back again, in a plant that is elsewhere.
  ASSERT_TRUE(one.plant->load(saved));
  EXPECT_EQ(one.saved(), saved);
  for (int i = 0; i < 5; ++i) story(one, 7);
  EXPECT_EQ(one.saved(), first);
}

class RefusedSnapshot : public testing::Test {
 protected:
  void SetUp() override {
    rig_.plant->start();
    for (int i = 0; i < 12; ++i) story(rig_, 3);
    before_ = rig_.saved();
  }
  // The reason. The plant is what it was, and goes on as it would have.
  std::string refusal(ByteView snapshot) {
    const auto loaded = rig_.plant->load(snapshot);
    EXPECT_FALSE(loaded);
    EXPECT_EQ(rig_.saved(), before_);
    return loaded ? "" : loaded.error();
  }
  Rig rig_;
  Bytes before_;
};

TEST_F(RefusedSnapshot, DamageLeavesThePlantAsItWas) {
  Rig other;
  other.plant->start();
  for (int i = 0; i < 15; ++i) story(other, 4);
  const Bytes good = other.saved();
  EXPECT_EQ(refusal({}), "these bytes are not a snapshot");
  EXPECT_NE(refusal(ByteView(good).first(good.size() / 2)).find("damaged"), std::string::npos);
  Random random(1);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    Bytes bad = good;
    bad[kSnapshotHeader + random.below(bad.size() - kSnapshotHeader)] ^=
        static_cast<std::uint8_t>(1u << random.below(8));
    ASSERT_NE(refusal(bad).find("checksum"), std::string::npos);
    seal_snapshot(bad);
    if (rig_.plant->load(bad)) {
      ASSERT_TRUE(rig_.plant->load(before_));
    } else {
      ++refused;
    }
    ASSERT_EQ(rig_.saved(), before_);
  }
  EXPECT_GT(refused, 20);
  // Cut short, with a checksum that fits.
  for (const std::size_t size : {kSnapshotHeader, kSnapshotHeader + 100, good.size() - 9, good.size() - 1}) {
    Bytes bad(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    seal_snapshot(bad);
    refusal(bad);
  }
  Rig undisturbed;
  undisturbed.plant->start();
  for (int i = 0; i < 14; ++i) story(undisturbed, 3);
  for (int i = 0; i < 2; ++i) story(rig_, 3);
  EXPECT_EQ(rig_.heard, undisturbed.heard);
  EXPECT_EQ(rig_.saved(), undisturbed.saved());
}

TEST_F(RefusedSnapshot, APlantWithOtherDrivesOrNodesIsAForeignOne) {
  std::string text = kTwoDrives;
  Rig model(text.replace(text.find("0.75K"), 5, "0.4K"));
  EXPECT_NE(refusal(model.saved()).find("the snapshot is of another plant: a (FR-E540-0.4K"), std::string::npos);
  text = kTwoDrives;
  Rig name(text.replace(text.find("name: b"), 7, "name: c"));
  EXPECT_NE(refusal(name.saved()).find("another plant"), std::string::npos);
  Rig master(kTwoDrives, "plc");
  EXPECT_NE(refusal(master.saved()).find("the snapshot is of another CAN bus"), std::string::npos);
  EXPECT_NE(refusal(save_snapshot(*rig_.plant->find("a")->inverter)), "");
}

TEST_F(RefusedSnapshot, AnEventThatNobodyOwnsIsNotForgotten) {
  Rig other;
  other.plant->start();
  other.run_to(other.scheduler.now() + kGrid);
  other.scheduler.schedule(other.scheduler.now() + kGrid, kernel::Priority::kStimulus, [](Instant) {});
  EXPECT_NE(refusal(other.saved()).find("events were waiting"), std::string::npos);
}

TEST(SnapshotObjections, OffTheGridAndWithClientsNothingIsSavedOrLoaded) {
  Rig rig(
      "networks: { line: { can: virtual } }\n"
      "drives: [{ board: { node: 5, network: line } }]\n");
  rig.plant->start();
  rig.run_to(rig.scheduler.now() + kGrid);
  const Bytes saved = rig.saved();
  const auto objection = [&] {
    Bytes out;
    const auto refused = rig.plant->save(out);
    EXPECT_FALSE(refused);
    EXPECT_FALSE(rig.plant->load(saved));
    EXPECT_TRUE(out.empty());
    return refused ? "" : refused.error();
  };
  rig.run_to(rig.scheduler.now() + microseconds(31'400));
  EXPECT_NE(objection().find("it is 0.131400 s"), std::string::npos);
  rig.run_to(rig.scheduler.now() + microseconds(68'600));
  EXPECT_TRUE(rig.plant->load(rig.saved()));

  auto [client, server] = transports::make_memory_link(rig.scheduler);
  rig.plant->accept_tcp(0, rig.scheduler.now(), std::move(server));
  EXPECT_NE(objection().find("1 are open at Modbus/TCP port"), std::string::npos);
  client->close();
  rig.run_to(rig.scheduler.now() + kGrid);
  EXPECT_TRUE(rig.plant->load(rig.saved()));

  auto [far, near] = transports::make_memory_link(rig.scheduler);
  rig.plant->connect_serial(0, std::move(near));
  EXPECT_NE(objection().find("serial line"), std::string::npos);
}

}  // namespace
}  // namespace vinv::rig
