// Real time: one thread that runs the scheduler's events at their time and serves sockets in between.
//
// Neither side can starve the other: overdue events are run for at most a slice, then sockets get a turn; between two
// socket handlers a due event goes first. Streams and listeners of a loop are destroyed before it.
//
// Streams and UDP sockets are in a ReadySet, everything else (listeners, serial lines, signals) in Asio's reactor. The
// loop sleeps in Asio's, of which the set is a part, until the set has traffic; then it sleeps in the set and looks at
// Asio's once a millisecond, until the set has been quiet for a while.
#pragma once

#include <functional>
#include <memory>

#include "sim/kernel/lateness.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/ready_set.hpp"

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
  // Transports on this loop complete on its thread, between events, with now() as the time.
  asio::io_context& io();
  // For sockets with much traffic; handlers run like those of io().
  ReadySet& ready_set();
  // Simulated time now: real time since run() began, never before the last event that ran and never past one that
  // still waits, so that an engine's time does not go back when the machine is behind. Outside run() it stands still.
  Instant now() const;
  // Until stop(). If events fall behind, they run as fast as possible in order; nothing is skipped. A further run()
  // goes on from the time at which the last one stopped.
  void run();
  // From any thread or an action; run() returns after the current action. Before run(): it returns at once.
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
