#include "sim/kernel/granted_clock.hpp"

namespace vinv::kernel {

void GrantedClock::run() {
  std::unique_lock lock(mutex_);
  struct Leave {  // entered with the mutex held, or by an exception without it
    GrantedClock& clock;
    std::unique_lock<std::mutex>& lock;
    ~Leave() {
      if (!lock.owns_lock()) lock.lock();
      clock.running_ = false;
      clock.stop_requested_ = true;
      clock.changed_.notify_all();
    }
  } const leave{*this, lock};

  for (;;) {
    changed_.wait(lock, [this] { return stop_requested_ || has_grant_; });
    if (stop_requested_) return;
    running_ = true;
    has_grant_ = false;
    while (!stop_requested_) {
      const Instant until = granted_;
      lock.unlock();
      const bool ran = scheduler_.run_next(until);
      lock.lock();
      if (ran || stop_requested_) continue;
      if (has_grant_) {
        has_grant_ = false;
        continue;
      }
      scheduler_.run_until(until);  // nothing is due: only moves now()
      break;
    }
    running_ = false;
    changed_.notify_all();
  }
}

bool GrantedClock::grant(Instant until) {
  const std::lock_guard lock(mutex_);
  if (stop_requested_ || until < granted_) return false;
  granted_ = until;
  has_grant_ = true;
  changed_.notify_all();
  return true;
}

GrantedClock::Report GrantedClock::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !running_ && (stop_requested_ || !has_grant_); });
  return {scheduler_.now(), scheduler_.next_event_at(), stop_requested_};
}

void GrantedClock::stop() {
  const std::lock_guard lock(mutex_);
  stop_requested_ = true;
  changed_.notify_all();
}

}  // namespace vinv::kernel
