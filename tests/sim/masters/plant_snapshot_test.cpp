// A drive run by a master is interrupted at every grid instant and goes on in another process: the words of
// the master, what passes on its wire and the motor are those of the run that was not interrupted.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "plant_bench.hpp"

namespace vinv::test {
namespace {

using masters::Word;

struct Stage {
  explicit Stage(std::string_view protocol_name) : protocol(protocol_name) {
    const bool serial = protocol == "modbus serial";
    if (serial || protocol == "modbus tcp") {
      master = serial ? bench.serial_master() : bench.tcp_master();
      protocol = "modbus";
    } else {
      master = bench.canopen_master();
    }
    master->on_wire([this](const masters::WireFrame& f) {
      log += std::to_string(to_ns(f.at)) + (f.sent ? " >" : " <");
      for (const std::uint8_t b : f.bytes) log += " " + std::to_string(b);
      log += "\n";
    });
  }

  // The next word as soon as the one before it has come to an end, or been waited for long enough.
  void go_on() {
    static const masters::Order kStory[] = {order(Word::kEnterNetwork),
                                            order(Word::kReferenceRpm, 900),
                                            order(Word::kRunForward),
                                            monitor("output_frequency"),
                                            parameter(7, 0.1),
                                            parameter(7, 0.1, 2.5),
                                            order(Word::kRunReverse),
                                            monitor("output_current"),
                                            order(Word::kReferenceHz, 45),
                                            order(Word::kStop),
                                            order(Word::kReset),
                                            parameter(1, 0.01)};
    if (const auto outcome = master->poll()) {
      log += *outcome ? "done " + std::to_string((*outcome)->value) + (*outcome)->unit + "\n" : outcome->error() + "\n";
      busy = false;
    }
    if (busy && bench.now() < give_up_at) return;
    masters::Order next = kStory[told++ % std::size(kStory)];
    next.node = 5;
    master->begin(bench.now(), *masters::find_profile("oi-fr-e5nco", protocol), next);
    busy = true;
    give_up_at = bench.now() + milliseconds(700);
  }

  friend void archive(Archive& a, Stage& stage) {
    a.io(stage.bench.plant);
    stage.master->archive(a);
    a.io(stage.told);
    a.io(stage.busy);
    a.io(stage.give_up_at);
    stage.bench.plant.streams().archive_owners(a);
    stage.bench.scheduler.archive_waiting(a);
  }

  PlantBench bench;
  std::string protocol;
  std::unique_ptr<masters::Station> master;
  std::uint64_t told = 0;
  bool busy = false;
  Instant give_up_at{};
  std::string log;
};

// To the next grid instant, by steps of 1 ms.
void story(Stage& stage) {
  for (int i = 0; i < 100; ++i) {
    stage.go_on();
    stage.bench.run(milliseconds(1));
  }
}

class MasterAndPlantSnapshot : public testing::TestWithParam<const char*> {};

TEST_P(MasterAndPlantSnapshot, ADriveAndItsMasterGoOnAsThoseThatWereNotInterrupted) {
  Stage one(GetParam());
  auto relayed = std::make_unique<Stage>(GetParam());
  for (int i = 0; i < 60; ++i) {
    story(one);
    story(*relayed);
    ASSERT_EQ(relayed->log, one.log) << "at " << i;
    const Bytes saved = save_snapshot(*relayed);
    auto fresh = std::make_unique<Stage>(GetParam());
    const auto loaded = load_snapshot(*fresh, saved);
    ASSERT_TRUE(loaded) << loaded.error();
    fresh->log = relayed->log;
    relayed = std::move(fresh);
    ASSERT_EQ(save_snapshot(*relayed), save_snapshot(one)) << "at " << i;
  }
  std::size_t done = 0;
  for (std::size_t at = 0; (at = one.log.find("done", at)) != std::string::npos; ++at) ++done;
  EXPECT_GT(done, 10u);
}

INSTANTIATE_TEST_SUITE_P(Protocols, MasterAndPlantSnapshot,
                         testing::Values("modbus serial", "modbus tcp", "canopen", "canopen-sdo", "canopen-402"));

}  // namespace
}  // namespace vinv::test
