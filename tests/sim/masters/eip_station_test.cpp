// An EtherNet/IP scanner and an FR-A700 with FR-A7NE in virtual time: its words and tasks, and a run that is
// interrupted at every grid instant and goes on in another process as if nothing had been.
#include "sim/masters/eip_station.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "plant_bench.hpp"

namespace vinv::test {
namespace {

using masters::EipTask;
using masters::Word;

constexpr std::string_view kMixerPlant = R"(
drives:
  - name: mixer
    inverter: { family: fr-a700, model: FR-A740-1.5K }
    load: { inertia_kg_m2: 0.01, torque: { constant_Nm: 1 } }
    board: { type: fr-a7ne, address: 127.0.0.2 }
    parameters: { Pr.7: 0.5, Pr.8: 2, Pr.340: 1, Pr.500: 1 }
)";
constexpr std::uint32_t kAdapter = ipv4(127, 0, 0, 2);

struct MixerStage {
  explicit MixerStage(std::string_view protocol, bool class3 = false, std::uint32_t own = ipv4(127, 200, 0, 1))
      : bench(kMixerPlant), profile(*masters::find_profile("fr-a7ne", protocol)) {
    masters::EipStationSettings settings;
    settings.adapter = {kAdapter, 2222};
    settings.connected = class3;
    settings.wish.output_point = profile.io.output_point;
    settings.wish.input_point = profile.io.input_point;
    settings.wish.output_size = profile.io.output_size;
    settings.wish.input_size = profile.io.input_size;
    station = std::make_unique<masters::EipStation>(
        bench.scheduler, settings,
        [this, own](Instant at) {
          return bench.plant.connect_tcp(at, {own, 50000}, {kAdapter, 44818},
                                         {.delay = std::chrono::microseconds(100)});
        },
        std::move(*bench.plant.datagrams().open({own, 2222})), &bench.plant.streams());
    station->on_wire([this](const masters::WireFrame& f) {
      log += std::to_string(to_ns(f.at)) + (f.sent ? " > " : " < ") + masters::hex_text(f.bytes) + "\n";
    });
  }

  std::string say(const masters::Order& o) {
    station->begin(bench.now(), profile, o);
    std::optional<masters::Outcome> outcome;
    if (!bench.wait([&] { return (outcome = station->poll()).has_value(); }, std::chrono::seconds(8))) return "nothing";
    return *outcome ? std::to_string((*outcome)->value) + (*outcome)->unit : outcome->error();
  }
  std::string act(const EipTask& task) {
    station->begin_task(bench.now(), task);
    std::optional<masters::TaskOutcome> outcome;
    if (!bench.wait([&] { return (outcome = station->poll_task()).has_value(); }, std::chrono::seconds(12)))
      return "nothing";
    return *outcome ? "ok " + **outcome : outcome->error();
  }

  // The next word or task as soon as the one before it has come to an end, or been waited for long enough.
  void go_on() {
    if (auto outcome = station->poll())
      end(*outcome ? "done " + std::to_string((*outcome)->value) + (*outcome)->unit : outcome->error());
    if (auto outcome = station->poll_task()) end(*outcome ? "done " + **outcome : outcome->error());
    if (busy && bench.now() < give_up_at) return;
    static const masters::Order kWords[] = {
        order(Word::kReferenceHz, 30),   order(Word::kRunForward), monitor("output_frequency"),
        parameter(44, 0.1, 2.5),         parameter(44, 0.1),       order(Word::kRunReverse),
        order(Word::kReferenceRpm, 600), monitor("alarm"),         order(Word::kStop)};
    busy = true;
    give_up_at = bench.now() + milliseconds(900);
    const std::uint64_t number = told++;
    if (number % 3 != 2) return station->begin(bench.now(), profile, kWords[number % std::size(kWords)]);
    EipTask task;
    switch (number / 3 % 6) {
      case 0: task.kind = EipTask::Kind::kIdle; break;
      case 1:
        task.kind = EipTask::Kind::kIdle;
        task.on = false;
        break;
      case 2: task.kind = EipTask::Kind::kDrop; break;
      case 3:
        task.kind = EipTask::Kind::kProducing;
        task.on = false;
        break;
      case 4: task.kind = EipTask::Kind::kProducing; break;
      default:
        task.kind = EipTask::Kind::kRequest;
        task.ask.path = masters::object_path(0x2A, 1, 114);
        break;
    }
    station->begin_task(bench.now(), task);
  }
  void end(const std::string& text) {
    log += text + "\n";
    busy = false;
  }

  friend void archive(Archive& a, MixerStage& stage) {
    a.io(stage.bench.plant);
    stage.station->archive(a);
    a.io(stage.told);
    a.io(stage.busy);
    a.io(stage.give_up_at);
    stage.bench.plant.streams().archive_owners(a);
    stage.bench.scheduler.archive_waiting(a);
  }

  PlantBench bench;
  const masters::BoardProfile& profile;
  std::unique_ptr<masters::EipStation> station;
  std::uint64_t told = 0;
  bool busy = false;
  Instant give_up_at{};
  std::string log;
};

TEST(EipStation, RunsTheMotorByIo) {
  MixerStage s("ethernet-ip");
  EXPECT_EQ(s.say(order(Word::kReferenceHz, 30)), "0.000000");
  EXPECT_EQ(s.say(order(Word::kRunForward)), "0.000000");
  s.bench.run(milliseconds(1000));
  EXPECT_EQ(s.say(monitor("output_frequency")), "30.000000Hz");
  // Ready, both sources, forward, at speed; 900 r/min.
  EXPECT_EQ(masters::hex_text(s.station->scanner().input()), "F4 00 84 03");
}

TEST(EipStation, IsRefusedWithTheManualsCode) {
  MixerStage s("ethernet-ip-explicit");
  masters::Order o = parameter(79, 1, 2);
  EXPECT_NE(s.say(o).find("general status 0E (attribute not settable)"), std::string::npos) << s.say(o);
}

TEST(EipStation, ATaskFailsWhenTheAnswerIsNotTheExpectedOne) {
  MixerStage s("ethernet-ip");
  EipTask task;
  task.kind = EipTask::Kind::kRequest;
  task.ask.path = masters::object_path(0x2A, 1, 120);
  EXPECT_EQ(s.act(task), "ok 04 00");
  task.expected.emplace();
  task.expected->data = Bytes{4, 0};
  EXPECT_EQ(s.act(task), "ok general status 00, data 04 00");
  task.expected->data = Bytes{5, 0};
  EXPECT_EQ(s.act(task), "answered general status 00, data 04 00, not general status 00, data 05 00");
  task.expected = masters::CipExpectation{0x0c, {}, {}, {}};
  EXPECT_EQ(s.act(task), "answered general status 00, data 04 00, not general status 0C (object state conflict)");
}

TEST(EipStation, AConnectionThatWasLostIsOpenedAgainWhenItProducesAgain) {
  MixerStage s("ethernet-ip");
  EipTask open;
  open.kind = EipTask::Kind::kOpen;
  ASSERT_EQ(s.act(open).substr(0, 2), "ok");
  ASSERT_TRUE(s.station->scanner().io_open());
  EipTask producing;
  producing.kind = EipTask::Kind::kProducing;
  producing.on = false;
  EXPECT_EQ(s.act(producing), "ok ");
  s.bench.run(milliseconds(300));
  EXPECT_FALSE(s.station->scanner().io_open());
  s.bench.run(milliseconds(5000));
  EXPECT_FALSE(s.station->scanner().io_open());
  producing.on = true;
  EXPECT_EQ(s.act(producing), "ok ");
  s.bench.run(milliseconds(50));
  EXPECT_TRUE(s.station->scanner().io_open());
  EXPECT_EQ(s.act(open), "the I/O connection is open; close it first");
}

struct Way {
  const char* protocol;
  bool class3;
};
class EipSnapshot : public testing::TestWithParam<Way> {};

TEST_P(EipSnapshot, ADriveAndItsScannerGoOnAsThoseThatWereNotInterrupted) {
  const auto [protocol, class3] = GetParam();
  const auto story = [](MixerStage& stage) {
    for (int i = 0; i < 100; ++i) {
      stage.go_on();
      stage.bench.run(milliseconds(1));
    }
  };
  MixerStage one(protocol, class3);
  auto relayed = std::make_unique<MixerStage>(protocol, class3);
  for (int i = 0; i < 50; ++i) {
    story(one);
    story(*relayed);
    ASSERT_EQ(relayed->log, one.log) << "at " << i;
    const Bytes saved = save_snapshot(*relayed);
    auto fresh = std::make_unique<MixerStage>(protocol, class3);
    const auto loaded = load_snapshot(*fresh, saved);
    ASSERT_TRUE(loaded) << loaded.error();
    fresh->log = relayed->log;
    relayed = std::move(fresh);
    ASSERT_EQ(save_snapshot(*relayed), save_snapshot(one)) << "at " << i;
  }
  std::size_t done = 0;
  for (std::size_t at = 0; (at = one.log.find("done", at)) != std::string::npos; ++at) ++done;
  EXPECT_GT(done, 10u) << one.log.substr(0, 2000);
}

INSTANTIATE_TEST_SUITE_P(Ways, EipSnapshot,
                         testing::Values(Way{"ethernet-ip", false}, Way{"ethernet-ip-126", false},
                                         Way{"ethernet-ip-129", false}, Way{"ethernet-ip-explicit", true}));

}  // namespace
}  // namespace vinv::test
