// The Connection Manager object (class 0x06) and the I/O connections that it opened. CIP Vol 1, 3-4 and 3-5; Vol 2, 3-3
// (sequenced address, socket address items) and 3-4 (class 0 and 1 over UDP).
//
// Services: Forward_Open 0x54, Large_Forward_Open 0x5B, Forward_Close 0x4E, Get_Connection_Data 0x56,
// Search_Connection_Data 0x57, Get_Connection_Owner 0x5A. Unconnected_Send is the adapter's, because its answer is that
// of another request. A target: it opens no connection of its own and routes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "option_boards/cip/device.hpp"
#include "option_boards/ethernet_ip/common_packet.hpp"
#include "option_boards/ethernet_ip/connection.hpp"
#include "option_boards/ethernet_ip/encapsulation.hpp"
#include "sim/base/random.hpp"

namespace vinv::ethernet_ip {

inline constexpr std::uint16_t kConnectionManagerClass = 0x06;
inline constexpr std::uint16_t kMessageRouterClass = 0x02;

enum class ConnectionService : std::uint8_t {
  kForwardClose = 0x4e,
  kForwardOpen = 0x54,
  kGetConnectionData = 0x56,
  kSearchConnectionData = 0x57,
  kGetConnectionOwner = 0x5a,
  kLargeForwardOpen = 0x5b,
};

class ConnectionManager : public cip::Object {
 public:
  static constexpr std::size_t kMaxConnections = 128;  // of all kinds, whatever the options say
  static constexpr std::size_t kMaxIoData = 1400;      // bytes in one packet: it is never fragmented
  // Until the originator's first packet a connection has at least this long (Vol 1, 3-4.5.2).
  static constexpr Duration kLeastFirstTimeout = std::chrono::seconds(10);
  // A cyclic production that is called so many intervals late does not make up for the ones before.
  static constexpr std::int64_t kMaxLateIntervals = 32;

  // Where a request comes from, and the socket addresses that go with it and with its answer (Vol 2, 3-3.9).
  struct Exchange {
    Ipv4Endpoint originator;
    TcpId tcp = 0;
    std::optional<Ipv4Endpoint> t2o_asked;
    std::optional<Ipv4Endpoint> o2t_answer;
    std::optional<Ipv4Endpoint> t2o_answer;
  };
  struct Address {
    std::uint32_t address = 0;
    std::uint32_t netmask = 0;  // 0: by the address's class
    std::uint16_t io_port = kIoPort;
    VINV_ARCHIVE(Address, address, netmask, io_port);
  };

  // The device outlives the manager.
  ConnectionManager(cip::Device& device, const ConnectionOptions& options, std::uint64_t seed);

  void set_address(const Address& address) { state_.address = address; }
  // The exchange that the request comes from, for the time of its handling.
  void set_exchange(Exchange* exchange) { exchange_ = exchange; }
  cip::Handled handle(Instant now, const cip::Request& request, cip::Reply& reply) override;

  // A datagram on the I/O socket.
  void handle_io(Instant now, const Ipv4Endpoint& from, ByteView datagram);
  // Data may have changed: change-of-state productions look.
  void handle_new_data(Instant now);
  // Application trigger: the data of this point is to be sent.
  void trigger(Instant now, std::uint32_t point);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  // The next I/O packet that is due; its bytes last until the next call.
  std::optional<Transmit> poll_transmit(Instant now);

  // Class 3: the connection with this O->T identifier over this TCP connection; nullptr if there is none.
  Connection* find_explicit(std::uint32_t o2t_id, TcpId tcp);
  // A request of a class 3 connection has come.
  void restart(Instant now, Connection& connection);
  // By its slot, for answers that come later; nullptr if it is another one by now.
  Connection* find_slot(std::size_t slot, std::uint32_t o2t_id);
  std::size_t slot_of(const Connection& connection) const;
  // Called for each class 3 connection that ends: nobody waits for its answers.
  void on_explicit_closed(std::function<void(std::size_t slot)> handler) { explicit_closed_ = std::move(handler); }

  void handle_tcp_closed(Instant now, TcpId tcp);
  // Ends everything without a word: reset or loss of supply.
  void close_all();

  std::size_t io_connections() const { return count(false); }
  std::size_t explicit_connections() const { return count(true); }
  // Whether the owner's last packet said run. Empty: there is no owner, or it has not said anything yet.
  std::optional<cip::RunMode> owner_mode() const;

 private:
  struct State {
    explicit State(std::uint64_t seed) : random(seed) {}
    Random random;
    Address address;
    std::uint16_t generation = 0;  // of identifiers
    std::uint16_t incarnation = 0;
    std::vector<Connection> connections;  // by slot
    std::vector<Producer> producers;
    std::optional<Instant> expiry;  // not later than the next one
    VINV_ARCHIVE(State, random, address, generation, incarnation, connections, producers, expiry);
  };
  using Refusal = std::optional<cip::Status>;

  // connection_manager.cpp
  std::size_t count(bool explicit_ones) const;
  Connection* find(const ConnectionTriad& triad);
  std::size_t free_slot();
  std::uint32_t new_identifier(std::size_t slot);
  void forward_close(Instant now, const cip::Request& request, cip::Reply& reply);
  void connection_data(const Connection* connection, cip::Reply& reply) const;
  void get_connection_data(const cip::Request& request, cip::Reply& reply);
  void search_connection_data(const cip::Request& request, cip::Reply& reply);
  void get_connection_owner(const cip::Request& request, cip::Reply& reply);
  void end(Instant now, Connection& connection, cip::IoEvent event);
  void end_listeners(Instant now, std::uint32_t point);
  void wake_by(Instant at);

  // connection_opening.cpp
  void forward_open(Instant now, const cip::Request& request, bool large, cip::Reply& reply);
  void null_forward_open(Instant now, const ForwardOpen& open, const ConnectionPath& path, cip::Reply& reply);
  Refusal open_explicit(Instant now, const ForwardOpen& open, const ConnectionPath& path, Connection& connection);
  Refusal open_io(Instant now, const ForwardOpen& open, const ConnectionPath& path, Connection& connection);
  Refusal check_points(const ForwardOpen& open, const ConnectionPath& path, Connection& connection) const;
  Refusal check_owner(const Connection& connection) const;
  Refusal check_sizes(const ForwardOpen& open, Connection& connection, RealTimeFormat& t2o_format) const;
  Refusal check_configuration(const ConnectionPath& path, const Connection& connection) const;
  Refusal check_join(const Producer& shared, const Producer& wanted, Duration o2t_rpi) const;
  void accept(Instant now, const ForwardOpen& open, Connection&& connection, cip::Reply& reply);
  std::size_t find_multicast(std::uint32_t point) const;
  std::size_t new_producer();
  std::uint32_t free_group() const;

  // connection_io.cpp
  void consume(Instant now, Connection& connection, ByteView data);
  bool is_due(const Producer& producer, Instant now) const;
  Transmit emit(Instant now, Producer& producer);

  cip::Device& device_;
  const ConnectionOptions options_;
  Exchange* exchange_ = nullptr;
  std::function<void(std::size_t)> explicit_closed_;
  std::array<std::uint8_t, kMaxIoData + 64> packet_{};
  State state_;

  friend void archive(Archive& a, ConnectionManager& manager);
};

}  // namespace vinv::ethernet_ip
