#include "option_boards/boards/fr_a7ne/drive_link.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

bool stores(const port::WriteRequest& request) {
  using Kind = port::WriteRequest::Kind;
  return request.kind == Kind::kParameter || request.kind == Kind::kRestoreDefaults ||
         request.kind == Kind::kClearAlarmHistory || request.kind == Kind::kStoredFrequency;
}

}  // namespace

void DriveLink::start(Instant now, const ExplicitJob& job) {
  VINV_CHECK(!explicit_busy(now) && job.count > 0);
  state_.job = job;
  state_.step = 0;
  state_.storage_failed = false;
  state_.decided.reset();
  state_.answer_at = now + (job.clears ? state_.timing.clear : Duration{});
  state_.free_at = now + state_.timing.write;
}

void DriveLink::put(PolledTopic topic, const port::WriteRequest& request) {
  state_.polled[static_cast<std::size_t>(topic)] = request;
}

std::optional<Instant> DriveLink::next_deadline() const {
  const bool waits = state_.decided || (state_.job && state_.job->clears && state_.step > 0 && !state_.posted);
  return waits ? std::optional(state_.answer_at) : std::nullopt;
}

std::optional<Finished> DriveLink::finish_job(const port::WriteOutcome& outcome) {
  Finished finished;
  finished.request = state_.job->steps[std::min<std::size_t>(state_.step, state_.job->count - 1u)];
  finished.job = *std::exchange(state_.job, std::nullopt);
  finished.outcome = outcome;
  finished.storage_failed = state_.storage_failed;
  state_.decided.reset();
  return finished;
}

std::optional<Finished> DriveLink::advance(Instant now, port::DrivePort& drive) {
  if (auto finished = collect(now, drive)) return finished;
  if (state_.decided && now >= state_.answer_at) return finish_job(port::WriteOutcome(*state_.decided));
  return post_next(now, drive);
}

std::optional<Finished> DriveLink::collect(Instant now, port::DrivePort& drive) {
  if (!state_.posted) return std::nullopt;
  auto outcome = drive.take_outcome();
  if (!outcome) {
    if (drive.write_pending()) return std::nullopt;
    // The inverter restarted and lost it.
    outcome = port::WriteOutcome(Unexpected(port::Refusal::kNotReady));
  }
  const PostedWrite posted = *std::exchange(state_.posted, std::nullopt);
  const bool storage_failed =
      outcome->has_value() && stores(posted.request) && drive.storage_failures() != posted.storage_failures_before;
  if (!posted.explicit_write) return polled(posted.topic, posted.request, *outcome, storage_failed);
  VINV_CHECK(state_.job.has_value());
  state_.storage_failed = state_.storage_failed || storage_failed;
  if (outcome->has_value() && ++state_.step < state_.job->count) return std::nullopt;
  // A refusal need not wait for what is not done.
  if (!outcome->has_value() || now >= state_.answer_at) return finish_job(*outcome);
  state_.decided = *outcome;
  return std::nullopt;
}

Finished DriveLink::polled(PolledTopic topic, const port::WriteRequest& request, const port::WriteOutcome& outcome,
                           bool storage_failed) {
  Finished finished;
  finished.topic = topic;
  finished.request = request;
  finished.outcome = outcome;
  finished.storage_failed = storage_failed;
  return finished;
}

port::WriteOutcome DriveLink::post(Instant now, port::DrivePort& drive, const port::WriteRequest& request,
                                   std::optional<PolledTopic> topic) {
  const std::uint32_t failures = drive.storage_failures();
  const port::WriteOutcome posted = drive.post_write(now, request);
  if (posted) {
    state_.posted = PostedWrite{!topic, topic.value_or(PolledTopic::kRun), request, failures};
    state_.polled_was_last = topic.has_value();
  }
  return posted;
}

std::optional<Finished> DriveLink::post_next(Instant now, port::DrivePort& drive) {
  if (state_.posted) return std::nullopt;
  const bool job_waits = state_.job && !state_.decided && !clears_until(now);
  const auto first =
      std::find_if(state_.polled.begin(), state_.polled.end(), [](const auto& p) { return p.has_value(); });
  if (first != state_.polled.end() && !(job_waits && state_.polled_was_last)) {
    const auto topic = static_cast<PolledTopic>(first - state_.polled.begin());
    const port::WriteOutcome posted = post(now, drive, **first, topic);
    if (!posted && posted.error() == port::Refusal::kBusy) return std::nullopt;
    const port::WriteRequest request = *std::exchange(*first, std::nullopt);
    return posted ? std::nullopt : std::optional(polled(topic, request, posted, false));
  }
  if (!job_waits) return std::nullopt;
  const port::WriteOutcome posted = post(now, drive, state_.job->steps[state_.step], std::nullopt);
  if (posted || posted.error() == port::Refusal::kBusy) return std::nullopt;
  return finish_job(posted);
}

}  // namespace vinv::boards::fr_a7ne
