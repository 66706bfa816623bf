#include "sim/rig/wire_tap.hpp"

#include <utility>

namespace vinv::rig {

void WireTap::forget_dead() {
  std::erase_if(streams_, [](const auto& s) { return !s.alive(); });
}

transports::FaultCourse& WireTap::course() {
  if (course_ == nullptr)
    course_ = std::make_shared<transports::FaultCourse>(transports::FaultPlan{.seed = seed_, .rules = {}});
  return *course_;
}

const std::vector<transports::FaultRule>& WireTap::faults() const {
  static const std::vector<transports::FaultRule> kNone;
  return course_ == nullptr ? kNone : course_->plan.rules;
}

std::unique_ptr<transports::ByteStream> WireTap::wrap(std::unique_ptr<transports::ByteStream> stream) {
  forget_dead();
  course();
  auto faulty = std::make_unique<transports::FaultInjector>(scheduler_, std::move(stream), course_);
  streams_.push_back(faulty->handle());
  return faulty;
}

std::unique_ptr<transports::FaultyUdp> WireTap::wrap(std::unique_ptr<transports::UdpPort> port) {
  course();
  return std::make_unique<transports::FaultyUdp>(scheduler_, std::move(port), course_);
}

void WireTap::set_fault(const transports::FaultRule& rule) {
  std::vector<transports::FaultRule> rules = course().plan.rules;
  const auto replaced =
      std::erase_if(rules, [&](const auto& r) { return r.fault == rule.fault && r.direction == rule.direction; });
  if (replaced > 0) course().restart({.seed = seed_, .rules = std::move(rules)});
  if (rule.when.acts()) course().add(rule);
}

void WireTap::clear_faults() { course().restart({.seed = seed_, .rules = {}}); }

void WireTap::half_open() {
  for (const auto& stream : streams_) stream.half_open();
}

void WireTap::archive_state(Archive& a) {
  VINV_MEMBERS(*this, scheduler, seed, way, streams);
  VINV_FIELDS(a, WireTap, seed, course());
  std::vector<transports::FaultInjector::Handle*> held;
  for (auto& stream : streams)
    if (stream.end_number() != 0) held.push_back(&stream);
  const std::size_t count = a.count(held.size());
  a.require(count == held.size(), "a wire has another number of streams");
  if (a.failed()) return;
  for (auto* stream : held) a.io(*stream);
}

}  // namespace vinv::rig
