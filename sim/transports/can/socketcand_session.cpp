#include "sim/transports/can/socketcand_session.hpp"

#include <algorithm>
#include <utility>

#include "sim/transports/can/error_frame.hpp"
#include "sim/transports/can/session_text.hpp"

namespace vinv::transports {
struct SocketcandSession::Impl : std::enable_shared_from_this<Impl> {
  enum class Mode { kNoBus, kBcm, kRaw, kEnded };

  Impl(kernel::Scheduler& s, const SocketcandOptions& o, std::unique_ptr<ByteStream> st, std::function<void()> end)
      : scheduler(s), options(o), stream(std::move(st)), out(s, *stream), on_end(std::move(end)) {}

  void start(Instant now) {
    const std::weak_ptr<Impl> weak = weak_from_this();
    stream->set_handlers(
        [weak](Instant t, ByteView bytes, bool) {
          if (const auto self = weak.lock()) self->receive(t, bytes);
        },
        [weak](Instant, const std::string&) {
          if (const auto self = weak.lock()) self->end();
        });
    say(now, "< hi >");
  }

  void receive(Instant now, ByteView bytes) {
    release(now);
    const std::uint64_t overlong = messages.overlong();
    messages.feed(bytes, [&](std::string_view inside) {
      if (mode != Mode::kEnded) obey(now, socketcand_words(inside));
    });
    if (mode != Mode::kEnded && messages.overlong() != overlong) say(now, "< error message too long >");
  }

  void obey(Instant now, const SocketcandWords& words) {
    const std::string_view command = words.empty() ? std::string_view() : words[0];
    if (command == "echo" && words.size() == 1) return say(now, "< echo >");
    if (mode == Mode::kNoBus) {
      if (command == "open" && words.size() == 2) return open(now, words[1]);
      return say(now, "< error no bus is open >");
    }
    if (command == "rawmode" && words.size() == 1) return enter(now, Mode::kRaw);
    if (command == "bcmmode" && words.size() == 1) return enter(now, Mode::kBcm);
    if (command == "send" || command == "sendrtr") return send(now, words);
    say(now, "< error unknown command >");
  }

  void open(Instant now, std::string_view name) {
    const SocketcandBus* found = options.buses.size() == 1 ? options.buses.data() : nullptr;
    for (const SocketcandBus& b : options.buses) found = b.name == name ? &b : found;
    if (found == nullptr || name.size() > kMaxBusNameBytes) {
      say(now, "< error could not open bus >");
      out.flush(now);
      stream->close();
      return end();
    }
    CanNodeOptions node_options;
    node_options.name = "socketcand " + stream->name();
    node_options.queue_frames = kMaxQueuedFrames;
    node = found->bus->attach(now, std::move(node_options));
    const std::weak_ptr<Impl> weak = weak_from_this();
    CanHandlers handlers;
    handlers.on_frame = [weak](Instant t, const CanFrame& frame) {
      if (const auto self = weak.lock()) self->forward(t, frame);
    };
    handlers.on_state = [weak](Instant t, const CanStatus& status) {
      const auto self = weak.lock();
      if (!self || self->mode != Mode::kRaw) return;
      self->text(t) += " " + socketcand_error(error_frame_of(status).error_class, self->unix_us(t));
    };
    node->set_handlers(std::move(handlers));
    enter(now, Mode::kBcm);
  }

  void enter(Instant now, Mode next) {
    mode = next;
    say(now, "< ok >");
    if (mode != Mode::kRaw || hold != 0) return;
    hold = scheduler.schedule(std::max(now, scheduler.now()) + kAfterOk, kernel::Priority::kWire,
                              [weak = weak_from_this()](Instant t) {
                                const auto self = weak.lock();
                                if (!self) return;
                                self->hold = 0;
                                self->release(t);
                              });
  }

  void send(Instant now, const SocketcandWords& words) {
    const auto frame = parse_socketcand_send(words);
    if (!frame) return say(now, "< error " + frame.error() + " >");
    switch (node->send(now, *frame)) {
      case CanSend::kQueued:
      case CanSend::kDroppedOldest: break;
      case CanSend::kRefusedFull: return say(now, "< error transmit queue full >");
      case CanSend::kRefusedState: return say(now, "< error bus off >");
    }
  }

  void forward(Instant now, const CanFrame& frame) {
    if (mode != Mode::kRaw) return;
    std::string& to = text(now);
    to += ' ';
    append_socketcand_received(to, frame, unix_us(now));
  }

  // For what the bus tells.
  std::string& text(Instant now) {
    if (held.size() > ByteStream::kMaxQueuedBytes / 2) release(now);
    return hold != 0 ? held : out.at(now);
  }

  void release(Instant now) {
    if (hold != 0) scheduler.cancel(std::exchange(hold, 0));
    if (held.empty()) return;
    out.flush(now);  // an < ok > goes alone
    out.say(now, held);
    held.clear();
  }

  void say(Instant now, std::string_view message) { out.say(now, message); }
  std::int64_t unix_us(Instant now) const { return (options.start_unix_ns + to_ns(now)) / 1000; }

  void shut() {
    mode = Mode::kEnded;
    out.drop();
    if (hold != 0) scheduler.cancel(std::exchange(hold, 0));
    node.reset();
  }
  void end() {
    shut();
    const auto tell = std::exchange(on_end, nullptr);
    if (tell) tell();
  }

  kernel::Scheduler& scheduler;
  const SocketcandOptions& options;
  std::unique_ptr<ByteStream> stream;
  SessionText out;
  std::function<void()> on_end;
  std::unique_ptr<CanNode> node;
  SocketcandMessages messages;
  Mode mode = Mode::kNoBus;
  kernel::EventId hold = 0;  // frames wait: the client still reads an < ok >
  std::string held;
};

SocketcandSession::SocketcandSession(kernel::Scheduler& scheduler, Instant now, const SocketcandOptions& options,
                                     std::unique_ptr<ByteStream> stream, std::function<void()> on_end)
    : impl_(std::make_shared<Impl>(scheduler, options, std::move(stream), std::move(on_end))) {
  impl_->start(now);
}

SocketcandSession::~SocketcandSession() {
  impl_->on_end = nullptr;
  impl_->shut();
  impl_->stream->close();
}

}  // namespace vinv::transports
