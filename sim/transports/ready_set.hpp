// Sockets whose traffic is frequent, in one level-triggered epoll of their own: a packet costs the call that waits for
// it and the call that takes it, which a general reactor cannot do (docs/decisions/0009-ethernet-ip-speed.md).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/transports/unique_fd.hpp"

struct epoll_event;

namespace vinv::transports {

class ReadyHandler {
 public:
  // events: EPOLLIN, EPOLLOUT, EPOLLHUP, EPOLLERR of <sys/epoll.h>. May remove itself and others.
  virtual void on_ready(std::uint32_t events) = 0;

 protected:
  ~ReadyHandler() = default;
};

class ReadySet {
 public:
  // Descriptors that one call looks at.
  static constexpr std::size_t kBatch = 64;

  ReadySet();
  ~ReadySet();
  ReadySet(const ReadySet&) = delete;
  ReadySet& operator=(const ReadySet&) = delete;

  // Of a descriptor in the set; never 0.
  using Id = std::uint64_t;
  // Handler and descriptor outlive their place in the set.
  Id add(int fd, std::uint32_t events, ReadyHandler& handler);
  void change(Id id, int fd, std::uint32_t events);
  void remove(Id id, int fd);

  // The set's own descriptor: readable while one of its sockets is ready.
  int fd() const { return epoll_.get(); }
  // Finds what is ready, and sleeps until there is something or until the steady clock's time; empty: does not sleep.
  void wait(std::optional<std::chrono::steady_clock::time_point> until);
  // Before others wait for fd(): no time makes it readable.
  void rest();
  // Serves the next of what the last wait found; false if that was all. A time that has come is nothing.
  bool serve_one();

 private:
  struct Place {
    ReadyHandler* handler = nullptr;  // nullptr: free
    std::uint32_t generation = 1;
  };
  void arm(std::chrono::steady_clock::time_point at);

  UniqueFd epoll_;
  // A wait with a time-out would set a timer of the processor for each packet; this one is set for each deadline.
  UniqueFd timer_;
  std::optional<std::chrono::steady_clock::time_point> armed_for_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> free_;
  std::vector<epoll_event> found_;
  std::size_t next_ = 0, count_ = 0;  // of found_
};

}  // namespace vinv::transports
