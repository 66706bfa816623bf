// A CANopen master is interrupted at any instant, saved, and goes on in another process as if nothing had been: SDO
// transfers, guarding, heartbeats both ways, SYNC, PDOs and frames on the bus.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "sim/base/random.hpp"
#include "sim/masters/canopen_station.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "tests/support/snapshot_checks.hpp"

namespace vinv::masters {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// Node 5, which knows nothing: answers SDOs, some with an abort, some not at all; guarding answers whose toggle bit
// fails at times; a heartbeat; a TPDO to each SYNC or remote request; emergencies.
class Peer {
 public:
  Peer(kernel::Scheduler& scheduler, transports::CanBus& bus) : scheduler_(scheduler) {
    transports::CanNodeOptions options;
    options.name = "peer";
    node_ = bus.attach(scheduler.now(), options);
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant at, const CanFrame& f) { hear(at, f); };
    node_->set_handlers(std::move(handlers));
    heartbeat_ = scheduler.schedule_every(scheduler.now() + milliseconds(40), milliseconds(40),
                                          kernel::Priority::kBoard, [this](Instant at) { beat(at); });
  }
  friend void archive(Archive& a, Peer& peer) {
    a.io(peer.heard_);
    a.io(peer.toggle_);
    a.io(peer.guarded_);
    peer.scheduler_.archive_event(a, peer.heartbeat_, [&peer](Instant at) { peer.beat(at); });
  }

 private:
  void beat(Instant now) {
    if (!guarded_ && heard_ % 16 < 12) say(now, CanFrame::standard(0x705, {5}));
    if (heard_ % 6 == 0)
      say(now, CanFrame::standard(0x85, {0x00, 0x10, 1, 21, static_cast<std::uint8_t>(heard_), 0, 0, 0}));
  }
  void hear(Instant now, const CanFrame& f) {
    ++heard_;
    const auto count = static_cast<std::uint8_t>(heard_);
    if (f.id == 0x605 && heard_ % 7 != 0) {
      CanFrame answer = f;
      answer.id = 0x585;
      if (heard_ % 9 == 0) {
        answer.data = {0x80, f.data[1], f.data[2], f.data[3], 0, 0, 2, 6};
      } else if (f.data[0] == 0x40) {
        answer.data = {0x4b, f.data[1], f.data[2], f.data[3], count, 0, 0, 0};
      } else {
        answer.data = {0x60, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0};
      }
      say(now, answer);
    }
    if (f.id == 0x705 && f.remote && heard_ % 11 < 8) {
      guarded_ = true;
      if (heard_ % 5 != 0) toggle_ = !toggle_;
      say(now, CanFrame::standard(0x705, {static_cast<std::uint8_t>((toggle_ ? 0x80 : 0) | 5)}));
    }
    if (f.id == 0x80 || (f.id == 0x185 && f.remote)) say(now, CanFrame::standard(0x185, {count, 1, 2, 3}));
    if (f.id == 0) {
      guarded_ = false;
      say(now, CanFrame::standard(0x705, {0}));
    }
  }
  void say(Instant now, const CanFrame& f) { static_cast<void>(node_->send(now, f)); }

  kernel::Scheduler& scheduler_;
  std::unique_ptr<transports::CanNode> node_;
  kernel::EventId heartbeat_ = 0;
  std::uint64_t heard_ = 0;
  bool toggle_ = false;
  bool guarded_ = false;
};

struct Bench {
  Bench() {
    CanopenMasterSettings settings;
    settings.heartbeat_interval = milliseconds(30);
    settings.sync_interval = milliseconds(25);
    settings.sdo_timeout = milliseconds(20);
    transports::CanNodeOptions options;
    options.name = "master";
    options.queue_frames = 4;
    station = std::make_unique<CanopenStation>(scheduler, settings, bus.attach(scheduler.now(), options));
    station->on_wire([this](const WireFrame& f) {
      log += std::to_string(to_ns(f.at)) + (f.sent ? " >" : " <");
      for (const std::uint8_t b : f.bytes) log += " " + std::to_string(b);
      log += "\n";
    });
  }

  void act(Random& random) {
    const Instant now = scheduler.now();
    const auto with = [&](const auto& action) { station->with_master(now, action); };
    const auto pdo = static_cast<unsigned>(1 + random.below(4));
    Order o;
    o.node = 5;
    switch (random.below(16)) {
      case 0: o.word = Word::kRunForward; break;
      case 1: o.word = Word::kEnterNetwork; break;
      case 2:
        o.word = Word::kReferenceHz;
        o.value = static_cast<double>(random.below(60));
        break;
      case 3:
        o.word = Word::kMonitor;
        o.monitor = "output_frequency";
        break;
      case 4:
        o.word = Word::kReadParameter;
        o.parameter = static_cast<std::uint16_t>(random.below(20));
        break;
      case 5: o.word = Word::kQuickStop; break;
      case 6:
        with([&](CanopenMaster& m) {
          m.guard(now, 5, milliseconds(random.below(2) * (10 + random.below(30))),
                  1 + static_cast<unsigned>(random.below(3)));
        });
        return;
      case 7: with([&](CanopenMaster& m) { m.watch_heartbeat(5, milliseconds(random.below(2) * 45)); }); return;
      case 8:
        with([&](CanopenMaster& m) { m.set_output(5, pdo, 2, 2, static_cast<std::uint32_t>(random.below(65536))); });
        return;
      case 9: with([&](CanopenMaster& m) { m.send_output_cyclically(5, pdo, random.below(2) == 0); }); return;
      case 10: with([&](CanopenMaster& m) { m.request_input(5, 1, 4); }); return;
      case 11:
        with([&](CanopenMaster& m) {
          for (std::uint16_t i = 0; i < 3; ++i)
            static_cast<void>(m.transfer({5, static_cast<std::uint16_t>(0x3000 + i), 0, random.below(2) == 0, 2, 77}));
        });
        return;
      case 12: with([&](CanopenMaster& m) { m.command(canopen::NmtCommand::kStart, 5); }); return;
      case 13: station->set_silent(now, random.below(4) == 0); return;
      case 14: log += "frames " + std::to_string(station->take_frames().size()) + "\n"; return;
      default:
        for (const CanopenEvent& e : station->take_events())
          log += "event " + std::to_string(static_cast<int>(e.kind)) + " " + std::to_string(e.node) + "\n";
        return;
    }
    const char* const protocols[] = {"canopen", "canopen-sdo", "canopen-402"};
    station->begin(now, *find_profile("oi-fr-e5nco", protocols[random.below(3)]), o);
  }

  friend void archive(Archive& a, Bench& b) {
    a.io(b.scheduler);
    a.io(b.bus);
    a.io(b.peer);
    b.station->archive(a);
    b.scheduler.archive_waiting(a);
  }

  kernel::Scheduler scheduler;
  transports::CanBus bus{scheduler, {.name = "bus", .bitrate = 125'000}};
  Peer peer{scheduler, bus};
  std::unique_ptr<CanopenStation> station;
  std::string log;
};

void story(Bench& b, std::uint64_t seed) {
  Random random(seed * 1'000'003 + static_cast<std::uint64_t>(to_ns(b.scheduler.now())));
  for (std::uint64_t n = random.below(4); n > 0; --n) {
    b.act(random);
    b.scheduler.run_until(b.scheduler.now() + microseconds(random.below(3'000)));
    if (const auto outcome = b.station->poll())
      b.log += *outcome ? "done " + std::to_string((*outcome)->value) + " " + (*outcome)->unit + "\n"
                        : outcome->error() + "\n";
  }
  b.scheduler.run_until(b.scheduler.now() + microseconds(random.below(9'000)));
  if (random.below(3) == 0) b.act(random);
}

class CanopenSnapshot : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CanopenSnapshot, AMasterInterruptedAfterEachStepGoesOnAsOneThatIsNot) {
  std::string log;
  std::string relayed_log;
  expect_the_same_after_each_step(
      1500, GetParam(), [] { return std::make_unique<Bench>(); }, story, [&](Bench& one, Bench& relayed) {
        log += std::exchange(one.log, {});
        relayed_log += std::exchange(relayed.log, {});
        ASSERT_EQ(relayed_log, log);
      });
  for (const char* sign : {"done", "no SDO answer", "SDO abort 06020000", "EMCY"})
    EXPECT_NE(log.find(sign), std::string::npos) << sign;
  for (const auto kind :
       {CanopenEvent::Kind::kBootUp, CanopenEvent::Kind::kState, CanopenEvent::Kind::kGuardToggle,
        CanopenEvent::Kind::kGuardLost, CanopenEvent::Kind::kGuardBack, CanopenEvent::Kind::kHeartbeatLost,
        CanopenEvent::Kind::kEmergency, CanopenEvent::Kind::kSdo, CanopenEvent::Kind::kPdo})
    EXPECT_NE(log.find("event " + std::to_string(static_cast<int>(kind)) + " 5"), std::string::npos)
        << static_cast<int>(kind);
  EXPECT_GT(std::count(log.begin(), log.end(), '>'), 1000);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CanopenSnapshot, testing::Range<std::uint64_t>(1, 4));

TEST(CanopenSnapshots, ForgedOnesLeaveTheMasterAsItWas) {
  Bench one;
  for (int i = 0; i < 60; ++i) story(one, 9);
  Bench other;
  for (int i = 0; i < 90; ++i) story(other, 2);
  expect_forged_leave_no_trace(one, save_snapshot(other), 500, 5, 50, [](Bench&) {});
}

}  // namespace
}  // namespace vinv::masters
