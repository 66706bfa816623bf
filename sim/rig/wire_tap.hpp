// Faults on a serial line or a TCP port: around each stream that a plant is connected to. Seen from the board's end:
// sending is what the board does.
#pragma once

#include <memory>
#include <vector>

#include "sim/transports/fault_injector.hpp"

namespace vinv::rig {

class WireTap {
 public:
  // The scheduler outlives the tap.
  explicit WireTap(kernel::Scheduler& scheduler) : scheduler_(scheduler) {}

  std::unique_ptr<transports::ByteStream> wrap(std::unique_ptr<transports::ByteStream> stream);

  // Lasts until it is cleared, on connections to come too, each of which counts for itself. A rule takes the place of
  // one with the same fault and direction; one that never acts only removes that.
  void set_fault(const transports::FaultRule& rule);
  void clear_faults();
  // The connections that there are stay so for ever; new ones are whole.
  void half_open();
  const std::vector<transports::FaultRule>& faults() const { return faults_; }

 private:
  void forget_dead();

  kernel::Scheduler& scheduler_;
  std::vector<transports::FaultRule> faults_;
  std::vector<transports::FaultInjector::Handle> streams_;
};

}  // namespace vinv::rig
