// A CAN bus in this process: arbitration, frame times, error signalling and fault confinement as ISO 11898-1 has them,
// for any number of nodes. It runs on a scheduler, so in virtual, real and granted time alike, and it is deterministic.
//
// What is modelled, in bit times of the bus:
// - Nodes that have a frame when the bus becomes free, and those that get one within the first bit of a frame,
// arbitrate.
// - A frame takes its exactly stuffed bits and 10 more; 3 bits of intermission follow; a node hears it at its last bit
//   if it was on the bus from the start. Nodes that send the same frame at once send it together.
// - An error takes the bits up to it, a flag of 6 bits (12 if other nodes add theirs) and a delimiter of 8; the frame
// is
//   sent again. Receivers count 1, transmitters 8.
// - An error-passive node waits 8 bits more between its frames. Bus off ends after 128 times 11 recessive bits.
// - A node whose frame nobody acknowledges sends it again for ever; it becomes error passive and not bus off. What
// waits
//   on an unattended bus is therefore sent when the first other node comes.
// - A node with another bit rate than the bus hears nothing. While it is error active its error flags destroy what
// others
//   send, which ends after 15 frames when it is error passive; what it sends is destroyed until it is bus off.
//   Unspecified: where such a frame breaks depends on the phase of both nodes; we take kGarbledBits.
// A node that is destroyed or switched off while it sends completes its frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "sim/kernel/scheduler.hpp"
#include "sim/transports/can/can_bus_state.hpp"

namespace vinv::transports {

struct CanBusOptions {
  std::string name = "can0";
  std::uint32_t bitrate = 125'000;  // one of kCanBitrates
  // kNone: frames take no time and need no acknowledgement, and bit rates do not matter. For measuring what is around
  // the bus, and for buses that others time.
  enum class Timing : std::uint8_t { kExact, kNone } timing = Timing::kExact;
};

struct CanBusStats {
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;  // destroyed attempts, those without acknowledge too
  std::uint64_t arbitrations_lost = 0;
  std::uint64_t faults_injected = 0;  // by all plans so far
  std::size_t nodes = 0;
  CanLoad load;
};

// Sees what passes, for recorders and checks. Called before the nodes.
class CanBusObserver {
 public:
  virtual ~CanBusObserver() = default;
  // At the end of the last bit; sender names the node (the first, if several sent it together).
  virtual void on_frame(Instant now, const CanFrame& frame, std::string_view sender) = 0;
  // sender is empty if nobody was sending.
  virtual void on_error_frame(Instant, CanErrorCause, std::string_view /*sender*/) {}
  virtual void on_node_state(Instant, std::string_view /*node*/, const CanStatus&) {}
};

class CanNode;
struct CanNodeState;

class CanBus {
 public:
  // Bits after which a frame of another bit rate is taken to break.
  static constexpr unsigned kGarbledBits = 20;
  static constexpr int kRecoverySequences = 128;
  static constexpr unsigned kRecoveryBits = 11;

  // The scheduler outlives the bus. Nodes may outlive it; they are offline then.
  CanBus(kernel::Scheduler& scheduler, CanBusOptions options);
  ~CanBus();
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;

  std::unique_ptr<CanNode> attach(Instant now, CanNodeOptions options);
  void observe(std::shared_ptr<CanBusObserver> observer);
  void stop_observing(const CanBusObserver* observer);
  // From the next frame that a node sends; replaces the plan before it.
  void set_faults(CanFaultPlan plan);
  // Other luck for the faults from here on.
  void reseed(std::uint64_t seed);
  // Behind the rules of the plan there is.
  void add_fault(CanFaultRule rule);
  // Somebody signals an error now: it destroys the frame on the wire, or is one of its own on a free bus.
  void inject_error_frame(Instant now);

  const CanBusOptions& options() const;
  kernel::Scheduler& scheduler() const;
  CanBusStats stats(Instant now) const;

  // As a part of a plant's snapshot: nodes, wire and pending events, these at their places in the order. The bus that
  // loads has the name, bit rate and nodes of the one that was saved, in any order. Handlers and observers stay, and
  // are told nothing. Not from within one of them.
  friend void archive(Archive& a, CanBus& bus) { bus.archive_state(a); }

 private:
  friend class CanNode;
  void archive_state(Archive& a);
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

class CanNode : public CanPort {
 public:
  ~CanNode() override;
  CanNode(const CanNode&) = delete;
  CanNode& operator=(const CanNode&) = delete;

  void set_handlers(CanHandlers handlers) override;
  CanSend send(Instant now, const CanFrame& frame) override;
  std::size_t queue_room() const override;
  void clear_queue() override;
  void set_online(Instant now, bool online) override;
  // Any rate above 0; sets the controller up anew: counters zero, queue empty.
  Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) override;
  CanStatus status() const override;
  std::string name() const override;

  // As set_bitrate(): the controller is set up anew.
  void set_listen_only(Instant now, bool listen_only);
  // A person shorts the bus at this node's controller: it goes bus off.
  void force_bus_off(Instant now);
  // Starts the way back from bus off, for nodes that do not do so themselves.
  void recover(Instant now);

 private:
  friend class CanBus;
  CanNode(std::shared_ptr<CanBus::Impl> bus, std::shared_ptr<CanNodeState> state);
  std::shared_ptr<CanBus::Impl> bus_;
  std::shared_ptr<CanNodeState> state_;
};

}  // namespace vinv::transports
