#include "sim/transports/socket_stream.hpp"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <cerrno>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/stream_handlers.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

// recv() and send() are points where a thread can be cancelled: in a process with two threads the library changes the
// thread's state before and after each, which costs as much as all our parsing.
ssize_t receive_now(int socket, void* bytes, std::size_t size) {
  return ::syscall(SYS_recvfrom, socket, bytes, size, MSG_DONTWAIT, nullptr, nullptr);
}
ssize_t send_now(int socket, const void* bytes, std::size_t size) {
  return ::syscall(SYS_sendto, socket, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL, nullptr, 0);
}

}  // namespace

class SocketSession final : public std::enable_shared_from_this<SocketSession>, private ReadyHandler {
 public:
  SocketSession(EventLoop& loop, UniqueFd socket, std::string name, std::size_t max_queued)
      : loop_(loop), socket_(std::move(socket)), name_(std::move(name)), max_queued_(max_queued) {}
  // Its stream has closed it.
  ~SocketSession() = default;
  SocketSession(const SocketSession&) = delete;
  SocketSession& operator=(const SocketSession&) = delete;

  const std::string& name() const { return name_; }
  bool takes_a_place() const { return state_ != State::kEnded; }
  bool is_half_closed() const { return state_ == State::kHalfClosed; }

  void set_handlers(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed) {
    if (state_ == State::kEnded) return;
    handlers_.set(std::move(on_bytes), std::move(on_closed));
    watch();
  }

  void send(ByteView bytes) {
    if (state_ == State::kEnded || bytes.empty()) return;
    if (queue_.empty()) {
      const ssize_t sent = write(bytes);
      if (sent < 0) return end_later(describe_disconnect(errno));
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      if (bytes.empty()) return;
    }
    if (queue_.size() - sent_ + bytes.size() > max_queued_) {
      return end_later("disconnected: the peer does not read (" + std::to_string(max_queued_) + " bytes wait for it)");
    }
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    watch();
  }

  // By the owner: no handler is called any more.
  void close() {
    handlers_.clear();
    shut();
  }

  void end(const std::string& reason) {
    if (state_ == State::kEnded) return;
    shut();
    handlers_.closed(loop_.now(), reason);
  }

 private:
  enum class State { kOpen, kHalfClosed, kEnded };

  void shut() {
    if (state_ == State::kEnded) return;
    state_ = State::kEnded;
    if (grace_ != 0) loop_.scheduler().cancel(grace_);
    queue_ = Bytes();
    sent_ = 0;
    if (ready_ != 0) loop_.ready_set().remove(ready_, socket_.get());
    ::shutdown(socket_.get(), SHUT_RDWR);
    socket_.reset();
  }

  // From within a call of the owner, who does not expect to be called back from there.
  void end_later(std::string reason) {
    shut();
    asio::post(loop_.io(), [self = shared_from_this(), reason = std::move(reason)] {
      self->handlers_.closed(self->loop_.now(), reason);
    });
  }

  // What the socket is waited for: bytes while somebody takes them, room while something is queued. A half-closed one
  // without a queue is in the set for its reset.
  void watch() {
    const bool reads = state_ == State::kOpen && handlers_.are_set();
    const std::uint32_t wanted =
        (reads ? std::uint32_t{EPOLLIN} : 0u) | (queue_.empty() ? 0u : std::uint32_t{EPOLLOUT});
    if (ready_ == 0) {
      if (wanted == 0) return;
      ready_ = loop_.ready_set().add(socket_.get(), wanted, *this);
    } else if (wanted != watched_) {
      loop_.ready_set().change(ready_, socket_.get(), wanted);
    }
    watched_ = wanted;
  }

  void on_ready(std::uint32_t events) override {
    // The usual message: reading touches nothing of this session after its handler, which may end it.
    if (events == EPOLLIN && state_ == State::kOpen && handlers_.are_set()) return read();
    const auto self = shared_from_this();
    if ((events & EPOLLOUT) != 0) flush();
    if (state_ == State::kOpen && handlers_.are_set()) {
      if ((events & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0) read();
    } else if (state_ != State::kEnded && (events & (EPOLLHUP | EPOLLERR)) != 0) {
      int error = 0;
      socklen_t size = sizeof error;
      ::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &size);
      end(describe_disconnect(error));
    }
  }

  void read() {
    const ssize_t size = receive_now(socket_.get(), in_.data(), in_.size());
    if (size > 0) return handlers_.bytes(loop_.now(), ByteView(in_.data(), static_cast<std::size_t>(size)), false);
    if (size == 0) return half_close();
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) end(describe_disconnect(errno));
  }

  void half_close() {
    state_ = State::kHalfClosed;
    watch();
    grace_ = loop_.scheduler().schedule(loop_.now() + kHalfCloseGrace, kernel::Priority::kWire,
                                        [weak = weak_from_this()](Instant) {
                                          const auto self = weak.lock();
                                          if (!self) return;
                                          self->grace_ = 0;
                                          self->end(describe_disconnect(0));
                                        });
  }

  // Bytes that went; -1 with errno if the connection is broken.
  ssize_t write(ByteView bytes) {
    const ssize_t sent = send_now(socket_.get(), bytes.data(), bytes.size());
    if (sent >= 0) return sent;
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;
  }

  void flush() {
    if (queue_.empty()) return;
    const ssize_t sent = write(ByteView(queue_).subspan(sent_));
    if (sent < 0) return end(describe_disconnect(errno));
    sent_ += static_cast<std::size_t>(sent);
    // Moved to the front now and then only: a long queue is not copied for every piece that leaves it.
    if (sent_ >= queue_.size() / 2) {
      queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(sent_));
      sent_ = 0;
    }
    watch();
  }

  EventLoop& loop_;
  UniqueFd socket_;
  std::string name_;
  StreamHandlers handlers_;
  State state_ = State::kOpen;
  ReadySet::Id ready_ = 0;
  std::uint32_t watched_ = 0;
  kernel::EventId grace_ = 0;
  std::array<std::uint8_t, kBytesPerWakeUp> in_{};
  std::size_t max_queued_;
  Bytes queue_;
  std::size_t sent_ = 0;  // of the queue's front
};

namespace {

class SocketStream : public ByteStream {
 public:
  explicit SocketStream(std::shared_ptr<SocketSession> session) : session_(std::move(session)) {}
  ~SocketStream() override { session_->close(); }
  SocketStream(const SocketStream&) = delete;
  SocketStream& operator=(const SocketStream&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    session_->set_handlers(std::move(on_bytes), std::move(on_closed));
  }
  void send(Instant, ByteView bytes) override { session_->send(bytes); }
  void close() override { session_->close(); }
  std::string name() const override { return session_->name(); }

 private:
  std::shared_ptr<SocketSession> session_;
};

}  // namespace

void ConnectionTable::prune() {
  std::erase_if(sessions_, [](const std::weak_ptr<SocketSession>& weak) {
    const auto session = weak.lock();
    return !session || !session->takes_a_place();
  });
}

std::size_t ConnectionTable::size() {
  prune();
  return sessions_.size();
}

bool ConnectionTable::has_room() {
  prune();
  if (sessions_.size() < limit_) return true;
  for (const auto& weak : sessions_) {
    const auto session = weak.lock();
    if (!session || !session->is_half_closed()) continue;
    session->end(describe_disconnect(0));
    return true;
  }
  return false;
}

void ConnectionTable::add(const std::shared_ptr<SocketSession>& session) { sessions_.push_back(session); }

std::unique_ptr<ByteStream> make_socket_stream(EventLoop& loop, asio::generic::stream_protocol::socket socket,
                                               std::string name, ConnectionTable* table, std::size_t max_queued) {
  // Out of Asio's reactor: the loop's ready set watches it.
  auto session = std::make_shared<SocketSession>(loop, UniqueFd(socket.release()), std::move(name), max_queued);
  if (table != nullptr) table->add(session);
  return std::make_unique<SocketStream>(std::move(session));
}

}  // namespace vinv::transports
