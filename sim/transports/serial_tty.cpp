#include "sim/transports/serial_tty.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <array>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <cerrno>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/line_control.hpp"
#include "sim/transports/parity_marks.hpp"
#include "sim/transports/socket_stream.hpp"
#include "sim/transports/stream_handlers.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {

struct SerialTty::Impl : std::enable_shared_from_this<Impl> {
  using Device = asio::posix::stream_descriptor;

  Impl(EventLoop& l, SerialTtyOptions o) : loop(l), options(std::move(o)), device(l.io()) {}

  Result<void, std::string> open_device() {
    const auto refuse = [this](const std::string& why) {
      return Unexpected("cannot use " + options.path + ": " + why);
    };
    UniqueFd fd(::open(options.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
    if (!fd.is_open()) {
      if (errno == EBUSY) return refuse("another program holds it");
      return refuse(describe_errno(errno));
    }
    // TIOCEXCL keeps out everybody but root, the lock those who ask for it, root or not.
    if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) return refuse("another program holds it");
    if (auto configured = configure_line(fd.get(), options.settings); !configured) return refuse(configured.error());
    ::ioctl(fd.get(), TIOCEXCL);
    flush_input(fd.get());
    marks = ParityMarks();
    device.assign(fd.release());
    return {};
  }

  void notice(Instant now, const std::string& sentence) const {
    const auto handler = on_notice;
    if (handler) handler(now, sentence);
  }

  void read() {
    if (reading || !device.is_open()) return;
    reading = true;
    device.async_read_some(asio::buffer(in),
                           [self = shared_from_this()](const asio::error_code& error, std::size_t size) {
                             self->reading = false;
                             self->on_read(error, size);
                           });
  }

  void on_read(const asio::error_code& error, std::size_t size) {
    if (closed) return;
    if (!device.is_open()) return;
    if (error) return vanish(error == asio::error::eof ? EIO : error.value());
    plain.clear();
    const bool wrong = marks.decode(ByteView(in.data(), size), plain);
    if (!plain.empty() || wrong) handlers.bytes(loop.now(), plain, wrong);
    read();
  }

  void vanish(int error) {
    release_device();
    notice(loop.now(), options.path + " is gone (" + describe_errno(error) + "); looking for it");
    look_again();
  }

  void release_device() {
    if (!device.is_open()) return;
    ::ioctl(device.native_handle(), TIOCNXCL);
    asio::error_code ignored;
    device.close(ignored);
    lost += queue.size();
    queue.clear();
  }

  void look_again() {
    retry = loop.scheduler().schedule(loop.now() + kReopenInterval, kernel::Priority::kWire,
                                      [weak = weak_from_this()](Instant now) {
                                        if (const auto self = weak.lock()) self->try_again(now);
                                      });
  }

  void try_again(Instant now) {
    retry = 0;
    if (closed) return;
    if (!open_device()) return look_again();
    notice(now, options.path + " is back");
    read();
  }

  void send(ByteView bytes) {
    if (!device.is_open()) {
      lost += bytes.size();
      return;
    }
    if (queue.size() + bytes.size() > ByteStream::kMaxQueuedBytes) {
      lost += bytes.size();
      return;
    }
    queue.insert(queue.end(), bytes.begin(), bytes.end());
    flush();
  }

  void flush() {
    if (!device.is_open() || writing) return;
    int error = 0;
    while (!queue.empty() && error == 0) {
      const ssize_t n = ::write(device.native_handle(), queue.data(), queue.size());
      if (n >= 0) {
        queue.erase(queue.begin(), queue.begin() + n);
        if (n == 0) error = EAGAIN;
      } else if (errno != EINTR) {
        error = errno;
      }
    }
    if (queue.empty()) return;
    if (error != EAGAIN) {  // the read finds out that the device is gone
      lost += queue.size();
      queue.clear();
      return;
    }
    writing = true;
    device.async_wait(Device::wait_write, [self = shared_from_this()](const asio::error_code&) {
      self->writing = false;
      self->flush();
    });
  }

  EventLoop& loop;
  SerialTtyOptions options;
  Device device;
  ParityMarks marks;
  StreamHandlers handlers;
  OnNotice on_notice;
  std::array<std::uint8_t, kBytesPerWakeUp> in{};
  Bytes plain;
  Bytes queue;
  bool reading = false;
  bool writing = false;
  bool closed = false;
  kernel::EventId retry = 0;
  std::uint64_t lost = 0;
};

SerialTty::SerialTty(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
SerialTty::~SerialTty() { close(); }

Result<std::unique_ptr<SerialTty>, std::string> SerialTty::open(EventLoop& loop, const SerialTtyOptions& options) {
  auto impl = std::make_shared<Impl>(loop, options);
  if (const auto opened = impl->open_device(); !opened) return Unexpected(opened.error());
  return std::unique_ptr<SerialTty>(new SerialTty(std::move(impl)));
}

void SerialTty::set_notice(OnNotice on_notice) { impl_->on_notice = std::move(on_notice); }
bool SerialTty::is_present() const { return impl_->device.is_open(); }

void SerialTty::set_handlers(OnBytes on_bytes, OnClosed on_closed) {
  impl_->handlers.set(std::move(on_bytes), std::move(on_closed));
  impl_->read();
}

void SerialTty::send(Instant, ByteView bytes) { impl_->send(bytes); }

void SerialTty::close() {
  impl_->closed = true;
  impl_->handlers.clear();
  if (impl_->retry != 0) impl_->loop.scheduler().cancel(std::exchange(impl_->retry, 0));
  impl_->release_device();
}

std::string SerialTty::name() const { return impl_->options.path; }
std::uint64_t SerialTty::lost_bytes() const { return impl_->lost; }

Result<void, std::string> SerialTty::set_line_settings(const LineSettings& settings) {
  if (settings == impl_->options.settings) return {};
  impl_->options.settings = settings;
  if (!impl_->device.is_open()) return {};
  return configure_line(impl_->device.native_handle(), settings);
}

}  // namespace vinv::transports
