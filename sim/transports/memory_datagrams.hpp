// A UDP network in memory, over the scheduler: hosts by their addresses, unicast, multicast and broadcast, after a
// fixed delay and in the order of sending, at Priority::kWire. For virtual time; it works under every clock, and its
// state can be saved.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>

#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::transports {

class MemoryDatagrams {
 public:
  // Datagrams under way; more are lost.
  static constexpr std::size_t kMaxUnderWay = 65'536;

  // delay zero: arrives at the instant of sending, after the action that sent it. The scheduler outlives the network,
  // the network its ports.
  MemoryDatagrams(kernel::Scheduler& scheduler, Duration delay) : scheduler_(scheduler), delay_(delay) {}
  ~MemoryDatagrams();
  MemoryDatagrams(const MemoryDatagrams&) = delete;
  MemoryDatagrams& operator=(const MemoryDatagrams&) = delete;

  // Refusal: a sentence, if another port has this address.
  Result<std::unique_ptr<UdpPort>, std::string> open(const Ipv4Endpoint& local);
  // A cable that is pulled: what this host sends and what is sent to it is lost, what is under way to it too.
  void set_link(std::uint32_t address, bool up);

  std::uint64_t delivered() const { return state_.delivered; }
  std::uint64_t lost() const { return state_.lost; }

 private:
  class Port;
  struct Datagram {
    Instant at{};
    Ipv4Endpoint from;
    Ipv4Endpoint to;
    Bytes bytes;
    VINV_ARCHIVE(Datagram, at, from, to, bytes);
  };
  struct State {
    std::deque<Datagram> under_way;
    std::map<std::uint32_t, bool> unplugged;
    std::uint64_t delivered = 0;
    std::uint64_t lost = 0;
    VINV_ARCHIVE(State, under_way, unplugged, delivered, lost);
  };

  void send(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes);
  void deliver(Instant now);
  void schedule_next();
  bool hears(const Port& port, const Ipv4Endpoint& from, const Ipv4Endpoint& to) const;

  kernel::Scheduler& scheduler_;
  const Duration delay_;
  std::map<Ipv4Endpoint, Port*> ports_;
  kernel::EventId event_ = 0;
  State state_;

  // The ports' handlers are their owners' affair.
  friend void archive(Archive& a, MemoryDatagrams& network) {
    a.io(network.state_);
    network.scheduler_.archive_event(a, network.event_, [&network](Instant now) { network.deliver(now); });
  }
};

}  // namespace vinv::transports
