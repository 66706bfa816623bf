#include "sim/transports/faulty_udp.hpp"

#include <algorithm>
#include <utility>

namespace vinv::transports {

FaultyUdp::FaultyUdp(kernel::Scheduler& scheduler, std::unique_ptr<UdpPort> inner, std::shared_ptr<FaultCourse> course)
    : scheduler_(scheduler), inner_(std::move(inner)), course_(std::move(course)) {}

FaultyUdp::~FaultyUdp() {
  for (const Late& l : late_) scheduler_.cancel(l.event);
}

void FaultyUdp::set_handler(OnDatagram on_datagram) {
  handler_ = std::move(on_datagram);
  inner_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    pass(now, Direction::kReceive, from, bytes, 0);
  });
}

void FaultyUdp::send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp) {
  pass(now, Direction::kSend, to, bytes, dscp);
}

void FaultyUdp::deliver(Instant now, Direction direction, const Ipv4Endpoint& peer, ByteView bytes, std::uint8_t dscp) {
  if (direction == Direction::kSend) return inner_->send(now, peer, bytes, dscp);
  if (handler_) handler_(now, peer, bytes);
}

void FaultyUdp::pass(Instant now, Direction direction, const Ipv4Endpoint& peer, ByteView bytes, std::uint8_t dscp) {
  auto& [plan, counts, random] = *course_;
  if (plan.rules.empty() && late_.empty()) return deliver(now, direction, peer, bytes, dscp);
  const std::uint64_t before = next_late_;
  Datagram datagram{direction, peer, dscp, Bytes(bytes.begin(), bytes.end())};
  bool dropped = false, overtaken = false;
  std::optional<Duration> copy_after;
  Duration delay{};
  for (std::size_t i = 0; i < plan.rules.size(); ++i) {
    const FaultRule& rule = plan.rules[i];
    if (rule.direction != direction || !counts[i].hit(rule.when, now, random)) continue;
    Bytes& b = datagram.bytes;
    switch (rule.fault) {
      case Fault::kDrop: dropped = true; break;
      case Fault::kDelay: delay += rule.delay; break;
      case Fault::kReorder:
        delay += rule.delay;
        overtaken = true;
        break;
      case Fault::kDuplicate: copy_after = rule.delay; break;
      case Fault::kTruncate: b.resize(std::min(b.size(), rule.bytes)); break;
      case Fault::kCorrupt:
        if (b.empty()) break;
        for (std::size_t n = 0, at = random.below(b.size()); n < std::min(rule.bytes, b.size()); ++n, ++at)
          b[at % b.size()] ^= static_cast<std::uint8_t>(1u << random.below(8));
        break;
      case Fault::kSplit:
      case Fault::kGarble: break;
    }
  }
  if (!dropped) {
    const Instant start = std::max(now, scheduler_.now());
    if (copy_after) post(start + delay + *copy_after, datagram, false);
    if (delay > Duration{})
      post(start + delay, std::move(datagram), overtaken);
    else
      deliver(now, direction, peer, datagram.bytes, dscp);
  }
  release_overtaken(now, direction, before);
}

void FaultyUdp::post(Instant at, Datagram datagram, bool overtaken) {
  if (late_.size() >= kMaxDelayed) return;
  const std::uint64_t number = next_late_++;
  late_.push_back(
      {number, scheduler_.schedule(at, kernel::Priority::kWire, late_action(number)), overtaken, std::move(datagram)});
}

void FaultyUdp::release_overtaken(Instant now, Direction direction, std::uint64_t before) {
  for (;;) {
    const auto held = std::find_if(late_.begin(), late_.end(), [&](const Late& l) {
      return l.overtaken && l.number < before && l.datagram.direction == direction;
    });
    if (held == late_.end()) return;
    scheduler_.cancel(held->event);
    run_late(now, held->number);
  }
}

kernel::Scheduler::Action FaultyUdp::late_action(std::uint64_t number) {
  return [this, number](Instant now) { run_late(now, number); };
}

void FaultyUdp::run_late(Instant now, std::uint64_t number) {
  const auto at = std::find_if(late_.begin(), late_.end(), [&](const Late& l) { return l.number == number; });
  const Datagram due = std::move(at->datagram);
  late_.erase(at);
  deliver(now, due.direction, due.peer, due.bytes, due.dscp);
}

void FaultyUdp::archive_state(Archive& a) {
  // The handler is there before the load.
  VINV_MEMBERS(*this, scheduler, inner, course, handler, late, next_late);
  VINV_FIELDS(a, FaultyUdp, next_late);
  const std::size_t count = a.count(late.size(), kMaxDelayed);
  if (a.loads()) late.clear();
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    if (a.loads()) late.emplace_back();
    VINV_MEMBERS(late[i], number, event, overtaken, datagram);
    VINV_FIELDS(a, Late, number, overtaken, datagram);
    scheduler.archive_event(a, event, late_action(number));
    a.require(event != 0, "a delayed datagram never passes");
  }
}

}  // namespace vinv::transports
