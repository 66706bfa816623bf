#include "sim/transports/socket_stream.hpp"

#include <algorithm>
#include <array>
#include <asio/error.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {

class SocketSession : public std::enable_shared_from_this<SocketSession> {
 public:
  using Socket = asio::generic::stream_protocol::socket;

  SocketSession(EventLoop& loop, Socket socket, std::string name, std::size_t max_queued)
      : loop_(loop), socket_(std::move(socket)), name_(std::move(name)), max_queued_(max_queued) {}

  const std::string& name() const { return name_; }
  bool takes_a_place() const { return state_ != State::kEnded; }
  bool is_half_closed() const { return state_ == State::kHalfClosed; }

  void set_handlers(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed) {
    if (state_ == State::kEnded) return;
    const bool first = !handlers_.are_set();
    handlers_.set(std::move(on_bytes), std::move(on_closed));
    if (first && !reading_) read();
  }

  void send(ByteView bytes) {
    if (state_ == State::kEnded || bytes.empty()) return;
    if (queue_.empty()) {
      asio::error_code error;
      const std::size_t sent = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
      if (error && error != asio::error::would_block && error != asio::error::try_again) {
        return end_later(describe_disconnect(error.value()));
      }
      bytes = bytes.subspan(error ? 0 : sent);
      if (bytes.empty()) return;
    }
    if (queue_.size() - sent_ + bytes.size() > max_queued_) {
      return end_later("disconnected: the peer does not read (" + std::to_string(max_queued_) + " bytes wait for it)");
    }
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    wait_writable();
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
    asio::error_code ignored;
    socket_.shutdown(asio::socket_base::shutdown_both, ignored);
    socket_.close(ignored);
  }

  // From within a call of the owner, who does not expect to be called back from there.
  void end_later(std::string reason) {
    shut();
    asio::post(loop_.io(), [self = shared_from_this(), reason = std::move(reason)] {
      self->handlers_.closed(self->loop_.now(), reason);
    });
  }

  void read() {
    reading_ = true;
    socket_.async_read_some(asio::buffer(in_),
                            [self = shared_from_this()](const asio::error_code& error, std::size_t size) {
                              self->reading_ = false;
                              self->on_read(error, size);
                            });
  }

  void on_read(const asio::error_code& error, std::size_t size) {
    if (state_ != State::kOpen) return;
    if (error == asio::error::eof) return half_close();
    if (error) return end(describe_disconnect(error.value()));
    handlers_.bytes(loop_.now(), ByteView(in_.data(), size), false);
    if (state_ == State::kOpen) read();
  }

  void half_close() {
    state_ = State::kHalfClosed;
    grace_ = loop_.scheduler().schedule(loop_.now() + kHalfCloseGrace, kernel::Priority::kWire,
                                        [weak = weak_from_this()](Instant) {
                                          const auto self = weak.lock();
                                          if (!self) return;
                                          self->grace_ = 0;
                                          self->end(describe_disconnect(0));
                                        });
  }

  void wait_writable() {
    if (writing_) return;
    writing_ = true;
    socket_.async_wait(Socket::wait_write, [self = shared_from_this()](const asio::error_code& error) {
      self->writing_ = false;
      if (!error) self->flush();
    });
  }

  void flush() {
    if (state_ == State::kEnded) return;
    asio::error_code error;
    const std::size_t sent = socket_.write_some(asio::buffer(queue_.data() + sent_, queue_.size() - sent_), error);
    if (error && error != asio::error::would_block && error != asio::error::try_again) {
      return end(describe_disconnect(error.value()));
    }
    if (!error) sent_ += sent;
    // Moved to the front now and then only: a long queue is not copied for every piece that leaves it.
    if (sent_ >= queue_.size() / 2) {
      queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(sent_));
      sent_ = 0;
    }
    if (!queue_.empty()) wait_writable();
  }

  EventLoop& loop_;
  Socket socket_;
  std::string name_;
  StreamHandlers handlers_;
  State state_ = State::kOpen;
  bool reading_ = false;
  bool writing_ = false;
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
  asio::error_code ignored;
  socket.non_blocking(true, ignored);
  auto session = std::make_shared<SocketSession>(loop, std::move(socket), std::move(name), max_queued);
  if (table != nullptr) table->add(session);
  return std::make_unique<SocketStream>(std::move(session));
}

}  // namespace vinv::transports
