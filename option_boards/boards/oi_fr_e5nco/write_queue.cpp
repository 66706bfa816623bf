#include "option_boards/boards/oi_fr_e5nco/write_queue.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace vinv::boards::oi_fr_e5nco {
namespace {

bool replaces(const WriteJob& later, const WriteJob& earlier) {
  if (later.origin == WriteOrigin::kSdo || earlier.origin == WriteOrigin::kSdo) return false;
  if (later.topic != earlier.topic || later.topic == WriteTopic::kOther) return false;
  return later.topic != WriteTopic::kParameter || later.steps[0].parameter == earlier.steps[0].parameter;
}

bool stores(const port::WriteRequest& request) {
  using Kind = port::WriteRequest::Kind;
  return request.kind == Kind::kParameter || request.kind == Kind::kRestoreDefaults ||
         request.kind == Kind::kClearAlarmHistory;
}

bool awaited(const WriteJob& job) { return job.origin == WriteOrigin::kSdo || job.origin == WriteOrigin::kNmt; }

}  // namespace

bool WriteQueue::put(const WriteJob& job) {
  for (std::size_t i = 0; i < state_.count; ++i) {
    WriteJob& waiting = state_.jobs[i];
    if (!replaces(job, waiting)) continue;
    const bool enables = waiting.enables;
    const auto target_before = waiting.target_before;
    waiting = job;
    // What has to be taken back is what was before both.
    waiting.enables = waiting.enables || enables;
    if (target_before) waiting.target_before = target_before;
    return true;
  }
  if (state_.count == kCapacity) return false;
  state_.jobs[state_.count++] = job;
  return true;
}

void WriteQueue::put_first(const WriteJob& job) {
  for (std::size_t i = state_.count; i-- > 0;) {
    if (state_.jobs[i].topic == WriteTopic::kRun && state_.jobs[i].origin != WriteOrigin::kSdo) remove(i);
  }
  if (state_.count == kCapacity) {
    const auto last = std::find_if_not(state_.jobs.rbegin(), state_.jobs.rend(), awaited);
    remove(last == state_.jobs.rend() ? kCapacity - 1 : static_cast<std::size_t>(state_.jobs.rend() - last) - 1);
  }
  std::move_backward(state_.jobs.begin(), state_.jobs.begin() + static_cast<std::ptrdiff_t>(state_.count),
                     state_.jobs.begin() + static_cast<std::ptrdiff_t>(state_.count) + 1);
  state_.jobs[0] = job;
  ++state_.count;
}

void WriteQueue::remove(std::size_t at) {
  const auto begin = state_.jobs.begin();
  std::move(begin + static_cast<std::ptrdiff_t>(at) + 1, begin + static_cast<std::ptrdiff_t>(state_.count),
            begin + static_cast<std::ptrdiff_t>(at));
  --state_.count;
}

void WriteQueue::abandon_sdo() {
  for (std::size_t i = 0; i < state_.count; ++i) {
    if (state_.jobs[i].origin == WriteOrigin::kSdo) state_.jobs[i].origin = WriteOrigin::kInternal;
  }
  if (state_.in_work && state_.in_work->job.origin == WriteOrigin::kSdo) {
    state_.in_work->job.origin = WriteOrigin::kInternal;
  }
}

void WriteQueue::clear() {
  static_assert(std::is_trivially_copyable_v<State>);  // so that a copy of it is a snapshot
  state_.count = 0;
  if (!state_.in_work) return;
  if (!state_.in_work->posted) {
    state_.in_work.reset();
  } else {
    state_.in_work->silent = true;
    state_.in_work->job.count = static_cast<std::uint8_t>(state_.in_work->step + 1);
  }
}

bool WriteQueue::holds(WriteTopic topic) const {
  if (state_.in_work && state_.in_work->job.topic == topic) return true;
  return std::any_of(state_.jobs.begin(), state_.jobs.begin() + static_cast<std::ptrdiff_t>(state_.count),
                     [&](const WriteJob& job) { return job.topic == topic; });
}

std::optional<FinishedWrite> WriteQueue::finish(const port::WriteOutcome& outcome, bool lost) {
  const InWork done = *std::exchange(state_.in_work, std::nullopt);
  FinishedWrite finished{done.job, outcome, lost, done.storage_failed};
  if (done.silent) finished.job.origin = WriteOrigin::kInternal;
  return finished;
}

std::optional<FinishedWrite> WriteQueue::advance(Instant now, port::DrivePort& drive) {
  if (state_.in_work && state_.in_work->posted) {
    const auto outcome = drive.take_outcome();
    if (!outcome && drive.write_pending()) return std::nullopt;
    InWork& work = *state_.in_work;
    if (!outcome) return finish(Unexpected(port::Refusal::kNotReady), true);
    if (!*outcome) return finish(*outcome, false);
    work.storage_failed = work.storage_failed || (stores(work.job.steps[work.step]) &&
                                                  drive.storage_failures() != work.storage_failures_before);
    work.posted = false;
    if (++work.step == work.job.count) return finish(*outcome, false);
  }
  if (!state_.in_work) {
    if (state_.count == 0) return std::nullopt;
    state_.in_work = InWork{};
    state_.in_work->job = state_.jobs[0];
    remove(0);
  }
  InWork& work = *state_.in_work;
  work.storage_failures_before = drive.storage_failures();
  const auto posted = drive.post_write(now, work.job.steps[work.step]);
  if (posted) {
    work.posted = true;
    return std::nullopt;
  }
  const bool wait = posted.error() == port::Refusal::kBusy ||
                    (posted.error() == port::Refusal::kNotReady && work.job.origin == WriteOrigin::kNmt);
  if (wait) return std::nullopt;
  return finish(posted, false);
}

}  // namespace vinv::boards::oi_fr_e5nco
