// Joins another bus to ours: what is heard on one side is sent on the other. So faults, recorder and any number of
// drives work on a kernel interface or a bus behind TCP as on a virtual one. On our bus the bridge is a node like any
// other and acknowledges; a CanBus without timing adds no delay. What the other side has no room for waits here, in
// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "sim/transports/can/can_bus.hpp"

namespace vinv::transports {

class CanBridge {
 public:
  // Frames that wait for one side; more are lost.
  static constexpr std::size_t kMaxQueuedFrames = 512;

  // The bus outlives the bridge.
  CanBridge(Instant now, CanBus& bus, std::unique_ptr<CanPort> outside);
  ~CanBridge();
  CanBridge(const CanBridge&) = delete;
  CanBridge& operator=(const CanBridge&) = delete;

  CanPort& outside();
  const CanPort& outside() const;
  // Called when the other bus goes down, comes up, or its controller changes its state.
  void on_outside_state(std::function<void(Instant now)> action);
  // Frames that one side could not take; what is heard here while there is no outside is not counted.
  std::uint64_t lost() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vinv::transports
