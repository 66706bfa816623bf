// Accepts connections of a listener, one after the other, for as long as its acceptor is open. Shared by the listeners
// over TCP and over Unix sockets; a listener derives from it and takes each socket.
#pragma once

#include <asio/error_code.hpp>
#include <cerrno>
#include <memory>
#include <utility>

#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

// When the process has no descriptor left, accepting again at once would spin.
inline constexpr Duration kAcceptRetryDelay = std::chrono::milliseconds(100);

// Listener has take(Protocol::socket).
template <class Listener, class Protocol>
class AcceptLoop : public std::enable_shared_from_this<Listener> {
 public:
  explicit AcceptLoop(EventLoop& l) : loop(l), acceptor(l.io()) {}

  void accept() {
    acceptor.async_accept(
        [self = this->shared_from_this()](const asio::error_code& error, typename Protocol::socket socket) {
          if (!self->acceptor.is_open()) return;
          if (!error) {
            self->take(std::move(socket));
          } else if (error.value() != ECONNABORTED) {
            return self->accept_later();
          }
          if (self->acceptor.is_open()) self->accept();
        });
  }

  EventLoop& loop;
  typename Protocol::acceptor acceptor;

 private:
  void accept_later() {
    loop.scheduler().schedule(loop.now() + kAcceptRetryDelay, kernel::Priority::kWire,
                              [weak = this->weak_from_this()](Instant) {
                                const auto self = weak.lock();
                                if (self && self->acceptor.is_open()) self->accept();
                              });
  }
};

}  // namespace vinv::transports
