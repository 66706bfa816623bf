// An event loop on a thread of its own, for tests whose foreign end is a blocking client on the test's thread. What
// lives on the loop is destroyed through call(), before the loop.
#pragma once

#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <functional>
#include <future>
#include <thread>

#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class LoopThread {
 public:
  LoopThread() : thread_([this] { loop_.run(); }) {}
  ~LoopThread() {
    loop_.stop();
    thread_.join();
  }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  EventLoop& loop() { return loop_; }
  // Runs it on the loop's thread and waits for it. Whatever the loop's thread touches is set up and looked at this way.
  void call(const std::function<void()>& action) {
    std::promise<void> done;
    asio::post(loop_.io(), [&] {
      if (action) action();
      done.set_value();
    });
    done.get_future().wait();
  }

 private:
  EventLoop loop_;
  std::thread thread_;
};

}  // namespace vinv::transports
