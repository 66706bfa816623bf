#include "sim/transports/event_loop.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
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
constexpr std::size_t kHandlersPerTurn = 64;
// While the set of sockets has traffic, Asio's reactor is looked at so often; a little less than a drive's tick, and
// put off until an event that comes soon, so that a tick is the only wake-up there is.
constexpr Duration kReactorInterval = std::chrono::microseconds(900);
constexpr Duration kReactorPatience = std::chrono::microseconds(500);
// This long after the last traffic the loop sleeps there again.
constexpr Duration kTrafficWindow = std::chrono::milliseconds(20);
// Longest sleep: keeps the sum of a far event's time and the clock from overflowing.
constexpr Duration kLongestSleep = std::chrono::hours(1);

// The kernel may let a thread oversleep by its slack, usually 50 us, to save power. Until the end of the scope.
class NoTimerSlack {
 public:
  NoTimerSlack() : before_(::prctl(PR_GET_TIMERSLACK)) { ::prctl(PR_SET_TIMERSLACK, 1); }
  ~NoTimerSlack() {
    if (before_ > 0) ::prctl(PR_SET_TIMERSLACK, before_);
  }
  NoTimerSlack(const NoTimerSlack&) = delete;
  NoTimerSlack& operator=(const NoTimerSlack&) = delete;

 private:
  int before_;
};

}  // namespace

struct EventLoop::Impl {
  Impl() = default;
  ~Impl() {
    if (set_in_reactor.is_open()) set_in_reactor.release();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  kernel::Scheduler scheduler;  // first, so that it outlives what the io_context still holds
  ReadySet ready_set;
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  asio::steady_timer timer{io};
  asio::signal_set signals{io};
  asio::posix::stream_descriptor set_in_reactor{io};  // the set keeps its descriptor
  std::function<void(int)> signal_handler;
  kernel::LatenessHistogram lateness;
  RealClock::time_point zero;  // the real time of simulated 0, while running
  mutable std::uint64_t clock_reads = 0;
  mutable Instant read_at{};       // by the last of them
  mutable bool is_recent = false;  // the loop has not slept since; one reading for each message is enough
  bool running = false;
  std::atomic<bool> stop_requested{false};
  std::optional<Instant> armed_for;
  bool has_traffic = false;  // of the set: the loop sleeps there
  Instant traffic_until{};
  Instant reactor_at{};  // next look at Asio's, while the set has traffic

  Instant real_now() const {
    ++clock_reads;
    is_recent = true;
    return read_at = Instant{std::chrono::duration_cast<Duration>(RealClock::now() - zero)};
  }
  Instant recent_now() const { return is_recent ? read_at : real_now(); }

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
    Instant real = recent_now();
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

  // Asio tells when the set has something while the loop sleeps in Asio's reactor; while it does not, the reactor does
  // not know the set, which would be told of each packet in vain.
  void watch_set() {
    if (set_in_reactor.is_open()) return;
    set_in_reactor.assign(ready_set.fd());
    set_in_reactor.async_wait(asio::posix::stream_descriptor::wait_read, [this](const asio::error_code& error) {
      if (error) return;
      set_in_reactor.release();
      has_traffic = true;
      if (running) reactor_at = traffic_until = real_now() + kReactorInterval;
    });
  }

  bool interrupted() const { return stop_requested.load(std::memory_order_relaxed) || is_due(real_now()); }

  void serve_reactor(bool may_sleep) {
    watch_set();
    std::size_t served = 0;
    if (may_sleep) {
      arm_timer();
      served = io.run_one();
    } else {
      served = io.poll_one();
    }
    for (std::size_t i = 1; served != 0 && i < kHandlersPerTurn && !interrupted(); ++i) served = io.poll_one();
    is_recent = false;
  }

  void serve_set(bool may_sleep) {
    const Instant real = recent_now();
    is_recent = false;
    if (may_sleep) {
      const auto next = scheduler.next_event_at();
      const Instant wake = next && *next <= reactor_at + kReactorPatience ? *next : reactor_at;
      ready_set.wait(zero + wake.time_since_epoch());
    } else {
      ready_set.wait(std::nullopt);
    }
    bool any = false;
    for (std::uint64_t reads = clock_reads; ready_set.serve_one(); reads = clock_reads) {
      any = true;
      // A handler that asked for the time has asked for us as well. The next wait finds the rest again, behind others.
      if (stop_requested.load(std::memory_order_relaxed) || is_due(reads == clock_reads ? real_now() : read_at)) break;
    }
    if (any) {
      traffic_until = real + kTrafficWindow;
    } else if (real >= traffic_until) {
      has_traffic = false;
      ready_set.rest();
    }
  }

  void serve_sockets(bool may_sleep) {
    if (!has_traffic) return serve_reactor(may_sleep);
    serve_set(may_sleep);
    if (recent_now() < reactor_at) return;
    // A turn that was full, or that an event ended, goes on after it.
    if (serve_reactor_now()) reactor_at = recent_now() + kReactorInterval;
  }

  // True if nothing is left.
  bool serve_reactor_now() {
    for (std::size_t served = 0; served < kHandlersPerTurn; ++served) {
      if (io.poll_one() == 0) return true;
      if (interrupted()) return false;
    }
    return false;
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
ReadySet& EventLoop::ready_set() { return impl_->ready_set; }
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
  const NoTimerSlack precise;
  impl.reactor_at = impl.traffic_until = impl.real_now();
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
