// Faults on a serial line, a TCP port or the UDP ports of an adapter: around each stream or port that a plant is
// connected to. Seen from the board's end: sending is what the board does.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/transports/fault_injector.hpp"
#include "sim/transports/faulty_udp.hpp"

namespace vinv::rig {

class WireTap {
 public:
  // The scheduler outlives the tap.
  explicit WireTap(kernel::Scheduler& scheduler) : scheduler_(scheduler) {}

  std::unique_ptr<transports::ByteStream> wrap(std::unique_ptr<transports::ByteStream> stream);
  std::unique_ptr<transports::FaultyUdp> wrap(std::unique_ptr<transports::UdpPort> port);

  // Of the chance by which faults strike; 1 until set.
  void reseed(std::uint64_t seed) {
    seed_ = seed;
    if (course_ != nullptr) course_->reseed(seed);
  }
  // Lasts until it is cleared, on connections to come too, and pieces are counted over all of them. A rule takes the
  // place of one with the same fault and direction, and then counts and chance begin anew; one that never acts only
  // removes that.
  void set_fault(const transports::FaultRule& rule);
  void clear_faults();
  // The connections that there are stay so for ever; new ones are whole.
  void half_open();
  const std::vector<transports::FaultRule>& faults() const;

  // Snapshots: of a tap whose streams are lines in memory, after the owners of these; a load expects them wrapped anew
  // in the same order. Streams that are outside the plant are left out. What waits in UDP ports is their owner's to
  // archive.
  friend void archive(Archive& a, WireTap& tap) { tap.archive_state(a); }

 private:
  void archive_state(Archive& a);
  void forget_dead();
  transports::FaultCourse& course();

  kernel::Scheduler& scheduler_;
  std::uint64_t seed_ = 1;
  std::shared_ptr<transports::FaultCourse> course_;  // of all streams; made when it is needed
  std::vector<transports::FaultInjector::Handle> streams_;
};

}  // namespace vinv::rig
