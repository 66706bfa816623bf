// One CAN bus of a plant with the boards on it. A bus that is elsewhere (a kernel interface, a server) is joined by a
// bridge: here it is a bus without timing, so that each board has a node, a view and a queue of its own as on ours.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "option_boards/boards/option_board.hpp"
#include "sim/rig/networks.hpp"
#include "sim/transports/can/can_bridge.hpp"
#include "sim/transports/can/can_bus.hpp"

namespace vinv::rig {

class CanLine {
 public:
  // Frames of a board that wait in its controller. A slave has few transmit buffers; what waits beyond them waits in
  // the board, which sends the newest data when its turn comes.
  static constexpr std::size_t kBoardBuffers = 2;

  // The scheduler outlives the line.
  CanLine(kernel::Scheduler& scheduler, const CanNetwork& network);
  ~CanLine();
  CanLine(const CanLine&) = delete;
  CanLine& operator=(const CanLine&) = delete;

  // A board's controller. Something has gone in or out: the owner then settles the board.
  using OnTraffic = std::function<void(Instant now)>;
  // The channel outlives the line. Returns the number of the controller.
  std::size_t add(Instant now, boards::CanChannel& channel, const std::string& name, OnTraffic on_traffic);
  // After any handle_ call of the board: takes its controller on or off the bus and sends while there is room.
  void settle(Instant now, std::size_t controller);

  // Joins the bus that is elsewhere. While that is down the boards are off the bus, and its bus off is theirs.
  void join(Instant now, std::unique_ptr<transports::CanPort> outside);

  // A person pulls the board's connector, or puts it back.
  void plug(Instant now, std::size_t controller, bool plugged);
  bool plugged(std::size_t controller) const { return controllers_[controller]->plugged; }

  // Of the chance by which later faults strike; 1 until set.
  void set_seed(std::uint64_t seed) { seed_ = seed; }
  // Of those that there are, too.
  void reseed(std::uint64_t seed) {
    seed_ = seed;
    bus_.reseed(seed);
  }
  // Faults that last until they are cleared. A rule takes the place of one with the same fault, node and identifier;
  // one that never acts only removes that.
  void set_fault(const transports::CanFaultRule& rule);
  void clear_faults();
  const std::vector<transports::CanFaultRule>& faults() const { return faults_; }

  transports::CanBus& bus() { return bus_; }
  const transports::CanBus& bus() const { return bus_; }
  transports::CanNode& controller(std::size_t number) { return *controllers_[number]->node; }
  const transports::CanNode& controller(std::size_t number) const { return *controllers_[number]->node; }
  // nullptr on a bus of ours.
  const transports::CanBridge* bridge() const { return bridge_.get(); }

  // Snapshots: the bus, and its controllers as they were last settled. Not of a line that is joined to another bus.
  friend void archive(Archive& a, CanLine& line) { line.archive_state(a); }

 private:
  struct Controller {
    boards::CanChannel* channel = nullptr;
    std::unique_ptr<transports::CanNode> node;
    OnTraffic on_traffic;
    std::uint32_t bitrate = 0;  // as the node has it; 0: off the bus
    bool settling = false;
    bool bus_off = false;  // as the board was told
    bool plugged = true;
  };

  void follow_state(Instant now, Controller& controller);
  void follow_outside(Instant now);
  void archive_state(Archive& a);

  transports::CanBus bus_;
  std::vector<std::unique_ptr<Controller>> controllers_;
  std::unique_ptr<transports::CanBridge> bridge_;
  std::uint64_t seed_ = 1;
  std::vector<transports::CanFaultRule> faults_;
};

}  // namespace vinv::rig
