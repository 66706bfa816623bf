// The ways for foreign masters onto a bus of ours: socketcand and slcan servers on TCP, and an slcan adapter on a
// pseudo-terminal. Each TCP client is a node of its own. A client that does not read is disconnected when
// ByteStream::kMaxQueuedBytes wait for it, and newcomers beyond kMaxCanClients are refused; the bus waits for nobody.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/socketcand_session.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

inline constexpr std::size_t kMaxCanClients = 32;  // of one server
inline constexpr std::uint16_t kSocketcandPort = 29536;

struct CanServerAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;  // 0: a free one
};

class SocketcandServer {
 public:
  // Refusal: a sentence. Loop and buses outlive the server.
  static Result<std::unique_ptr<SocketcandServer>, std::string> open(EventLoop& loop, const CanServerAddress& address,
                                                                     SocketcandOptions options);
  ~SocketcandServer();
  SocketcandServer(const SocketcandServer&) = delete;
  SocketcandServer& operator=(const SocketcandServer&) = delete;
  std::string host() const;
  std::uint16_t port() const;
  std::size_t clients() const;

 private:
  struct Impl;
  explicit SocketcandServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

class SlcanServer {
 public:
  static Result<std::unique_ptr<SlcanServer>, std::string> open(EventLoop& loop, const CanServerAddress& address,
                                                                CanBus& bus);
  ~SlcanServer();
  SlcanServer(const SlcanServer&) = delete;
  SlcanServer& operator=(const SlcanServer&) = delete;
  std::string host() const;
  std::uint16_t port() const;
  std::size_t clients() const;

 private:
  struct Impl;
  explicit SlcanServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// One adapter whose clients come and go; its channel stays as they left it, as that of a USB adapter does.
class SlcanPty {
 public:
  // link: as in SerialPtyOptions.
  static Result<std::unique_ptr<SlcanPty>, std::string> open(EventLoop& loop, const std::string& link, CanBus& bus);
  ~SlcanPty();
  SlcanPty(const SlcanPty&) = delete;
  SlcanPty& operator=(const SlcanPty&) = delete;
  std::string path() const;  // of the slave

 private:
  struct Impl;
  explicit SlcanPty(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace vinv::transports
