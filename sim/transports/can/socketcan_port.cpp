#include "sim/transports/can/socketcan_port.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <cerrno>
#include <cstring>
#include <deque>
#include <utility>

#include "sim/transports/can/error_frame.hpp"
#include "sim/transports/can/remote_port.hpp"
#include "sim/transports/io_error.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

// Frames read of one interface before other sockets and events have their turn.
constexpr int kFramesPerWakeUp = 32;

can_frame to_kernel(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
  raw.can_dlc = frame.length;
  std::copy(frame.bytes().begin(), frame.bytes().end(), raw.data);
  return raw;
}

CanFrame from_kernel(const can_frame& raw) {
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(raw.can_dlc, 8);
  if (!frame.remote) std::copy_n(raw.data, frame.length, frame.data.begin());
  return frame;
}

bool is_interface_up(int fd, const std::string& interface) {
  ifreq request{};
  std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
  return ::ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

}  // namespace

struct SocketCanPort::Impl : RemotePortState {
  using Device = asio::posix::stream_descriptor;

  Impl(EventLoop& l, std::string i)
      : RemotePortState(l.scheduler()), loop(l), interface(std::move(i)), device(l.io()) {}

  std::weak_ptr<Impl> weak() { return std::static_pointer_cast<Impl>(shared_from_this()); }

  Result<void, std::string> open_socket() {
    const auto refuse = [this](const std::string& why) {
      return Unexpected("cannot use CAN interface " + interface + ": " + why);
    };
    if (interface.empty() || interface.size() >= IFNAMSIZ) return refuse("not the name of an interface");
    UniqueFd fd(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
    if (!fd.is_open()) {
      if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
        return refuse(
            "this kernel has no CAN sockets (try modprobe can can_raw vcan, or use a virtual bus with socketcand)");
      }
      return refuse(describe_errno(errno));
    }
    const unsigned found = ::if_nametoindex(interface.c_str());
    if (found == 0) {
      return refuse("there is no such interface (make one with ip link add dev " + interface + " type vcan)");
    }
    const can_err_mask_t errors = CAN_ERR_MASK;
    const int own = 1;
    if (::setsockopt(fd.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
        ::setsockopt(fd.get(), SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &own, sizeof own) != 0) {
      return refuse(describe_errno(errno));
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(found);
    if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      return refuse(errno == ENODEV ? std::string("it is not a CAN interface") : describe_errno(errno));
    }
    index = found;
    asio::error_code ignored;
    device.close(ignored);
    device.assign(fd.release());
    return {};
  }

  void start(Instant now) {
    wait();
    if (is_interface_up(device.native_handle(), interface))
      enter(now, CanState::kErrorActive);
    else
      look_again();
  }

  void wait() {
    device.async_wait(Device::wait_read, [w = weak()](const asio::error_code& error) {
      const auto self = w.lock();
      if (error || !self || !self->device.is_open()) return;
      if (self->read()) self->wait();
    });
  }

  // False if the socket is of no use any more.
  bool read() {
    for (int i = 0; i < kFramesPerWakeUp && device.is_open(); ++i) {
      can_frame raw{};
      iovec piece{&raw, sizeof raw};
      msghdr message{};
      message.msg_iov = &piece;
      message.msg_iovlen = 1;
      const ssize_t size = ::recvmsg(device.native_handle(), &message, 0);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
      if (size < 0) {
        const bool gone = errno != ENETDOWN;
        go_down(loop.now());
        if (gone) {
          asio::error_code ignored;
          device.close(ignored);
        }
        return !gone;
      }
      if (size == static_cast<ssize_t>(sizeof raw)) hear(loop.now(), raw, (message.msg_flags & MSG_CONFIRM) != 0);
    }
    return device.is_open();
  }

  void hear(Instant now, const can_frame& raw, bool is_own) {
    if (!is_up()) return;
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
      CanErrorFrame error;
      error.error_class = raw.can_id & CAN_ERR_MASK;
      std::copy_n(raw.data, error.data.size(), error.data.begin());
      const CanErrorNews news = news_of(error);
      if (news.has_counters) status.counters = news.counters;
      if (news.has_state) enter(now, news.state);
    } else if (is_own) {
      confirm(now, from_kernel(raw));
    } else {
      received(now, from_kernel(raw));
    }
  }

  void go_down(Instant now) {
    flush_queue();
    status.counters = {};
    enter(now, CanState::kOffline);
    look_again();
  }

  void look_again() {
    if (look != 0) return;
    look = scheduler.schedule(loop.now() + kLookInterval, kernel::Priority::kWire, [w = weak()](Instant now) {
      const auto self = w.lock();
      if (!self) return;
      self->look = 0;
      self->look_now(now);
    });
  }

  void look_now(Instant now) {
    // An interface that was made anew has another index, and the socket is not bound to it.
    const bool same = device.is_open() && ::if_nametoindex(interface.c_str()) == index;
    if (!same) {
      asio::error_code ignored;
      device.close(ignored);
      if (!open_socket()) return look_again();
      wait();
    }
    if (!is_interface_up(device.native_handle(), interface)) return look_again();
    if (online) enter(now, CanState::kErrorActive);
  }

  // What the kernel does not take now waits.
  void write_queue(Instant now) {
    while (!queue.empty()) {
      const can_frame raw = to_kernel(queue.front());
      const ssize_t size = ::write(device.native_handle(), &raw, sizeof raw);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && (errno == ENOBUFS || errno == EAGAIN || errno == EWOULDBLOCK)) {
        return retry_later();
      }
      if (size < 0) {
        flush_queue();
        // In an event of its own, because send() does not call back.
        scheduler.schedule(std::max(now, scheduler.now()), kernel::Priority::kWire, [w = weak()](Instant t) {
          const auto self = w.lock();
          if (self && self->device.is_open()) self->go_down(t);
        });
        return;
      }
      queue.pop_front();
    }
  }

  // A socket with a full interface behind it is writable all the same, so that only time tells.
  void retry_later() {
    if (retry != 0) return;
    retry = scheduler.schedule(loop.now() + kRetryInterval, kernel::Priority::kWire, [w = weak()](Instant now) {
      const auto self = w.lock();
      if (!self) return;
      self->retry = 0;
      if (self->device.is_open()) self->write_queue(now);
    });
  }

  void flush_queue() {
    status.lost += queue.size();
    queue.clear();
  }

  void shut() {
    handlers.reset();
    if (look != 0) scheduler.cancel(std::exchange(look, 0));
    if (retry != 0) scheduler.cancel(std::exchange(retry, 0));
    asio::error_code ignored;
    device.close(ignored);
  }

  EventLoop& loop;
  std::string interface;
  Device device;
  unsigned index = 0;
  std::deque<CanFrame> queue;
  kernel::EventId look = 0;
  kernel::EventId retry = 0;
};

SocketCanPort::SocketCanPort(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
SocketCanPort::~SocketCanPort() { impl_->shut(); }

Result<std::unique_ptr<SocketCanPort>, std::string> SocketCanPort::open(EventLoop& loop, const std::string& interface) {
  auto impl = std::make_shared<Impl>(loop, interface);
  if (const auto opened = impl->open_socket(); !opened) return Unexpected(opened.error());
  impl->start(loop.now());
  return std::unique_ptr<SocketCanPort>(new SocketCanPort(std::move(impl)));
}

void SocketCanPort::set_handlers(CanHandlers handlers) {
  impl_->handlers = std::make_shared<const CanHandlers>(std::move(handlers));
}

CanSend SocketCanPort::send(Instant now, const CanFrame& frame) {
  VINV_CHECK(is_well_formed(frame));
  if (!impl_->may_send()) {
    ++impl_->status.lost;
    return CanSend::kRefusedState;
  }
  if (queue_room() == 0) {
    ++impl_->status.lost;
    return CanSend::kRefusedFull;
  }
  impl_->queue.push_back(frame);
  if (impl_->retry == 0) impl_->write_queue(now);
  return CanSend::kQueued;
}

std::size_t SocketCanPort::queue_room() const {
  return impl_->may_send() ? kMaxQueuedFrames - std::min(impl_->queue.size(), kMaxQueuedFrames) : 0;
}

void SocketCanPort::clear_queue() { impl_->flush_queue(); }

void SocketCanPort::set_online(Instant now, bool online) {
  if (std::exchange(impl_->online, online) == online) return;
  impl_->flush_queue();
  const bool up = impl_->device.is_open() && is_interface_up(impl_->device.native_handle(), impl_->interface);
  impl_->enter(now, online && up ? CanState::kErrorActive : CanState::kOffline);
  if (online && !up) impl_->look_again();
}

Result<void, std::string> SocketCanPort::set_bitrate(Instant, std::uint32_t) {
  return Unexpected("the bit rate of " + impl_->interface + " is set by the system (ip link set " + impl_->interface +
                    " type can bitrate N)");
}

CanStatus SocketCanPort::status() const { return impl_->status; }
std::string SocketCanPort::name() const { return impl_->interface; }

}  // namespace vinv::transports
