#include "sim/rig/wire_tap.hpp"

#include <utility>

namespace vinv::rig {

void WireTap::forget_dead() {
  std::erase_if(streams_, [](const auto& s) { return !s.alive(); });
}

std::unique_ptr<transports::ByteStream> WireTap::wrap(std::unique_ptr<transports::ByteStream> stream) {
  forget_dead();
  auto faulty = std::make_unique<transports::FaultInjector>(scheduler_, std::move(stream),
                                                            transports::FaultPlan{.seed = seed_, .rules = faults_});
  streams_.push_back(faulty->handle());
  return faulty;
}

void WireTap::set_fault(const transports::FaultRule& rule) {
  const auto replaced =
      std::erase_if(faults_, [&](const auto& r) { return r.fault == rule.fault && r.direction == rule.direction; });
  if (rule.when.acts()) faults_.push_back(rule);
  for (const auto& stream : streams_) {
    if (replaced > 0) {
      stream.clear();
      for (const transports::FaultRule& r : faults_) stream.add(r);
    } else if (rule.when.acts()) {
      stream.add(rule);
    }
  }
}

void WireTap::clear_faults() {
  faults_.clear();
  for (const auto& stream : streams_) stream.clear();
}

void WireTap::half_open() {
  for (const auto& stream : streams_) stream.half_open();
}

void WireTap::reseed(std::uint64_t seed) {
  seed_ = seed;
  for (const auto& stream : streams_) stream.reseed(seed);
}

void WireTap::archive_state(Archive& a) {
  VINV_MEMBERS(*this, scheduler, seed, faults, streams);
  VINV_FIELDS(a, WireTap, seed, faults);
  std::vector<transports::FaultInjector::Handle*> held;
  for (auto& stream : streams)
    if (stream.end_number() != 0) held.push_back(&stream);
  const std::size_t count = a.count(held.size());
  a.require(count == held.size(), "a wire has another number of streams");
  if (a.failed()) return;
  for (auto* stream : held) a.io(*stream);
}

}  // namespace vinv::rig
