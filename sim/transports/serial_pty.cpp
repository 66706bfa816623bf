#include "sim/transports/serial_pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/post.hpp>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/line_control.hpp"
#include "sim/transports/socket_stream.hpp"
#include "sim/transports/stream_handlers.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

constexpr std::uint32_t kNoSpeedYet = 134;
constexpr const char* kPtsFolder = "/dev/pts/";

std::string link_target(const std::string& path) {
  std::array<char, PATH_MAX> target{};
  const ssize_t size = ::readlink(path.c_str(), target.data(), target.size());
  return size < 0 ? std::string() : std::string(target.data(), static_cast<std::size_t>(size));
}

// By rename, so that the name never is missing while a client looks for it.
Result<void, std::string> place_link(const std::string& link, const std::string& target) {
  const auto refuse = [&](const std::string& why) {
    return Unexpected("cannot link " + link + " to " + target + ": " + why);
  };
  struct stat info {};
  if (::lstat(link.c_str(), &info) == 0) {
    if (!S_ISLNK(info.st_mode)) return refuse("a file that is not a symbolic link is there");
    if (link_target(link).rfind(kPtsFolder, 0) != 0) {
      return refuse("a symbolic link to something else is there (" + link_target(link) + ")");
    }
  }
  const std::string fresh = link + ".new" + std::to_string(::getpid());
  ::unlink(fresh.c_str());
  if (::symlink(target.c_str(), fresh.c_str()) != 0) return refuse(describe_errno(errno));
  if (::rename(fresh.c_str(), link.c_str()) != 0) {
    const int error = errno;
    ::unlink(fresh.c_str());
    return refuse(describe_errno(error));
  }
  return {};
}

}  // namespace

struct SerialPty::Impl : std::enable_shared_from_this<Impl> {
  explicit Impl(EventLoop& l) : loop(l), watch(l.io()) {}

  Result<void, std::string> open(const SerialPtyOptions& options) {
    const auto refuse = [](const char* what) {
      return Unexpected(std::string("cannot make a pseudo-terminal: ") + what + ": " + describe_errno(errno));
    };
    master = UniqueFd(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
    if (!master.is_open()) return refuse("posix_openpt");
    if (::grantpt(master.get()) != 0) return refuse("grantpt");
    if (::unlockpt(master.get()) != 0) return refuse("unlockpt");
    std::array<char, 64> slave_path{};
    if (::ptsname_r(master.get(), slave_path.data(), slave_path.size()) != 0) return refuse("ptsname");
    path = slave_path.data();
    settings = options.settings;
    {
      // Opened and closed once: from then on the master sees hang-up while no client is there.
      const UniqueFd slave(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
      if (!slave.is_open()) return refuse(path.c_str());
      if (!make_raw(slave.get(), kNoSpeedYet)) return refuse("raw mode");
    }
    if (!options.link.empty()) {
      if (auto placed = place_link(options.link, path); !placed) return placed;
      link = options.link;
    }
    // While there is no client, the master reports hang-up again and again to a reactor that asks anew for each wait.
    // An epoll of its own, edge-triggered, wakes only when something happens.
    UniqueFd edges(::epoll_create1(EPOLL_CLOEXEC));
    epoll_event event{};
    event.events = EPOLLIN | EPOLLET;
    if (!edges.is_open() || ::epoll_ctl(edges.get(), EPOLL_CTL_ADD, master.get(), &event) != 0) return refuse("epoll");
    watch.assign(edges.release());
    return {};
  }

  bool has_client() const {
    pollfd p{master.get(), POLLOUT, 0};
    return master.is_open() && ::poll(&p, 1, 0) >= 0 && (p.revents & POLLHUP) == 0;
  }

  std::optional<std::uint32_t> client_speed() const {
    const auto speed = line_speed(master.get());  // asked on the master, answered for the slave
    return speed == kNoSpeedYet ? std::nullopt : speed;
  }

  void wait() {
    watch.async_wait(asio::posix::stream_descriptor::wait_read,
                     [self = shared_from_this()](const asio::error_code& error) {
                       if (error || !self->master.is_open()) return;
                       epoll_event ignored{};
                       ::epoll_wait(self->watch.native_handle(), &ignored, 1, 0);
                       self->read();
                     });
  }

  // One piece; then others have their turn, and the next is read until there is none, as edges demand.
  void read() {
    if (!master.is_open()) return;
    const ssize_t size = ::read(master.get(), in.data(), in.size());
    if (size > 0) {
      const auto speed = client_speed();
      const bool mismatch = speed.has_value() && *speed != settings.baud;
      handlers.bytes(loop.now(), ByteView(in.data(), static_cast<std::size_t>(size)), mismatch);
    } else if (size == 0 || errno == EIO) {
      drop_unread();
      return wait();
    } else if (errno == EAGAIN) {
      return wait();
    } else if (errno != EINTR) {
      const std::string reason = describe_errno(errno);
      shut();
      return handlers.closed(loop.now(), reason);
    }
    asio::post(loop.io(), [self = shared_from_this()] { self->read(); });
  }

  // The last client has closed without reading all that was sent to it.
  void drop_unread() {
    if (!std::exchange(sent_since_hang_up, false) || has_client()) return;
    const UniqueFd slave(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
    if (slave.is_open()) flush_input(slave.get());
  }

  void send(ByteView bytes) {
    if (!master.is_open() || bytes.empty()) return;
    std::size_t sent = 0;
    if (has_client()) {
      ssize_t n = 0;
      do {
        n = ::write(master.get(), bytes.data() + sent, bytes.size() - sent);
        if (n > 0) sent += static_cast<std::size_t>(n);
      } while (sent < bytes.size() && (n > 0 || (n < 0 && errno == EINTR)));
      sent_since_hang_up = true;
    }
    lost += bytes.size() - sent;
  }

  void shut() {
    if (!master.is_open()) return;
    if (!link.empty() && link_target(link) == path) ::unlink(link.c_str());
    asio::error_code ignored;
    watch.close(ignored);
    master.reset();
  }

  EventLoop& loop;
  asio::posix::stream_descriptor watch;
  UniqueFd master;
  std::string path;
  std::string link;
  LineSettings settings;
  StreamHandlers handlers;
  std::array<std::uint8_t, kBytesPerWakeUp> in{};
  bool reading = false;
  bool sent_since_hang_up = false;
  std::uint64_t lost = 0;
};

SerialPty::SerialPty(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
SerialPty::~SerialPty() { close(); }

Result<std::unique_ptr<SerialPty>, std::string> SerialPty::open(EventLoop& loop, const SerialPtyOptions& options) {
  auto impl = std::make_shared<Impl>(loop);
  if (const auto opened = impl->open(options); !opened) {
    impl->shut();
    return Unexpected(opened.error());
  }
  return std::unique_ptr<SerialPty>(new SerialPty(std::move(impl)));
}

void SerialPty::set_handlers(OnBytes on_bytes, OnClosed on_closed) {
  impl_->handlers.set(std::move(on_bytes), std::move(on_closed));
  if (impl_->reading || !impl_->master.is_open()) return;
  impl_->reading = true;
  impl_->wait();
}

void SerialPty::send(Instant, ByteView bytes) { impl_->send(bytes); }

void SerialPty::close() {
  impl_->handlers.clear();
  impl_->shut();
}

std::string SerialPty::name() const { return impl_->path; }
const std::string& SerialPty::link() const { return impl_->link; }
bool SerialPty::has_client() const { return impl_->has_client(); }
std::uint64_t SerialPty::lost_bytes() const { return impl_->lost; }

Result<void, std::string> SerialPty::set_line_settings(const LineSettings& settings) {
  impl_->settings = settings;
  return {};
}

std::optional<LineSettings> SerialPty::peer_settings() const {
  if (!impl_->master.is_open()) return std::nullopt;
  const auto speed = impl_->client_speed();
  if (!speed) return std::nullopt;
  return LineSettings{*speed, impl_->settings.parity};
}

}  // namespace vinv::transports
