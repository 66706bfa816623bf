// A Modbus master on a line in memory is interrupted at any instant, saved, and goes on in another process as if
// nothing had been: orders, retries, cyclic reads, half-received answers, connections that were lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "option_boards/modbus/crc16.hpp"
#include "sim/base/random.hpp"
#include "sim/masters/modbus_station.hpp"
#include "tests/support/snapshot_checks.hpp"

namespace vinv::masters {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// Holds 65536 registers, and answers late, in two pieces, wrongly, by an exception, not at all or by hanging up.
class Peer {
 public:
  Peer(kernel::Scheduler& scheduler, transports::MemoryStreams& net, bool tcp)
      : scheduler_(scheduler), net_(net), tcp_(tcp) {}

  void take(std::unique_ptr<transports::ByteStream> stream) {
    stream_ = std::move(stream);
    listen();
  }

  friend void archive(Archive& a, Peer& peer) {
    peer.net_.archive_end(a, peer.stream_);
    a.io(peer.registers_);
    a.io(peer.heard_);
    a.io(peer.last_);
    const std::size_t count = a.count(peer.answers_.size());
    if (a.loads()) peer.answers_.assign(count, {});
    for (Answer& answer : peer.answers_) {
      a.io(answer.bytes);
      peer.scheduler_.archive_event(a, answer.event, [&peer](Instant at) { peer.answer(at); });
    }
    if (a.loads() && !a.failed() && peer.stream_) peer.listen();
  }

 private:
  struct Answer {
    Bytes bytes;
    kernel::EventId event = 0;
  };

  void listen() {
    stream_->set_handlers([this](Instant at, ByteView bytes, bool) { hear(at, bytes); }, {});
  }
  void hear(Instant now, ByteView frame) {
    ++heard_;
    const std::size_t head = tcp_ ? 6 : 0;
    if (frame.size() < head + 6 || heard_ % 17 == 0) return;
    if (tcp_ && heard_ % 23 == 0) return stream_->close();
    Bytes answer(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(head + 2));
    const std::uint16_t address = read_be16(frame, head + 2);
    const std::uint16_t word = read_be16(frame, head + 4);
    if (heard_ % 11 == 0) {
      answer.back() |= 0x80;
      answer.push_back(5);
    } else if (answer.back() == 3) {
      answer.push_back(static_cast<std::uint8_t>(2 * word));
      for (unsigned i = 0; i < word; ++i) append_be16(answer, registers_[static_cast<std::uint16_t>(address + i)]);
    } else {
      registers_[address] = word;
      append_be16(answer, address);
      append_be16(answer, word);
    }
    if (tcp_) {
      answer[5] = static_cast<std::uint8_t>(answer.size() - 6);
    } else {
      append_le16(answer, heard_ % 13 == 0 ? 0 : modbus::crc16(answer));
    }
    const std::size_t cut = heard_ % 5 == 0 ? answer.size() / 2 : answer.size();
    const Instant at = std::max(now + microseconds(900 * (heard_ % 4)), last_);
    last_ = at + microseconds(300);
    send_at(at, Bytes(answer.begin(), answer.begin() + static_cast<std::ptrdiff_t>(cut)));
    if (cut < answer.size())
      send_at(at + microseconds(300), Bytes(answer.begin() + static_cast<std::ptrdiff_t>(cut), answer.end()));
  }
  void send_at(Instant at, Bytes bytes) {
    answers_.push_back(
        {std::move(bytes), scheduler_.schedule(at, kernel::Priority::kBoard, [this](Instant now) { answer(now); })});
  }
  void answer(Instant now) {
    const Bytes bytes = std::move(answers_.front().bytes);
    answers_.pop_front();
    stream_->send(now, bytes);
  }

  kernel::Scheduler& scheduler_;
  transports::MemoryStreams& net_;
  bool tcp_;
  std::unique_ptr<transports::ByteStream> stream_;
  std::map<std::uint16_t, std::uint16_t> registers_;
  std::uint64_t heard_ = 0;
  Instant last_{};
  std::deque<Answer> answers_;  // in the order of their times
};

struct Bench {
  explicit Bench(bool tcp) : peer(scheduler, net, tcp) {
    ModbusMasterSettings settings;
    settings.framing = tcp ? ModbusFraming::kTcp : ModbusFraming::kRtu;
    settings.baud = 38400;
    settings.timeout = milliseconds(20);
    settings.retries = tcp ? 0 : 1;
    station = std::make_unique<ModbusStation>(
        scheduler, settings,
        [this, tcp](Instant) {
          auto [theirs, ours] =
              net.connect({.delay = microseconds(tcp ? 100 : 0), .character = microseconds(tcp ? 0 : 260)});
          peer.take(std::move(theirs));
          return std::move(ours);
        },
        &net);
    station->on_wire([this](const WireFrame& f) {
      log += std::to_string(to_ns(f.at)) + (f.sent ? " >" : " <");
      for (const std::uint8_t b : f.bytes) log += " " + std::to_string(b);
      log += "\n";
    });
  }

  void act(Random& random) {
    const Instant now = scheduler.now();
    const BoardProfile& profile = *find_profile("oi-fr-e5nco", "modbus");
    Order o;
    o.node = static_cast<std::uint8_t>(random.below(4) == 0 ? 6 : 5);
    switch (random.below(14)) {
      case 0: o.word = Word::kRunForward; break;
      case 1: o.word = Word::kStop; break;
      case 2:
        o.word = Word::kReferenceHz;
        o.value = static_cast<double>(random.below(60));
        break;
      case 3:
      case 4:
        o.word = Word::kMonitor;
        o.monitor = random.below(5) == 0 ? "no such" : "output_frequency";
        break;
      case 5:
        o.word = Word::kReadParameter;
        o.parameter = static_cast<std::uint16_t>(random.below(20));
        break;
      case 6:
        o.word = Word::kWriteParameter;
        o.parameter = static_cast<std::uint16_t>(random.below(20));
        o.value = static_cast<double>(random.below(100));
        break;
      case 7: o.word = Word::kEnterNetwork; break;
      case 8:
        static_cast<void>(station->submit(now, ModbusRequest::read(5, static_cast<std::uint16_t>(random.below(9)), 3)));
        return;
      case 9:
        if (random.below(8) == 0)
          static_cast<void>(
              station->add_cycle(now, ModbusRequest::read(5, 40, 2), milliseconds(20 + random.below(50))));
        return;
      case 10: station->send_frame(now, Bytes{5, 7, 0, 0}); return;
      case 11: station->set_silent(now, random.below(4) == 0); return;
      case 12:
        for (const Bytes& frame : station->take_frames()) log += "frame " + std::to_string(frame.size()) + "\n";
        return;
      default:
        for (const ModbusResult& r : station->take_results())
          log += "result " + std::to_string(r.id) + " " + std::to_string(r.attempts) +
                 (r.answer ? " " + std::to_string(r.answer->front()) : text_of(r.answer.error())) + "\n";
        return;
    }
    station->begin(now, profile, o);
  }

  friend void archive(Archive& a, Bench& b) {
    a.io(b.scheduler);
    a.io(b.net);
    a.io(b.peer);
    b.station->archive(a);
    b.net.archive_owners(a);
    b.scheduler.archive_waiting(a);
  }

  kernel::Scheduler scheduler;
  transports::MemoryStreams net{scheduler};
  Peer peer;
  std::unique_ptr<ModbusStation> station;
  std::string log;
};

void story(Bench& b, std::uint64_t seed) {
  Random random(seed * 1'000'003 + static_cast<std::uint64_t>(to_ns(b.scheduler.now())));
  for (std::uint64_t n = random.below(4); n > 0; --n) {
    b.act(random);
    b.scheduler.run_until(b.scheduler.now() + microseconds(random.below(9'000)));
    if (const auto outcome = b.station->poll())
      b.log += *outcome ? "done " + std::to_string((*outcome)->value) + " " + (*outcome)->unit + "\n"
                        : outcome->error() + "\n";
  }
  b.scheduler.run_until(b.scheduler.now() + microseconds(random.below(12'000)));
  if (random.below(3) == 0) b.act(random);
}

struct Case {
  bool tcp;
  std::uint64_t seed;
};
class ModbusSnapshot : public testing::TestWithParam<Case> {};

TEST_P(ModbusSnapshot, AMasterInterruptedAfterEachStepGoesOnAsOneThatIsNot) {
  std::string log;
  std::string relayed_log;
  expect_the_same_after_each_step(
      2500, GetParam().seed, [] { return std::make_unique<Bench>(GetParam().tcp); }, story, [&](Bench& one, Bench& relayed) {
        log += std::exchange(one.log, {});
        relayed_log += std::exchange(relayed.log, {});
        ASSERT_EQ(relayed_log, log);
      });
  for (const char* sign : {"done", "no answer", "exception 05", "result", "frame"})
    EXPECT_NE(log.find(sign), std::string::npos) << sign;
  EXPECT_NE(log.find(GetParam().tcp ? "no connection" : "damaged answer"), std::string::npos);
  EXPECT_GT(std::count(log.begin(), log.end(), '>'), 300);
}

INSTANTIATE_TEST_SUITE_P(Lines, ModbusSnapshot,
                         testing::Values(Case{false, 1}, Case{false, 2}, Case{true, 3}, Case{true, 4}));

TEST(ModbusSnapshots, ForgedOnesLeaveTheMasterAsItWas) {
  Bench one(true);
  for (int i = 0; i < 60; ++i) story(one, 9);
  Bench other(true);
  for (int i = 0; i < 90; ++i) story(other, 2);
  expect_forged_leave_no_trace(one, save_snapshot(other), 500, 5, 60, [](Bench&) {});
}

TEST(ModbusSnapshots, ABoardThatTheProgramDoesNotKnowIsRefusedByName) {
  Bench one(true);
  BoardProfile own = *find_profile("oi-fr-e5nco", "modbus");
  own.board = "fr-unheard-of";
  Order o;
  o.node = 5;
  one.station->begin(one.scheduler.now(), own, o);
  Bench other(true);
  const auto loaded = load_snapshot(other, save_snapshot(one));
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().find("board fr-unheard-of over modbus"), std::string::npos) << loaded.error();
}

TEST(ModbusSnapshots, AMasterOfAnotherFramingIsRefused) {
  Bench rtu(false);
  Bench tcp(true);
  const auto loaded = load_snapshot(tcp, save_snapshot(rtu));
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().find("framing"), std::string::npos) << loaded.error();
}

}  // namespace
}  // namespace vinv::masters
