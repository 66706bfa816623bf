#include "sim/transports/can/slcan_client.hpp"

#include <utility>

#include "sim/transports/can/number_text.hpp"
#include "sim/transports/can/slcan_text.hpp"
#include "sim/transports/can/tcp_dialer.hpp"
#include "sim/transports/serial_tty.hpp"

namespace vinv::transports {
namespace {

ByteView view(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

Result<void, std::string> check_bitrate(std::uint32_t bitrate) {
  if (!slcan_bitrate_command(bitrate).empty()) return {};
  return Unexpected("slcan adapters have no bit rate " + std::to_string(bitrate));
}

}  // namespace

struct SlcanClient::Impl : RemotePortState {
  Impl(kernel::Scheduler& s, std::uint32_t rate) : RemotePortState(s), bitrate(rate) {}

  std::weak_ptr<Impl> weak() { return std::static_pointer_cast<Impl>(shared_from_this()); }

  void connect(Instant now, std::unique_ptr<ByteStream> fresh) {
    stream = std::move(fresh);
    stream->set_handlers(
        [w = weak()](Instant t, ByteView bytes, bool) {
          const auto self = w.lock();
          if (self) self->lines.feed(bytes, [&](std::string_view line) { self->hear(t, line); });
        },
        [w = weak()](Instant t, const std::string&) {
          const auto self = w.lock();
          if (!self) return;
          self->stream.reset();
          self->stop_asking();
          self->enter(t, CanState::kOffline);
          if (self->dialer) self->dialer->lost();
        });
    set_up(now);
  }

  // Empty lines end whatever the adapter has of a line; C for one that was left open.
  void set_up(Instant now) {
    lines = {};
    say(now, "\r\rC\r");
    if (!online) return;
    say(now, slcan_bitrate_command(bitrate) + "\rZ0\rO\r");
    bells_expected = true;
    status.counters = {};
    stop_asking();
    ask = scheduler.schedule_every(std::max(now, scheduler.now()) + kStatusInterval, kStatusInterval,
                                   kernel::Priority::kWire, [w = weak()](Instant t) {
                                     const auto self = w.lock();
                                     if (!self) return;
                                     self->bells_expected = false;
                                     self->say(t, "F\r");
                                   });
    enter(now, CanState::kErrorActive);
  }

  void stop_asking() {
    if (ask != 0) scheduler.cancel(std::exchange(ask, 0));
  }

  void hear(Instant now, std::string_view line) {
    if (line.empty() || !is_up()) return;
    if (const auto frame = parse_slcan_frame(line, true)) return received(now, *frame);
    // Adapters complain of a C when they are closed already, and of what they do not know while they are set up.
    if (line == "\a" && !bells_expected) ++status.lost;
    if (line[0] == 'F' && line.size() == 3) {
      const auto flags = parse_hex(line.substr(1));
      if (flags) hear_flags(now, *flags);
    }
  }

  void hear_flags(Instant now, std::uint32_t flags) {
    if ((flags & 0x80) != 0) return enter(now, CanState::kBusOff);
    if ((flags & 0x20) != 0) return enter(now, CanState::kErrorPassive);
    enter(now, (flags & 0x04) != 0 ? CanState::kErrorWarning : CanState::kErrorActive);
  }

  void say_frame(Instant now, const CanFrame& frame) {
    text.clear();
    append_slcan_frame(text, frame);
    text += '\r';
    say(now, text);
  }

  void say(Instant now, const std::string& words) {
    if (stream) stream->send(now, view(words));
  }

  std::uint32_t bitrate;
  std::string where;
  std::unique_ptr<TcpDialer> dialer;
  std::unique_ptr<ByteStream> stream;
  SlcanLines lines;
  std::string text;  // of a frame
  kernel::EventId ask = 0;
  bool bells_expected = false;
};

SlcanClient::SlcanClient(std::shared_ptr<Impl> impl) : RemotePort(impl), impl_(std::move(impl)) {}

SlcanClient::~SlcanClient() {
  impl_->handlers.reset();
  impl_->stop_asking();
  impl_->dialer.reset();
  impl_->say(impl_->scheduler.now(), "C\r");
  if (impl_->stream) impl_->stream->close();
}

Result<std::unique_ptr<SlcanClient>, std::string> SlcanClient::open_tty(EventLoop& loop, const std::string& path,
                                                                        std::uint32_t baud, std::uint32_t bitrate) {
  if (const auto known = check_bitrate(bitrate); !known) return Unexpected(known.error());
  SerialTtyOptions options;
  options.path = path;
  options.settings.baud = baud;
  auto tty = SerialTty::open(loop, options);
  if (!tty) return Unexpected(tty.error());
  auto impl = std::make_shared<Impl>(loop.scheduler(), bitrate);
  impl->where = path;
  SerialTty* const line = tty->get();
  line->set_notice([weak = impl->weak(), line](Instant now, const std::string&) {
    const auto self = weak.lock();
    if (!self) return;
    if (line->is_present()) return self->set_up(now);
    self->stop_asking();
    self->enter(now, CanState::kOffline);
  });
  impl->connect(loop.now(), std::move(*tty));
  return std::unique_ptr<SlcanClient>(new SlcanClient(std::move(impl)));
}

Result<std::unique_ptr<SlcanClient>, std::string> SlcanClient::open_tcp(EventLoop& loop, const std::string& host,
                                                                        std::uint16_t port, std::uint32_t bitrate) {
  if (const auto known = check_bitrate(bitrate); !known) return Unexpected(known.error());
  auto impl = std::make_shared<Impl>(loop.scheduler(), bitrate);
  impl->where = host + ":" + std::to_string(port);
  auto dialer = TcpDialer::open(loop, host, port, [weak = impl->weak()](Instant now, std::unique_ptr<ByteStream> s) {
    if (const auto self = weak.lock()) self->connect(now, std::move(s));
  });
  if (!dialer) return Unexpected(dialer.error());
  impl->dialer = std::move(*dialer);
  return std::unique_ptr<SlcanClient>(new SlcanClient(std::move(impl)));
}

Result<std::unique_ptr<SlcanClient>, std::string> SlcanClient::open_stream(kernel::Scheduler& scheduler, Instant now,
                                                                           std::unique_ptr<ByteStream> stream,
                                                                           std::uint32_t bitrate) {
  if (const auto known = check_bitrate(bitrate); !known) return Unexpected(known.error());
  auto impl = std::make_shared<Impl>(scheduler, bitrate);
  impl->where = stream->name();
  impl->connect(now, std::move(stream));
  return std::unique_ptr<SlcanClient>(new SlcanClient(std::move(impl)));
}

bool SlcanClient::hand_over(Instant now, const CanFrame& frame) {
  impl_->say_frame(now, frame);
  return true;
}

void SlcanClient::set_online(Instant now, bool online) {
  if (std::exchange(impl_->online, online) == online) return;
  if (!online) {
    impl_->stop_asking();
    impl_->say(now, "C\r");
    return impl_->enter(now, CanState::kOffline);
  }
  if (impl_->stream) impl_->set_up(now);
}

Result<void, std::string> SlcanClient::set_bitrate(Instant now, std::uint32_t bitrate) {
  if (auto known = check_bitrate(bitrate); !known) return known;
  impl_->bitrate = bitrate;
  if (impl_->stream && impl_->is_up()) impl_->set_up(now);
  return {};
}

std::string SlcanClient::name() const { return "slcan " + impl_->where; }

}  // namespace vinv::transports
