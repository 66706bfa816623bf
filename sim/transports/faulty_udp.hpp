// Faults on datagrams: a port around a port that drops, delays, duplicates, corrupts, truncates or reorders what
// passes. The same plan and the same traffic give the same faults. A delayed datagram is overtaken by those behind it.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>

#include "sim/transports/fault_injector.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::transports {

class FaultyUdp : public UdpPort {
 public:
  // Datagrams that wait in it; more are lost.
  static constexpr std::size_t kMaxDelayed = 4096;

  // The scheduler outlives the port. Rules for streams only (kSplit, kGarble) do nothing here.
  FaultyUdp(kernel::Scheduler& scheduler, std::unique_ptr<UdpPort> inner, std::shared_ptr<FaultCourse> course);
  ~FaultyUdp() override;
  FaultyUdp(const FaultyUdp&) = delete;
  FaultyUdp& operator=(const FaultyUdp&) = delete;

  void set_handler(OnDatagram on_datagram) override;
  void send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp = 0) override;
  Result<void, std::string> join(std::uint32_t group) override { return inner_->join(group); }
  void leave(std::uint32_t group) override { inner_->leave(group); }
  Ipv4Endpoint local() const override { return inner_->local(); }

  // What waits in it; course and port inside are their owners'.
  friend void archive(Archive& a, FaultyUdp& port) { port.archive_state(a); }

 private:
  struct Datagram {
    Direction direction = Direction::kSend;
    Ipv4Endpoint peer;
    std::uint8_t dscp = 0;
    Bytes bytes;
    VINV_ARCHIVE(Datagram, direction, peer, dscp, bytes);
  };
  struct Late {
    std::uint64_t number = 0;
    kernel::EventId event = 0;
    bool overtaken = false;  // goes behind the next one of its direction, if that comes before its time
    Datagram datagram;
  };

  void pass(Instant now, Direction direction, const Ipv4Endpoint& peer, ByteView bytes, std::uint8_t dscp);
  void post(Instant at, Datagram datagram, bool overtaken);
  void release_overtaken(Instant now, Direction direction, std::uint64_t before);
  void run_late(Instant now, std::uint64_t number);
  void deliver(Instant now, Direction direction, const Ipv4Endpoint& peer, ByteView bytes, std::uint8_t dscp);
  kernel::Scheduler::Action late_action(std::uint64_t number);
  void archive_state(Archive& a);

  kernel::Scheduler& scheduler_;
  std::unique_ptr<UdpPort> inner_;
  std::shared_ptr<FaultCourse> course_;
  OnDatagram handler_;
  std::deque<Late> late_;  // in the order of their numbers
  std::uint64_t next_late_ = 0;
};

}  // namespace vinv::transports
