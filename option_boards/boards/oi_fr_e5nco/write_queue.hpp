// What the CANopen side wants written, on its way through the inverter's one mailbox. First in, first out; of PDO
// writes to the same thing only the latest waits, in the place of the first, so that a master that sends faster than
// the inverter decides never falls behind.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "motor_model/port/drive_port.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::boards::oi_fr_e5nco {

enum class WriteOrigin : std::uint8_t {
  kSdo,       // a client awaits the decision
  kPdo,       // a refusal becomes an EMCY
  kNmt,       // operation mode by NMT start: waits until the inverter is ready, a refusal becomes an EMCY
  kInternal,  // the board's own: a refusal is nobody's business
};
VINV_ENUM_RANGE(WriteOrigin, kSdo, kInternal);

// What replaces what. kRun: everything that starts or stops the motor.
enum class WriteTopic : std::uint8_t { kMode, kRun, kFrequency, kAnalog, kParameter, kOther };
VINV_ENUM_RANGE(WriteTopic, kMode, kOther);

struct WriteJob {
  WriteOrigin origin = WriteOrigin::kPdo;
  WriteTopic topic = WriteTopic::kOther;
  // One or two requests that belong together; the first refusal ends the job.
  std::array<port::WriteRequest, 2> steps{};
  std::uint8_t count = 0;
  // Velocity mode: what to take back if the inverter refuses.
  bool enables = false;
  std::optional<std::int16_t> target_before{};

  void add(const port::WriteRequest& step) { steps[count++] = step; }
  friend void archive(Archive& a, WriteJob& job) {
    VINV_MEMBERS(job, origin, topic, steps, count, enables, target_before);
    VINV_FIELDS(a, WriteJob, origin, topic, steps, count, enables, target_before);
    a.require(count <= steps.size(), "a write has more steps than there can be");
  }
};

struct FinishedWrite {
  WriteJob job;
  port::WriteOutcome outcome;
  bool lost = false;            // the inverter restarted before it decided; outcome is kNotReady
  bool storage_failed = false;  // accepted, but it could not be stored
};

class WriteQueue {
 public:
  // PDOs of 4 objects, 4 of them, an SDO, NMT and the board's own.
  static constexpr std::size_t kCapacity = 20;

  // False: no room.
  bool put(const WriteJob& job);
  // Before everything that waits, and instead of what would start or stop the motor. With no room the last one goes
  // for which nobody waits.
  void put_first(const WriteJob& job);
  // Nobody waits for the client's write any more; it is still carried out.
  void abandon_sdo();
  // Everything that is not with the inverter yet is forgotten; of that what is, nobody hears.
  void clear();
  bool holds(WriteTopic topic) const;
  bool idle() const { return state_.count == 0 && !state_.in_work; }

  // Collects a decision, posts the next request. Call until empty.
  std::optional<FinishedWrite> advance(Instant now, port::DrivePort& drive);

  friend void archive(Archive& a, WriteQueue& queue) {
    VINV_MEMBERS(queue, state);
    a.io(state);
    a.require(state.count <= kCapacity, "more writes wait than there can be");
    a.require(!state.in_work || state.in_work->step < state.in_work->job.count, "a write is at a step that it has not");
  }

 private:
  struct InWork {
    WriteJob job;
    std::uint8_t step = 0;
    bool posted = false;
    bool silent = false;  // nobody hears of the outcome
    std::uint32_t storage_failures_before = 0;
    bool storage_failed = false;
    VINV_ARCHIVE(InWork, job, step, posted, silent, storage_failures_before, storage_failed);
  };
  struct State {
    std::array<WriteJob, kCapacity> jobs{};
    std::size_t count = 0;
    std::optional<InWork> in_work;
    VINV_ARCHIVE(State, jobs, count, in_work);
  };

  void remove(std::size_t at);
  std::optional<FinishedWrite> finish(const port::WriteOutcome& outcome, bool lost);

  State state_;
};

}  // namespace vinv::boards::oi_fr_e5nco
