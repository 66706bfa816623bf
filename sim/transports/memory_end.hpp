// One end of a line in memory (memory_link.hpp): what is under way to it, and what it has sent. The handle that its
// owner has is a MemoryStream; it keeps both ends.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_link.hpp"
#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {

class MemoryEnd {
 public:
  // number: as ByteStream::end_number(). The scheduler outlives the end.
  MemoryEnd(kernel::Scheduler& scheduler, std::uint32_t number) : scheduler_(scheduler), number_(number) {}
  ~MemoryEnd();
  MemoryEnd(const MemoryEnd&) = delete;
  MemoryEnd& operator=(const MemoryEnd&) = delete;

  std::uint32_t number() const { return number_; }
  // Somebody owns its stream.
  bool held() const { return held_; }
  void set_held(bool held) { held_ = held; }

  void set_handlers(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed);
  void send(Instant now, ByteView bytes, MemoryEnd& peer, const MemoryLinkOptions& options);
  void close(MemoryEnd& peer, const MemoryLinkOptions& options);
  // Another end takes its place after a load: it hears and says nothing more, and nobody is told.
  void retire();

  friend void archive(Archive& a, MemoryEnd& end) { end.archive_state(a); }

 private:
  enum class Kind : std::uint8_t {
    kBytes,
    kEnd,      // farewell: the reason
    kCatchUp,  // handlers have come; not from within the call that set them
  };
  friend VINV_ENUM_RANGE(Kind, kBytes, kCatchUp);
  // What an event does when it is due.
  struct Delivery {
    Kind kind = Kind::kBytes;
    Bytes bytes;
    std::string farewell;
    std::uint64_t number = 0;  // among those of this end
    kernel::EventId event = 0;
  };

  void post(Instant at, Kind kind, Bytes bytes = {}, std::string farewell = {});
  kernel::Scheduler::Action action(std::uint64_t number);
  // This and what it calls may destroy the end as their last act: a handler may destroy both streams.
  void run(Instant now, std::uint64_t number);
  void say_goodbye(Instant now, MemoryEnd& peer, const MemoryLinkOptions& options);
  void shut();
  void arrive(Instant now, ByteView bytes);
  void end(Instant now, const std::string& reason);
  void catch_up(Instant now);
  void archive_state(Archive& a);

  kernel::Scheduler& scheduler_;
  std::uint32_t number_;
  bool held_ = false;
  StreamHandlers handlers_;
  std::deque<Delivery> deliveries_;
  std::uint64_t next_delivery_ = 0;
  std::size_t on_the_way_ = 0;  // bytes sent to this end that no handler has seen
  Bytes waiting_;               // of those, what arrived before there were handlers
  std::string farewell_;        // the end, which arrived before there were handlers; empty: not yet
  bool open_ = true;
  Instant sent_until_{};  // the last character of what this end sent so far
  bool cut_ = false;      // more was sent than the other end may owe
};

class MemoryStream : public ByteStream {
 public:
  // The ends of one link.
  MemoryStream(std::shared_ptr<MemoryEnd> self, std::shared_ptr<MemoryEnd> peer,
               std::shared_ptr<const MemoryLinkOptions> options, std::string name);
  ~MemoryStream() override;
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    self_->set_handlers(std::move(on_bytes), std::move(on_closed));
  }
  void send(Instant now, ByteView bytes) override { self_->send(now, bytes, *peer_, *options_); }
  void close() override { self_->close(*peer_, *options_); }
  std::string name() const override { return name_; }
  std::uint32_t end_number() const override { return self_->number(); }

 private:
  std::shared_ptr<MemoryEnd> self_;
  std::shared_ptr<MemoryEnd> peer_;
  std::shared_ptr<const MemoryLinkOptions> options_;
  std::string name_;
};

}  // namespace vinv::transports
