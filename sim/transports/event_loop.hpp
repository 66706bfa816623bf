// Real time: one thread that runs the scheduler's events at their time and serves sockets in between.
#pragma once

#include <functional>
#include <memory>

#include "sim/kernel/lateness.hpp"
#include "sim/kernel/scheduler.hpp"

namespace asio {
class io_context;
}

namespace vinv::transports {

class EventLoop {
 public:
  EventLoop();
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  kernel::Scheduler& scheduler();
  // Transports on this loop complete on its thread, between events, with now() at the real time.
  asio::io_context& io();
  // Simulated time now: real time since run() began, never before the last event that ran.
  Instant now() const;
  // Until stop(). If events fall behind, they run as fast as possible in order; nothing is skipped.
  void run();
  // From any thread or an action; run() returns after the current action.
  void stop();
  // SIGINT and SIGTERM call this handler on the loop's thread.
  void on_signal(std::function<void(int signal)> handler);
  // How late events ran against their time.
  const kernel::LatenessHistogram& lateness() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vinv::transports
