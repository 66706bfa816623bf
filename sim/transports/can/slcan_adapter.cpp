#include "sim/transports/can/slcan_adapter.hpp"

#include <utility>

#include "sim/transports/can/number_text.hpp"
#include "sim/transports/can/session_text.hpp"

namespace vinv::transports {
namespace {

// Bits of the F answer: the status register of an SJA1000 as the manuals number it.
constexpr std::uint8_t kTransmitFull = 0x02;
constexpr std::uint8_t kWarning = 0x04;
constexpr std::uint8_t kPassive = 0x20;
constexpr std::uint8_t kBusError = 0x80;

constexpr const char* kOk = "\r";
constexpr const char* kBell = "\a";

}  // namespace

struct SlcanAdapter::Impl : std::enable_shared_from_this<Impl> {
  Impl(CanBus& b, std::unique_ptr<ByteStream> s, std::function<void()> end)
      : bus(b), stream(std::move(s)), out(b.scheduler(), *stream), on_end(std::move(end)) {}

  void start() {
    const std::weak_ptr<Impl> weak = weak_from_this();
    // A pseudo-terminal tells that the client chose another speed than ours: no matter, there is no wire.
    stream->set_handlers(
        [weak](Instant now, ByteView bytes, bool) {
          const auto self = weak.lock();
          if (!self) return;
          self->lines.feed(bytes, [&](std::string_view line) {
            if (self->stream_open) self->out.say(now, self->obey(now, line));
          });
        },
        [weak](Instant, const std::string&) {
          const auto self = weak.lock();
          if (!self) return;
          self->shut();
          const auto tell = std::exchange(self->on_end, nullptr);
          if (tell) tell();
        });
  }

  std::string obey(Instant now, std::string_view line) {
    if (line.empty()) return kOk;
    if (line.size() > SlcanLines::kMaxLineBytes) return kBell;
    const std::string_view argument = line.substr(1);
    switch (line[0]) {
      case 't':
      case 'T':
      case 'r':
      case 'R': return transmit(now, line);
      case 'S':
        if (node || argument.size() != 1 || argument[0] < '0' || argument[0] > '8') return kBell;
        bitrate = kSlcanBitrates[static_cast<std::size_t>(argument[0] - '0')];
        return kOk;
      case 's': {
        const auto registers = parse_hex(argument);
        if (node || argument.size() != 4 || !registers) return kBell;
        bitrate = slcan_bitrate_of_registers(static_cast<std::uint8_t>(*registers >> 8),
                                             static_cast<std::uint8_t>(*registers));
        return kOk;
      }
      case 'O': return open(now, argument, false);
      case 'L': return open(now, argument, true);
      case 'C':
        if (!node || !argument.empty()) return kBell;
        node.reset();
        return kOk;
      case 'F': return node && argument.empty() ? flags() : kBell;
      case 'V': return argument.empty() ? "V1013\r" : kBell;
      case 'v': return argument.empty() ? "v0100\r" : kBell;
      case 'N': return argument.empty() ? "NVINV\r" : kBell;
      case 'Z':
        if (node || (argument != "0" && argument != "1")) return kBell;
        stamps = argument == "1";
        return kOk;
      case 'X': return !node && argument == "1" ? kOk : kBell;
      case 'M': return !node && argument == "00000000" ? kOk : kBell;
      case 'm': return !node && (argument == "FFFFFFFF" || argument == "ffffffff") ? kOk : kBell;
      default: return kBell;
    }
  }

  std::string open(Instant now, std::string_view argument, bool listen_only) {
    if (node || !argument.empty()) return kBell;
    CanNodeOptions options;
    options.name = "slcan " + stream->name();
    options.bitrate = bitrate;
    options.listen_only = listen_only;
    options.queue_frames = kMaxQueuedFrames;
    node = bus.attach(now, std::move(options));
    refused = false;
    CanHandlers handlers;
    handlers.on_frame = [weak = weak_from_this()](Instant t, const CanFrame& frame) {
      if (const auto self = weak.lock()) self->forward(t, frame);
    };
    node->set_handlers(std::move(handlers));
    return kOk;
  }

  std::string transmit(Instant now, std::string_view line) {
    const auto frame = parse_slcan_frame(line);
    if (!frame || !node) return kBell;
    const CanSend result = node->send(now, *frame);
    refused = refused || result == CanSend::kRefusedFull;
    if (result != CanSend::kQueued) return kBell;
    return frame->extended ? "Z\r" : "z\r";
  }

  std::string flags() {
    std::uint8_t bits = std::exchange(refused, false) ? kTransmitFull : std::uint8_t{0};
    switch (node->status().state) {
      case CanState::kErrorActive: break;
      case CanState::kErrorWarning: bits |= kWarning; break;
      case CanState::kErrorPassive: bits |= kWarning | kPassive; break;
      case CanState::kBusOff:
      case CanState::kOffline: bits |= kWarning | kPassive | kBusError; break;
    }
    std::string answer = "F";
    append_hex(answer, bits, 2);
    return answer + "\r";
  }

  void forward(Instant now, const CanFrame& frame) {
    std::optional<std::uint16_t> stamp;
    if (stamps) stamp = static_cast<std::uint16_t>(to_ns(now) / 1'000'000 % 60'000);
    std::string& text = out.at(now);
    append_slcan_frame(text, frame, stamp);
    text += '\r';
  }

  void shut() {
    stream_open = false;
    out.drop();
    node.reset();
  }

  CanBus& bus;
  std::unique_ptr<ByteStream> stream;
  SessionText out;
  std::function<void()> on_end;
  SlcanLines lines;
  std::unique_ptr<CanNode> node;  // while the channel is open
  std::uint32_t bitrate = 0;      // that of the bus
  bool stamps = false;
  bool refused = false;
  bool stream_open = true;
};

SlcanAdapter::SlcanAdapter(CanBus& bus, std::unique_ptr<ByteStream> stream, std::function<void()> on_end)
    : impl_(std::make_shared<Impl>(bus, std::move(stream), std::move(on_end))) {
  impl_->start();
}

SlcanAdapter::~SlcanAdapter() {
  impl_->on_end = nullptr;
  impl_->shut();
  impl_->stream->close();
}

bool SlcanAdapter::is_open() const { return impl_->node != nullptr; }

}  // namespace vinv::transports
