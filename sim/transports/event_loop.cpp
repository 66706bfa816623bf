#include "sim/transports/event_loop.hpp"

#include <algorithm>
#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <asio/signal_set.hpp>
#include <asio/steady_timer.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <optional>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::transports {
namespace {

using RealClock = std::chrono::steady_clock;

// What overdue events may take before sockets get a turn.
constexpr Duration kEventSlice = std::chrono::milliseconds(2);
// Socket handlers in one turn.
constexpr int kHandlersPerTurn = 64;
// Longest sleep: keeps the sum of a far event's time and the clock from overflowing.
constexpr Duration kLongestSleep = std::chrono::hours(1);

}  // namespace

struct EventLoop::Impl {
  kernel::Scheduler scheduler;  // first, so that it outlives what the io_context still holds
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  asio::steady_timer timer{io};
  asio::signal_set signals{io};
  std::function<void(int)> signal_handler;
  kernel::LatenessHistogram lateness;
  RealClock::time_point zero;  // the real time of simulated 0, while running
  bool running = false;
  std::atomic<bool> stop_requested{false};
  std::optional<Instant> armed_for;

  Instant real_now() const { return Instant{std::chrono::duration_cast<Duration>(RealClock::now() - zero)}; }

  Instant now() const {
    Instant t = scheduler.now();
    if (!running) return t;
    t = std::max(t, real_now());
    if (const auto next = scheduler.next_event_at()) t = std::min(t, *next);
    return t;
  }

  bool is_due(Instant real) const {
    const auto next = scheduler.next_event_at();
    return next && *next <= real;
  }

  // Runs what is due. True if more is due than one slice holds.
  bool run_due_events() {
    Instant real = real_now();
    const Instant slice_end = real + kEventSlice;
    while (!stop_requested.load(std::memory_order_relaxed)) {
      const auto next = scheduler.next_event_at();
      if (!next || *next > real) return false;
      if (real >= slice_end) return true;
      lateness.add(real - *next);
      scheduler.run_next(real);
      real = real_now();
    }
    return false;
  }

  void arm_timer() {
    const auto next = scheduler.next_event_at();
    if (!next) return;
    const Instant wake = std::min(*next, real_now() + kLongestSleep);
    // A timer that fires too early costs a turn of the loop, setting it anew for every later event costs more.
    if (armed_for && *armed_for <= wake) return;
    armed_for = wake;
    timer.expires_at(zero + wake.time_since_epoch());
    timer.async_wait([this](const asio::error_code& error) {
      if (!error) armed_for.reset();
    });
  }

  void serve_sockets(bool may_sleep) {
    std::size_t served = 0;
    if (may_sleep) {
      arm_timer();
      served = io.run_one();
    } else {
      served = io.poll_one();
    }
    for (int i = 1; served != 0 && i < kHandlersPerTurn; ++i) {
      if (stop_requested.load(std::memory_order_relaxed) || is_due(real_now())) return;
      served = io.poll_one();
    }
  }

  void wait_for_signal() {
    signals.async_wait([this](const asio::error_code& error, int signal) {
      if (error) return;
      wait_for_signal();
      const auto handler = signal_handler;
      if (handler) handler(signal);
    });
  }
};

EventLoop::EventLoop() : impl_(std::make_unique<Impl>()) {}
EventLoop::~EventLoop() = default;

kernel::Scheduler& EventLoop::scheduler() { return impl_->scheduler; }
asio::io_context& EventLoop::io() { return impl_->io; }
Instant EventLoop::now() const { return impl_->now(); }
const kernel::LatenessHistogram& EventLoop::lateness() const { return impl_->lateness; }

void EventLoop::run() {
  Impl& impl = *impl_;
  VINV_CHECK(!impl.running);
  struct Leave {
    Impl& impl;
    ~Leave() {
      // The time that passed in this run stays passed, unless events are overdue.
      if (!impl.is_due(impl.now())) impl.scheduler.run_until(impl.now());
      impl.running = false;
      impl.timer.cancel();
      impl.armed_for.reset();
      impl.stop_requested = false;
    }
  };
  impl.zero = RealClock::now() - impl.scheduler.now().time_since_epoch();
  impl.running = true;
  const Leave leave{impl};
  impl.io.restart();
  while (!impl.stop_requested) {
    const bool behind = impl.run_due_events();
    if (impl.stop_requested) break;
    impl.serve_sockets(!behind);
  }
}

void EventLoop::stop() {
  impl_->stop_requested = true;
  asio::post(impl_->io, [] {});  // wakes a loop that sleeps
}

void EventLoop::on_signal(std::function<void(int signal)> handler) {
  const bool first = impl_->signal_handler == nullptr;
  impl_->signal_handler = std::move(handler);
  if (!first) return;
  impl_->signals.add(SIGINT);
  impl_->signals.add(SIGTERM);
  impl_->wait_for_signal();
}

}  // namespace vinv::transports
