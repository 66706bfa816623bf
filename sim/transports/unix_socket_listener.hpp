// Listens on a Unix socket, for the control commands of a plant. Only the user who runs the plant may connect.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class UnixSocketListener {
 public:
  static constexpr std::size_t kMaxConnections = 128;
  // Of each connection: whoever connects is the user of this process, and one answer may be long.
  static constexpr std::size_t kMaxQueuedBytes = 8 * 1024 * 1024;
  static constexpr std::size_t kMaxPathBytes = 107;  // unix(7): sun_path with its final zero

  // A socket file that nobody answers is left over from a crash and is replaced; one that answers, and anything that is
  // not a socket, is refused with a sentence.
  static Result<std::unique_ptr<UnixSocketListener>, std::string> open(EventLoop& loop, const std::string& path,
                                                                       OnAccept on_accept);
  // Removes the socket file if it is still this listener's.
  ~UnixSocketListener();
  UnixSocketListener(const UnixSocketListener&) = delete;
  UnixSocketListener& operator=(const UnixSocketListener&) = delete;

  const std::string& path() const;
  std::size_t connections() const;

 private:
  struct Impl;
  explicit UnixSocketListener(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
