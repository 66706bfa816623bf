// Sessions and commands of the encapsulation over TCP and UDP port 44818. CIP Vol 2, 2-2 to 2-5. Sans-I/O.
//
// A session belongs to the TCP connection that registered it: nobody else can use its handle. Knows nothing of CIP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "option_boards/ethernet_ip/common_packet.hpp"
#include "option_boards/ethernet_ip/message_stream.hpp"
#include "option_boards/ethernet_ip/out_queue.hpp"
#include "sim/base/random.hpp"

namespace vinv::ethernet_ip {

enum class Cast : std::uint8_t { kUnicast, kBroadcast };

// Where an answer goes; outlives neither session nor connection: an answer to one that is gone is dropped.
struct ReplyTo {
  TcpId connection = 0;
  std::uint32_t session = 0;
  SenderContext context{};
  VINV_ARCHIVE(ReplyTo, connection, session, context);
};

// What ListIdentity tells (2-4.2.3).
struct ListedIdentity {
  Ipv4Endpoint address;
  std::uint16_t vendor_id = 0;
  std::uint16_t device_type = 0;
  std::uint16_t product_code = 0;
  std::uint8_t major_revision = 0;
  std::uint8_t minor_revision = 0;
  std::uint16_t status = 0;
  std::uint32_t serial_number = 0;
  std::string_view product_name;
  std::uint8_t state = 0;
};

// What the messages carry.
class EncapsulationUser {
 public:
  virtual ~EncapsulationUser() = default;
  virtual ListedIdentity listed_identity() const = 0;
  // SendRRData and SendUnitData of a registered session: the packet has a null or a connected address. Answers by
  // send_unconnected and send_connected, now or later.
  virtual void on_unconnected(Instant now, const ReplyTo& from, const Ipv4Endpoint& peer,
                              const CommonPacket& packet) = 0;
  virtual void on_connected(Instant now, const ReplyTo& from, const CommonPacket& packet) = 0;
  // The connection and its session are gone.
  virtual void on_tcp_closed(Instant now, TcpId connection) = 0;
};

struct EncapsulationLimits {
  // A further connection takes the place of the oldest one without session; if there is none it is refused.
  std::size_t tcp_connections = 128;
  std::size_t sessions = 120;  // one more gets kInsufficientMemory
  // Without a session a connection is closed so long after its beginning.
  Duration registration_timeout = std::chrono::seconds(30);
  // Without a message a session is closed so long after the last (0xF5 attribute 13); zero: never.
  Duration inactivity_timeout{};
};

class EncapsulationServer {
 public:
  // Answers to broadcasts that wait for their random delay; more are not answered.
  static constexpr std::size_t kMaxDelayedAnswers = 32;
  // 2-4.2.2: longest delay if the request names none, and the least that it may name.
  static constexpr Duration kDefaultMaxDelay = std::chrono::milliseconds(2000);
  static constexpr Duration kLeastMaxDelay = std::chrono::milliseconds(500);

  EncapsulationServer(EncapsulationUser& user, const EncapsulationLimits& limits, std::uint64_t seed)
      : user_(user), limits_(limits), state_(seed) {}

  // Empty: refused, to be closed at once.
  std::optional<TcpId> handle_tcp_open(Instant now, const Ipv4Endpoint& peer);
  void handle_tcp(Instant now, TcpId connection, ByteView bytes);
  void handle_tcp_closed(Instant now, TcpId connection);
  void handle_udp(Instant now, const Ipv4Endpoint& from, ByteView datagram, Cast cast);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const { return state_.deadline; }

  std::optional<Transmit> poll_transmit() { return state_.out.poll(); }
  // Connections that the server gives up; after poll_transmit is empty. They are gone for the server already.
  std::optional<TcpId> poll_close();

  // message: a message router reply; items as they are needed.
  void send_unconnected(const ReplyTo& to, ByteView message, const std::optional<Ipv4Endpoint>& o2t_sockaddr,
                        const std::optional<Ipv4Endpoint>& t2o_sockaddr);
  // data: sequence count and message.
  void send_connected(const ReplyTo& to, std::uint32_t connection_id, std::uint16_t sequence, ByteView message);
  // Ends all connections and sessions; on_tcp_closed is not called.
  void close_all();

  // Empty: there is no such connection.
  std::optional<Ipv4Endpoint> peer(TcpId connection) const;
  std::size_t connections() const;
  std::size_t sessions() const;

 private:
  struct Connection {
    TcpId id = 0;  // 0: free
    Ipv4Endpoint peer;
    std::uint32_t session = 0;  // 0: not registered
    Instant opened_at{};
    Instant last_message_at{};
    MessageStream stream;
    VINV_ARCHIVE(Connection, id, peer, session, opened_at, last_message_at, stream);
  };
  struct DelayedAnswer {
    Instant at{};
    Ipv4Endpoint to;
    std::uint16_t command = 0;
    SenderContext context{};
    VINV_ARCHIVE(DelayedAnswer, at, to, command, context);
  };
  struct State {
    explicit State(std::uint64_t seed) : random(seed) {}
    Random random;
    std::uint32_t opened = 0;  // connections so far
    std::vector<Connection> connections;
    std::vector<DelayedAnswer> delayed;
    std::vector<TcpId> to_close;
    OutQueue out;
    std::optional<Instant> deadline;  // not later than the next one: an early call is harmless
    VINV_ARCHIVE(State, random, opened, connections, delayed, to_close, out, deadline);
  };

  Connection* find(TcpId connection);
  std::optional<Instant> deadline_of(const Connection& connection) const;
  void wake_by(std::optional<Instant> at);
  void close(Instant now, Connection& connection);
  void handle_message(Instant now, Connection& connection, const EncapsulationMessage& message);
  void register_session(Connection& connection, const EncapsulationMessage& message);
  EncapsulationStatus send_rr_data(Instant now, Connection& connection, const EncapsulationMessage& message);
  EncapsulationStatus send_unit_data(Instant now, Connection& connection, const EncapsulationMessage& message);
  void answer(const Connection& connection, const EncapsulationHeader& request, EncapsulationStatus status,
              ByteView data = {});
  void answer_list(Channel channel, TcpId connection, const Ipv4Endpoint& to, const EncapsulationHeader& request);

  EncapsulationUser& user_;
  const EncapsulationLimits limits_;
  State state_;
  std::size_t last_found_ = 0;  // of the connections

  friend void archive(Archive& a, EncapsulationServer& server) { a.io(server.state_); }
};

}  // namespace vinv::ethernet_ip
