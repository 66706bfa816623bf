// Two ends of a line in memory, over the scheduler: what one end sends arrives at the other after a fixed delay (and
// the time of its characters), in order, at Priority::kWire. For virtual time; it works under every clock.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

struct MemoryLinkOptions {
  Duration delay{};  // zero: arrives at the instant of sending, after the action that sent it
  std::string name_a = "memory a";
  std::string name_b = "memory b";
  // Of a serial line: what is sent arrives when its last character does, and waits for what was sent before it.
  Duration character{};
};

using MemoryLink = std::pair<std::unique_ptr<ByteStream>, std::unique_ptr<ByteStream>>;

// The scheduler outlives both ends. Closing (or destroying) an end tells the other after the delay, behind what was
// sent before. Bytes for an end without handlers wait for them, up to kMaxQueuedBytes.
MemoryLink make_memory_link(kernel::Scheduler& scheduler, const MemoryLinkOptions& options = {});

}  // namespace vinv::transports
