// A bus at 500 kbit/s with one node, for a session of a CAN server under a fuzzer: what the node and the session's
// client say comes from the fuzzer, what reaches them is kept.
#pragma once

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/check.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/wire_format.hpp"
#include "sim/transports/memory_link.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace vinv::fuzz {

// What of the node was on the wire, also when the node had left before the end of its frame.
struct WireOfOther : transports::CanBusObserver {
  void on_frame(Instant, const CanFrame& frame, std::string_view sender) override {
    if (sender == "other") frames.push_back(frame);
  }
  std::vector<CanFrame> frames;
};

class CanClientBench {
 public:
  CanClientBench() {
    scheduler.run_until(instant_from_ns(1'000'000'000));
    transports::CanBusOptions options;
    options.bitrate = 500'000;
    bus = std::make_unique<transports::CanBus>(scheduler, options);
    transports::CanNodeOptions node_options;
    node_options.name = "other";
    other = bus->attach(scheduler.now(), node_options);
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant, const CanFrame& frame) {
      VINV_CHECK(transports::is_well_formed(frame));
      heard_by_other.push_back(frame);
    };
    other->set_handlers(std::move(handlers));
    bus->observe(wire);
  }

  // A new client; returns the server's end of its connection.
  std::unique_ptr<transports::ByteStream> connect() {
    auto link = transports::make_memory_link(scheduler, {{}, "server", "client"});
    client = std::move(link.second);
    heard.clear();
    closed = false;
    client->set_handlers([this](Instant, ByteView bytes, bool) { heard.append(bytes.begin(), bytes.end()); },
                         [this](Instant, const std::string&) { closed = true; });
    return std::move(link.first);
  }
  void say(std::string_view text) {
    if (closed) return;
    client->send(scheduler.now(), {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    scheduler.run_until(scheduler.now());
  }
  void run_for(Duration span) { scheduler.run_until(scheduler.now() + span); }

  // A frame of any kind from the fuzzer's bytes.
  static CanFrame any_frame(Input& input) {
    CanFrame frame;
    const std::uint8_t kind = input.byte();
    frame.extended = (kind & 0x80) != 0;
    frame.remote = (kind & 0x40) != 0;
    frame.length = static_cast<std::uint8_t>((kind & 0x3f) % 9);
    frame.id = input.word();
    frame.id = frame.extended ? frame.id << 13 | frame.id >> 3 : frame.id & 0x7ffu;
    const Bytes data = input.chunk(frame.bytes().size());
    std::copy(data.begin(), data.end(), frame.data.begin());
    return frame;
  }

  // Operations of a fuzzer's input, up to kMaxOperations: say(text) any text, known texts (of which there are any
  // number) and frames as frame_text(frame) has them; frames of the node, time, errors on the bus; for the rest
  // otherwise(argument).
  template <class Say, class Known, class FrameText, class Otherwise>
  void play(Input& input, Say&& say_text, const Known& known, FrameText&& frame_text, Otherwise&& otherwise) {
    for (int i = 0; i < kMaxOperations && !input.empty(); ++i) {
      const std::uint8_t operation = input.byte();
      const std::uint8_t argument = operation >> 3;
      switch (operation & 7) {
        case 0:
        case 1: {  // any text
          const Bytes text = input.chunk(argument + 1u);
          say_text(std::string_view(reinterpret_cast<const char*>(text.data()), text.size()));
          break;
        }
        case 2: say_text(std::string_view(known[argument % std::size(known)])); break;
        case 3: say_text(std::string_view(frame_text(any_frame(input)))); break;
        case 4: other->send(scheduler.now(), any_frame(input)); break;
        case 5: run_for(Duration(std::chrono::microseconds(50)) * (argument + 1)); break;
        case 6:
          if (argument < 16)
            bus->inject_error_frame(scheduler.now());
          else
            other->force_bus_off(scheduler.now());
          break;
        default: otherwise(argument); break;
      }
    }
  }
  static constexpr int kMaxOperations = 300;

  kernel::Scheduler scheduler;
  std::unique_ptr<transports::CanBus> bus;
  std::unique_ptr<transports::CanNode> other;
  std::vector<CanFrame> heard_by_other;
  std::shared_ptr<WireOfOther> wire = std::make_shared<WireOfOther>();
  const std::vector<CanFrame>& sent_by_other = wire->frames;
  std::unique_ptr<transports::ByteStream> client;
  std::string heard;  // by the client
  bool closed = false;
};

// Each of these frames is among those, in the same order.
inline bool is_in_order_within(const std::vector<CanFrame>& these, const std::vector<CanFrame>& those) {
  auto at = those.begin();
  for (const CanFrame& frame : these) {
    at = std::find(at, those.end(), frame);
    if (at == those.end()) return false;
    ++at;
  }
  return true;
}

}  // namespace vinv::fuzz
