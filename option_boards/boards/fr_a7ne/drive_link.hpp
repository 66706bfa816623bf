// The way to the inverter's one write mailbox. FR-A7NE manual, 6.2: explicit writes one at a time, each about 100 ms of
// processing, a parameter clear about 5 s; polled data beside them.
//
// Of polled writes to the same thing only the latest waits. Polled and explicit writes take turns, so that a master
// that polls fast does not keep an explicit one waiting.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/cip/message.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::boards::fr_a7ne {

// What an explicit write means to the board once the inverter has taken it.
enum class Effect : std::uint8_t { kNone, kTerminals, kFlashClear };
VINV_ENUM_RANGE(Effect, kNone, kFlashClear);

struct ExplicitJob {
  static constexpr std::size_t kMostSteps = 2;

  cip::Ticket ticket = 0;
  std::array<port::WriteRequest, kMostSteps> steps{};
  std::uint8_t count = 0;
  Effect effect = Effect::kNone;
  bool clears = false;  // takes as long as a parameter clear

  void add(const port::WriteRequest& step) { steps[count++] = step; }
  VINV_ARCHIVE(ExplicitJob, ticket, steps, count, effect, clears);
};

// Polled writes by what they replace, in order of their urgency.
enum class PolledTopic : std::uint8_t { kFaultReset, kRun, kFrequency, kOutputs };
inline constexpr std::size_t kPolledTopics = 4;
VINV_ENUM_RANGE(PolledTopic, kFaultReset, kOutputs);

struct Timing {
  Duration write{};  // after an explicit write has begun the next one is refused for so long
  Duration clear{};  // from a parameter clear to its answer
  // As the manual has it, and as fast as the inverter decides.
  static Timing real() { return {std::chrono::milliseconds(100), std::chrono::seconds(5)}; }
  static Timing fast() { return {}; }
  VINV_ARCHIVE(Timing, write, clear);
};

struct Finished {
  std::optional<ExplicitJob> job;  // otherwise polled
  PolledTopic topic = PolledTopic::kRun;
  port::WriteRequest request;  // the one that was decided last
  port::WriteOutcome outcome;
  bool storage_failed = false;  // accepted, and it could not be stored
};

// What is in the mailbox.
struct PostedWrite {
  bool explicit_write = false;
  PolledTopic topic = PolledTopic::kRun;
  port::WriteRequest request;
  std::uint32_t storage_failures_before = 0;
  VINV_ARCHIVE(PostedWrite, explicit_write, topic, request, storage_failures_before);
};

class DriveLink {
 public:
  void set_timing(const Timing& timing) { state_.timing = timing; }
  // An explicit write would be refused ("Object State Conflict", 6.2.2).
  bool explicit_busy(Instant now) const { return state_.job.has_value() || now < state_.free_at; }
  // Not while explicit_busy. The job has steps.
  void start(Instant now, const ExplicitJob& job);
  void put(PolledTopic topic, const port::WriteRequest& request);
  // The supply went.
  void clear() {
    const Timing timing = state_.timing;
    state_ = {};
    state_.timing = timing;
  }
  // Collects decisions, posts the next request. Call until empty.
  std::optional<Finished> advance(Instant now, port::DrivePort& drive);
  // When an answer is due that only waits for its time, or what follows a parameter clear.
  std::optional<Instant> next_deadline() const;

 private:
  struct State {
    Timing timing;
    std::optional<ExplicitJob> job;
    std::uint8_t step = 0;
    bool storage_failed = false;
    std::optional<port::WriteOutcome> decided;  // of the job; waits for answer_at
    Instant answer_at{};
    Instant free_at{};
    std::array<std::optional<port::WriteRequest>, kPolledTopics> polled{};
    std::optional<PostedWrite> posted;
    bool polled_was_last = false;
    VINV_ARCHIVE(State, timing, job, step, storage_failed, decided, answer_at, free_at, polled, posted,
                 polled_was_last);
  };

  // The parameter clear has been decided and takes its time; the next step comes after it.
  bool clears_until(Instant now) const {
    return state_.job && state_.job->clears && state_.step > 0 && now < state_.answer_at;
  }
  std::optional<Finished> collect(Instant now, port::DrivePort& drive);
  std::optional<Finished> finish_job(const port::WriteOutcome& outcome);
  static Finished polled(PolledTopic topic, const port::WriteRequest& request, const port::WriteOutcome& outcome,
                         bool storage_failed);
  std::optional<Finished> post_next(Instant now, port::DrivePort& drive);
  port::WriteOutcome post(Instant now, port::DrivePort& drive, const port::WriteRequest& request,
                          std::optional<PolledTopic> topic);

  State state_;

  friend void archive(Archive& a, DriveLink& link) { a.io(link.state_); }
};

}  // namespace vinv::boards::fr_a7ne
