// Faults on a line: a stream around a stream that drops, delays, duplicates, corrupts, reorders, truncates or splits
// what passes, or goes dead. The same plan and the same traffic give the same faults. Order within a direction is kept,
// as on a real stream, but for kReorder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/random.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/fault_trigger.hpp"

namespace vinv::transports {

enum class Fault : std::uint8_t {
  kDrop,
  kDelay,      // by FaultRule::delay
  kDuplicate,  // the copy comes after FaultRule::delay
  kCorrupt,    // one bit in each of FaultRule::bytes neighbouring bytes
  kTruncate,   // the first FaultRule::bytes stay
  kSplit,      // into single bytes, FaultRule::delay apart
  kReorder,    // behind the next piece of its direction, but not later than FaultRule::delay
  kGarble,     // every byte: two talk at once
};
VINV_ENUM_RANGE(Fault, kDrop, kGarble);

// Seen from our end.
enum class Direction : std::uint8_t { kSend, kReceive };
VINV_ENUM_RANGE(Direction, kSend, kReceive);

// A piece is what one send() or one on_bytes carries.
struct FaultRule {
  Fault fault = Fault::kDrop;
  Direction direction = Direction::kSend;
  FaultTrigger when;  // of the pieces of the direction
  Duration delay{};
  std::size_t bytes = 1;
  VINV_ARCHIVE(FaultRule, fault, direction, when, delay, bytes);
};

// Rules act in their order on what the rules before them left.
struct FaultPlan {
  std::uint64_t seed = 1;
  std::vector<FaultRule> rules;
  VINV_ARCHIVE(FaultPlan, seed, rules);
};

// A plan and how far it has come. Streams that follow each other on one wire share it: the third frame is the third of
// the wire, whatever connections were made.
struct FaultCourse {
  explicit FaultCourse(FaultPlan p) : plan(std::move(p)), counts(plan.rules.size()), random(plan.seed) {}
  // Counts and chance begin anew.
  void restart(FaultPlan p) { *this = FaultCourse(std::move(p)); }
  // Chance begins anew; what the rules have counted stays.
  void reseed(std::uint64_t seed) {
    plan.seed = seed;
    random = Random(seed);
  }
  // Behind the rules there are; pieces are counted for it from now on.
  void add(const FaultRule& rule) {
    plan.rules.push_back(rule);
    counts.emplace_back();
  }

  FaultPlan plan;
  std::vector<FaultCount> counts;  // by rule
  Random random;
  friend void archive(Archive& a, FaultCourse& course) {
    VINV_MEMBERS(course, plan, counts, random);
    VINV_FIELDS(a, FaultCourse, plan, counts, random);
    a.require(counts.size() == plan.rules.size(), "a fault plan has more or fewer counts than rules");
  }
};

class FaultInjector : public ByteStream {
 private:
  struct Impl;

 public:
  // Reaches an injector for as long as it lives, whoever owns it.
  class Handle {
   public:
    bool alive() const { return !impl_.expired(); }
    // The peer is gone without a word: nothing passes any more in either direction, and no end is told.
    void half_open() const;
    // As ByteStream::end_number(); 0 of one that is not alive.
    std::uint32_t end_number() const;
    // Of one that is alive: what it holds back. Not its course, nor the stream inside.
    friend void archive(Archive& a, Handle& handle) { handle.archive_state(a); }

   private:
    void archive_state(Archive& a);
    friend class FaultInjector;
    explicit Handle(std::weak_ptr<Impl> impl) : impl_(std::move(impl)) {}
    std::weak_ptr<Impl> impl_;
  };

  // The scheduler outlives the stream.
  FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner, FaultPlan plan);
  FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner, std::shared_ptr<FaultCourse> course);
  ~FaultInjector() override;
  FaultInjector(const FaultInjector&) = delete;
  FaultInjector& operator=(const FaultInjector&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override;
  // Delayed pieces count against kMaxQueuedBytes, in each direction.
  void send(Instant now, ByteView bytes) override;
  void close() override;
  std::string name() const override;
  std::uint32_t end_number() const override;

  // Rules that have acted so far.
  std::uint64_t injected() const;
  Handle handle() const { return Handle(impl_); }

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
