// What this machine lets a plant do, for `vinverter doctor`. Each check tries the thing itself and undoes it.
#pragma once

#include <cstdint>
#include <string>

#include "sim/kernel/lateness.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

struct Finding {
  bool ok = false;
  std::string sentence;  // what works, or what does not and what to do about it
};

// Runs an event loop of its own with a 1 ms tick for this long and reports how late its ticks were.
kernel::LatenessHistogram measure_timer_lateness(Duration span = std::chrono::seconds(1));
// Raw CAN sockets, and the CAN interfaces that there are.
Finding has_kernel_can();
// Whether a TCP listener could be opened there now; port 0 asks for any.
Finding can_bind(const std::string& host, std::uint16_t port);
// Whether an adapter could have all its ports at this address now: TCP and UDP explicit_port, UDP io_port. If not, who
// has them.
Finding can_be_adapter(std::uint32_t address, std::uint16_t explicit_port, std::uint16_t io_port);
// Whether this process may use real-time scheduling. The scheduling of the calling thread is as before afterwards.
Finding can_schedule_realtime();
Finding can_open_pty();

}  // namespace vinv::transports
