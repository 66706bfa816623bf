// The far end of a memory link: what it sends, and what came back as text.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "sim/transports/memory_link.hpp"

namespace vinv::transports {

struct TextClient {
  explicit TextClient(kernel::Scheduler& s) : scheduler(s) {
    auto link = make_memory_link(s, {{}, "127.0.0.1:40000", "server"});
    end = std::move(link.first);
    far = std::move(link.second);
    std::swap(end, far);  // the server sees the client's name
    end->set_handlers(
        [this](Instant, ByteView bytes, bool) {
          heard.append(bytes.begin(), bytes.end());
          ++pieces;
        },
        [this](Instant, const std::string&) { closed = true; });
  }
  void send(const std::string& text) {
    end->send(scheduler.now(), {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    scheduler.run_until(scheduler.now());
  }
  std::string take() { return std::exchange(heard, {}); }

  kernel::Scheduler& scheduler;
  std::unique_ptr<ByteStream> end;
  std::unique_ptr<ByteStream> far;  // for the server
  std::string heard;
  int pieces = 0;  // in which it came
  bool closed = false;
};

}  // namespace vinv::transports
