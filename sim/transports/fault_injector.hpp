// Faults on a line: a stream around a stream that drops, delays, duplicates, corrupts, truncates or splits what passes.
// The same plan and the same traffic give the same faults. Order within a direction is kept, as on a real stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

enum class Fault : std::uint8_t {
  kDrop,
  kDelay,      // by FaultRule::delay
  kDuplicate,  // the copy comes after FaultRule::delay
  kCorrupt,    // one bit in each of FaultRule::bytes neighbouring bytes
  kTruncate,   // the first FaultRule::bytes stay
  kSplit,      // into single bytes, FaultRule::delay apart
};

// Seen from our end.
enum class Direction : std::uint8_t { kSend, kReceive };

// A piece is what one send() or one on_bytes carries.
struct FaultRule {
  Fault fault = Fault::kDrop;
  Direction direction = Direction::kSend;
  std::uint64_t nth = 0;   // the nth piece of the direction, counted from 1; 0: by probability
  double probability = 0;  // of each piece, 0 to 1
  Duration delay{};
  std::size_t bytes = 1;
};

// Rules act in their order on what the rules before them left.
struct FaultPlan {
  std::uint64_t seed = 1;
  std::vector<FaultRule> rules;
};

class FaultInjector : public ByteStream {
 public:
  // The scheduler outlives the stream.
  FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner, FaultPlan plan);
  ~FaultInjector() override;
  FaultInjector(const FaultInjector&) = delete;
  FaultInjector& operator=(const FaultInjector&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override;
  // Delayed pieces count against kMaxQueuedBytes, in each direction.
  void send(Instant now, ByteView bytes) override;
  void close() override;
  std::string name() const override;

  // Rules that have acted so far.
  std::uint64_t injected() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
