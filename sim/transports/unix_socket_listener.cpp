#include "sim/transports/unix_socket_listener.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <asio/io_context.hpp>
#include <asio/local/stream_protocol.hpp>
#include <cerrno>
#include <cstdint>
#include <utility>

#include "sim/transports/accept_loop.hpp"
#include "sim/transports/io_error.hpp"
#include "sim/transports/socket_stream.hpp"

namespace vinv::transports {
namespace {

using Protocol = asio::local::stream_protocol;

std::string refusal(const std::string& path, const std::string& why) { return "cannot listen on " + path + ": " + why; }

// Removes a socket file that nobody answers. The reason if the path is taken.
Result<void, std::string> clear_path(asio::io_context& io, const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return {};
  if (!S_ISSOCK(info.st_mode)) return Unexpected(refusal(path, "a file that is not a socket is there"));
  Protocol::socket probe(io);
  asio::error_code error;
  probe.open(Protocol(), error);
  if (!error) probe.non_blocking(true, error);
  if (!error) probe.connect(Protocol::endpoint(path), error);
  if (error.value() == ENOENT) return {};
  if (error.value() == EACCES) return Unexpected(refusal(path, describe_errno(EACCES)));
  // A full backlog is somebody too.
  if (error.value() != ECONNREFUSED) return Unexpected(refusal(path, "another process answers there"));
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return Unexpected(refusal(path, describe_errno(errno)));
  return {};
}

}  // namespace

struct UnixSocketListener::Impl : AcceptLoop<Impl, Protocol> {
  Impl(EventLoop& l, std::string p, OnAccept handler)
      : AcceptLoop(l), table(kMaxConnections), path(std::move(p)), on_accept(std::move(handler)) {}

  void take(Protocol::socket socket) {
    if (!table.has_room()) return;
    const auto handler = on_accept;
    handler(loop.now(), make_socket_stream(loop, std::move(socket), path + " client " + std::to_string(++accepted),
                                           &table, kMaxQueuedBytes));
  }

  ConnectionTable table;
  std::string path;
  OnAccept on_accept;
  std::uint64_t accepted = 0;
  dev_t device = 0;  // of the socket file, to tell it from one that took its place
  ino_t inode = 0;
};

UnixSocketListener::UnixSocketListener(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

UnixSocketListener::~UnixSocketListener() {
  struct stat info {};
  if (::lstat(impl_->path.c_str(), &info) == 0 && info.st_dev == impl_->device && info.st_ino == impl_->inode) {
    ::unlink(impl_->path.c_str());
  }
  asio::error_code ignored;
  impl_->acceptor.close(ignored);
}

Result<std::unique_ptr<UnixSocketListener>, std::string> UnixSocketListener::open(EventLoop& loop,
                                                                                  const std::string& path,
                                                                                  OnAccept on_accept) {
  if (path.empty() || path.size() > kMaxPathBytes) {
    return Unexpected(refusal("\"" + path + "\"", "a socket path has 1 to " + std::to_string(kMaxPathBytes) +
                                                      " bytes, this one has " + std::to_string(path.size())));
  }
  if (const auto clear = clear_path(loop.io(), path); !clear) return Unexpected(clear.error());
  auto impl = std::make_shared<Impl>(loop, path, std::move(on_accept));
  asio::error_code error;
  impl->acceptor.open(Protocol(), error);
  // Linux gives the socket file the mode of the socket: nobody else can connect, not even between bind and a chmod.
  if (!error && ::fchmod(impl->acceptor.native_handle(), S_IRUSR | S_IWUSR) != 0) {
    error.assign(errno, asio::error::get_system_category());
  }
  if (!error) impl->acceptor.bind(Protocol::endpoint(path), error);
  if (error) return Unexpected(refusal(path, describe_errno(error.value())));
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0) {
    impl->device = info.st_dev;
    impl->inode = info.st_ino;
  }
  impl->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    ::unlink(path.c_str());
    return Unexpected(refusal(path, describe_errno(error.value())));
  }
  impl->accept();
  return std::unique_ptr<UnixSocketListener>(new UnixSocketListener(std::move(impl)));
}

const std::string& UnixSocketListener::path() const { return impl_->path; }
std::size_t UnixSocketListener::connections() const { return impl_->table.size(); }

}  // namespace vinv::transports
