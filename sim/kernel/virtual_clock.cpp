#include "sim/kernel/virtual_clock.hpp"

namespace vinv::kernel {

bool VirtualClock::run_until(Instant until) {
  stop_requested_ = false;
  while (scheduler_.run_next(until)) {
    if (stop_requested_) return false;
  }
  scheduler_.run_until(until);
  return true;
}

}  // namespace vinv::kernel
