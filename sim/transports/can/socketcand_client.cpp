#include "sim/transports/can/socketcand_client.hpp"

#include <utility>

#include "sim/transports/can/error_frame.hpp"
#include "sim/transports/can/number_text.hpp"
#include "sim/transports/can/socketcand_text.hpp"
#include "sim/transports/can/tcp_dialer.hpp"

namespace vinv::transports {
namespace {

ByteView view(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

}  // namespace

struct SocketcandClient::Impl : RemotePortState {
  // What the server has to say next.
  enum class Expects { kHi, kOkToOpen, kOkToRawMode, kFrames };

  Impl(kernel::Scheduler& s, std::string b) : RemotePortState(s), bus(std::move(b)) {}

  std::weak_ptr<Impl> weak() { return std::static_pointer_cast<Impl>(shared_from_this()); }

  void connect(std::unique_ptr<ByteStream> fresh) {
    stream = std::move(fresh);
    expects = Expects::kHi;
    messages = {};
    stream->set_handlers(
        [w = weak()](Instant now, ByteView bytes, bool) {
          const auto self = w.lock();
          if (!self) return;
          self->messages.feed(bytes, [&](std::string_view inside) { self->hear(now, inside); });
        },
        [w = weak()](Instant now, const std::string& reason) {
          const auto self = w.lock();
          if (!self) return;
          self->complaint = reason;
          self->lose(now);
        });
  }

  void hear(Instant now, std::string_view inside) {
    if (!stream) return;
    const SocketcandWords words = socketcand_words(inside);
    if (words.empty()) return;
    switch (expects) {
      case Expects::kHi:
        if (words[0] != "hi") return refuse(now, inside);
        expects = Expects::kOkToOpen;
        return say(now, "< open " + bus + " >");
      case Expects::kOkToOpen:
        if (words[0] != "ok") return refuse(now, inside);
        expects = Expects::kOkToRawMode;
        return say(now, "< rawmode >");
      case Expects::kOkToRawMode:
        if (words[0] != "ok") return refuse(now, inside);
        expects = Expects::kFrames;
        complaint.clear();
        if (online) enter(now, CanState::kErrorActive);
        return;
      case Expects::kFrames: break;
    }
    if (words[0] == "frame" || words[0] == "rtr") {
      const auto got = parse_socketcand_received(words);
      if (got) received(now, got->frame);
    } else if (words[0] == "error") {
      hear_error(now, words, inside);
    }
  }

  // Either classes and a time, of a controller, or words, about what we sent.
  void hear_error(Instant now, const SocketcandWords& words, std::string_view inside) {
    const auto error_class = words.size() == 3 ? parse_hex(words[1]) : std::nullopt;
    if (!error_class || words[2].find('.') == std::string_view::npos) {
      complaint = std::string(inside);
      ++status.lost;
      return;
    }
    const CanErrorNews news = news_of({*error_class, {}});
    if (news.has_state && is_up()) enter(now, news.state);
  }

  void refuse(Instant now, std::string_view inside) {
    complaint = "the server answered \"" + std::string(inside) + "\"";
    stream->close();
    lose(now);
  }

  void lose(Instant now) {
    stream.reset();
    enter(now, CanState::kOffline);
    if (dialer) dialer->lost();
  }

  void say(Instant now, const std::string& words) { stream->send(now, view(words)); }

  std::string bus;
  std::unique_ptr<TcpDialer> dialer;
  std::unique_ptr<ByteStream> stream;
  SocketcandMessages messages;
  std::string text;  // of a frame
  Expects expects = Expects::kHi;
  std::string complaint;
};

SocketcandClient::SocketcandClient(std::shared_ptr<Impl> impl) : RemotePort(impl), impl_(std::move(impl)) {}

SocketcandClient::SocketcandClient(kernel::Scheduler& scheduler, const std::string& bus,
                                   std::unique_ptr<ByteStream> stream)
    : SocketcandClient(std::make_shared<Impl>(scheduler, bus)) {
  impl_->connect(std::move(stream));
}

SocketcandClient::~SocketcandClient() {
  impl_->handlers.reset();
  impl_->dialer.reset();
  if (impl_->stream) impl_->stream->close();
}

Result<std::unique_ptr<SocketcandClient>, std::string> SocketcandClient::open(EventLoop& loop, const std::string& host,
                                                                              std::uint16_t port,
                                                                              const std::string& bus) {
  auto impl = std::make_shared<Impl>(loop.scheduler(), bus);
  auto dialer = TcpDialer::open(loop, host, port, [weak = impl->weak()](Instant, std::unique_ptr<ByteStream> stream) {
    if (const auto self = weak.lock()) self->connect(std::move(stream));
  });
  if (!dialer) return Unexpected(dialer.error());
  impl->dialer = std::move(*dialer);
  return std::unique_ptr<SocketcandClient>(new SocketcandClient(std::move(impl)));
}

bool SocketcandClient::hand_over(Instant now, const CanFrame& frame) {
  impl_->text.clear();
  append_socketcand_send(impl_->text, frame);
  impl_->say(now, impl_->text);
  return true;
}

// The connection stays: the server's side of the bus does not know of our power.
void SocketcandClient::set_online(Instant now, bool online) {
  if (std::exchange(impl_->online, online) == online) return;
  const bool connected = impl_->stream && impl_->expects == Impl::Expects::kFrames;
  impl_->enter(now, online && connected ? CanState::kErrorActive : CanState::kOffline);
}

Result<void, std::string> SocketcandClient::set_bitrate(Instant, std::uint32_t) {
  return Unexpected(std::string("the bit rate of a bus behind socketcand is set at its server"));
}

std::string SocketcandClient::name() const { return "socketcand " + impl_->bus; }
std::string SocketcandClient::error() const {
  if (!impl_->complaint.empty()) return impl_->complaint;
  return impl_->dialer ? impl_->dialer->error() : std::string();
}

}  // namespace vinv::transports
