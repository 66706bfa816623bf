// What a session says to its client within one instant goes out in one piece, at the end of the instant: a burst of
// frames costs one write to a socket and not one each. Keeps its memory, so that a steady stream allocates nothing.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

class SessionText {
 public:
  // Scheduler and stream outlive it.
  SessionText(kernel::Scheduler& scheduler, ByteStream& stream) : scheduler_(scheduler), stream_(stream) {}
  ~SessionText() { drop(); }
  SessionText(const SessionText&) = delete;
  SessionText& operator=(const SessionText&) = delete;

  // Append to it what is to be said.
  std::string& at(Instant now) {
    // The stream's own limit is for what its peer does not take, not for what we hold back.
    if (text_.size() > ByteStream::kMaxQueuedBytes / 2) send(now);
    if (event_ == 0) {
      event_ = scheduler_.schedule(std::max(now, scheduler_.now()), kernel::Priority::kObserver, [this](Instant t) {
        event_ = 0;
        send(t);
      });
    }
    return text_;
  }
  void say(Instant now, std::string_view text) { at(now) += text; }
  // At once: before a stream is closed, or what follows has to be another piece.
  void flush(Instant now) {
    if (event_ != 0) scheduler_.cancel(std::exchange(event_, 0));
    send(now);
  }
  void drop() {
    if (event_ != 0) scheduler_.cancel(std::exchange(event_, 0));
    text_.clear();
  }

 private:
  void send(Instant now) {
    if (text_.empty()) return;
    stream_.send(now, {reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()});
    text_.clear();
  }

  kernel::Scheduler& scheduler_;
  ByteStream& stream_;
  std::string text_;
  kernel::EventId event_ = 0;
};

}  // namespace vinv::transports
