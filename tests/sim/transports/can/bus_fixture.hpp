// Nodes on a bus in virtual time that write down what they hear.
#pragma once

#include <cstdio>
#include <deque>
#include <memory>
#include <string>

#include "sim/transports/can/can_bus.hpp"

namespace vinv::transports {

inline std::string show(const CanFrame& frame) {
  char id[16];
  std::snprintf(id, sizeof id, frame.extended ? "%08X" : "%03X", static_cast<unsigned>(frame.id));
  std::string out = std::string(id) + "#";
  if (frame.remote) return out + "R" + std::to_string(frame.length);
  for (const std::uint8_t b : frame.bytes()) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%02X", b);
    out += hex;
  }
  return out;
}

inline std::string us(Instant t) { return std::to_string(to_ns(t) / 1000); }

// Each line is TIME_US FRAME, or TIME_US sent FRAME, or TIME_US STATE.
struct LoggingNode {
  LoggingNode(Instant now, CanBus& bus, CanNodeOptions options) : node(bus.attach(now, std::move(options))) {
    listen();
  }
  void listen() {
    node->set_handlers({[this](Instant t, const CanFrame& f) { log += us(t) + " " + show(f) + "\n"; },
                        [this](Instant t, const CanFrame& f) { log += us(t) + " sent " + show(f) + "\n"; },
                        [this](Instant t, const CanStatus& s) { log += us(t) + " " + text(s.state) + "\n"; }});
  }
  std::unique_ptr<CanNode> node;
  std::string log;
};

// Starts at 1 s, so that nothing relies on time beginning at zero.
struct BusBench {
  explicit BusBench(CanBusOptions options = {}) {
    scheduler.run_until(start);
    bus = std::make_unique<CanBus>(scheduler, std::move(options));
  }
  LoggingNode& add(CanNodeOptions options) { return nodes.emplace_back(now(), *bus, std::move(options)); }
  LoggingNode& add(const std::string& name) {
    CanNodeOptions options;
    options.name = name;
    return add(std::move(options));
  }
  Instant now() const { return scheduler.now(); }
  void run_to_us(std::int64_t after_start) { scheduler.run_until(start + std::chrono::microseconds(after_start)); }
  CanBusStats stats() const { return bus->stats(scheduler.now()); }
  friend void archive(Archive& a, BusBench& bench) {
    a.io(bench.scheduler);
    a.io(*bench.bus);
    bench.scheduler.archive_waiting(a);
  }

  const Instant start = instant_from_ns(1'000'000'000);
  kernel::Scheduler scheduler;
  std::unique_ptr<CanBus> bus;
  std::deque<LoggingNode> nodes;
};

}  // namespace vinv::transports
