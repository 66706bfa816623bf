// An EtherNet/IP adapter: a CIP device on TCP and UDP port 44818 and UDP port 2222. Sans-I/O.
//
// handle_ what arrives, then poll_transmit until empty, then poll_tcp_close until empty, then read next_deadline. Also
// after each handle_ call of the device, whose answers to requests may come later. What happens to I/O connections the
// device is told through its IoPoints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "option_boards/cip/device.hpp"
#include "option_boards/ethernet_ip/connection_manager.hpp"
#include "option_boards/ethernet_ip/encapsulation_server.hpp"

namespace vinv::ethernet_ip {

struct AdapterOptions {
  EncapsulationLimits encapsulation;
  ConnectionOptions connections;
  std::uint64_t seed = 1;  // of identifiers and of the delays of answers to broadcasts
};

class Adapter : private EncapsulationUser {
 public:
  using Address = ConnectionManager::Address;

  // Adds the Connection Manager to the device's router; the device outlives the adapter. Without an address it is deaf.
  Adapter(cip::Device& device, const AdapterOptions& options);
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  // Supply and address are there, or have changed: everything begins anew.
  void start(const Address& address);
  // Supply or link gone: connections and sessions end without a word; TCP connections are to be closed.
  void stop();
  bool is_started() const { return started_; }
  const Address& address() const { return address_; }

  // Empty: refused, to be closed at once.
  std::optional<TcpId> handle_tcp_open(Instant now, const Ipv4Endpoint& peer);
  void handle_tcp(Instant now, TcpId connection, ByteView bytes);
  void handle_tcp_closed(Instant now, TcpId connection);
  void handle_udp(Instant now, const Ipv4Endpoint& from, ByteView datagram, Cast cast = Cast::kUnicast);
  void handle_io(Instant now, const Ipv4Endpoint& from, ByteView datagram);
  void handle_timeout(Instant now);
  // The device's data may have changed.
  void handle_new_data(Instant now) { connections_.handle_new_data(now); }
  // The application asks for a packet of this point now, on connections with that trigger.
  void trigger(Instant now, std::uint32_t point) { connections_.trigger(now, point); }

  std::optional<Instant> next_deadline() const;
  // The next thing to send; its bytes last until the next call of any function.
  std::optional<Transmit> poll_transmit(Instant now);
  std::optional<TcpId> poll_tcp_close() { return encapsulation_.poll_close(); }

  const ConnectionManager& connections() const { return connections_; }
  std::size_t tcp_connections() const { return encapsulation_.connections(); }
  std::size_t sessions() const { return encapsulation_.sessions(); }

 private:
  // A request whose answer the device gives later.
  struct Waiting {
    cip::Ticket ticket = 0;
    ReplyTo to;
    bool connected = false;  // over a class 3 connection, with its slot, identifier and sequence count
    std::uint64_t slot = 0;
    std::uint32_t o2t_id = 0;
    std::uint16_t sequence = 0;
    VINV_ARCHIVE(Waiting, ticket, to, connected, slot, o2t_id, sequence);
  };

  ListedIdentity listed_identity() const override;
  void on_unconnected(Instant now, const ReplyTo& from, const Ipv4Endpoint& peer, const CommonPacket& packet) override;
  void on_connected(Instant now, const ReplyTo& from, const CommonPacket& packet) override;
  void on_tcp_closed(Instant now, TcpId connection) override;

  // The answer is in message_, or comes later under the ticket.
  std::optional<cip::Ticket> dispatch(Instant now, ByteView message, std::size_t reply_limit,
                                      ConnectionManager::Exchange& exchange);
  bool unwrap(ByteView& message);
  void drain_replies();
  void finish(const Waiting& waiting);
  void forget_explicit(std::size_t slot);

  cip::Device& device_;
  EncapsulationServer encapsulation_;
  ConnectionManager connections_;
  bool started_ = false;
  Address address_;
  std::vector<Waiting> waiting_;  // at most MessageRouter::kMaxWaiting
  cip::Reply reply_;              // memory that is kept, as is the next
  Bytes message_;

  friend void archive(Archive& a, Adapter& adapter) {
    a.io(adapter.encapsulation_);
    a.io(adapter.connections_);
    a.io(adapter.started_);
    a.io(adapter.address_);
    a.io(adapter.waiting_);
  }
};

}  // namespace vinv::ethernet_ip
