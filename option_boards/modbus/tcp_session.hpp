// One Modbus/TCP connection: MBAP framing, queue of pipelined requests, answers in order.
// MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3 (MBAP header), 4.4.1 (server).
//
// Sans-I/O: bytes in as they come, whole ADUs out. The owner drains poll_transmit after handle_bytes, and after each
// tick of the drives while awaiting_answer(). A header that cannot be Modbus/TCP makes the session ask to be closed:
// there is no way to find the next header in the stream.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "option_boards/modbus/pdu.hpp"
#include "option_boards/modbus/unit_table.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::modbus {

class TcpSession {
 public:
  // Requests of one connection that wait or are worked on. A further one is refused with 06 at once, ahead of the
  // answers still due (guide, 4.4.1.3: server busy).
  static constexpr std::size_t kMaxQueuedRequests = 16;
  // Refusals not yet fetched; a peer that grows more is a flood and gets disconnected.
  static constexpr std::size_t kMaxQueuedRefusals = 1024;
  static constexpr std::size_t kMbapLength = 7;
  static constexpr std::size_t kMaxAdu = kMbapLength + kMaxPdu;

  // client is unique among the connections to the routed units. The router and its units outlive the session.
  TcpSession(ClientId client, UnitRouter& router) : client_(client), router_(router) {}
  ~TcpSession() { handle_closed(); }
  TcpSession(const TcpSession&) = delete;
  TcpSession& operator=(const TcpSession&) = delete;

  void handle_bytes(Instant now, ByteView bytes);
  // The next whole ADU to send; call until empty.
  std::optional<Bytes> poll_transmit(Instant now);
  // Some request has not been answered: poll again after the drives' next tick.
  bool awaiting_answer() const { return !requests_.empty(); }
  // Why the connection has to be closed; empty if it may stay. Answers to what came before may be sent first.
  std::optional<std::string_view> close_requested() const { return close_reason_; }
  // The connection is gone: what the unit works on is still executed, what waits is dropped.
  void handle_closed();

  // Snapshots: after the units; the client and the router are there.
  friend void archive(Archive& a, TcpSession& session) { session.archive_state(a); }

 private:
  struct QueuedRequest {
    std::uint16_t transaction_id = 0;
    std::uint8_t unit_id = 0;
    Unit* unit = nullptr;  // set once the unit works on it
    Bytes pdu;
  };

  void archive_state(Archive& a);
  void take_adu();
  bool header_is_modbus();

  ClientId client_;
  UnitRouter& router_;
  std::array<std::uint8_t, kMaxAdu> buffer_{};  // the ADU being received
  std::size_t received_ = 0;
  std::deque<QueuedRequest> requests_;  // front: the one being worked on
  std::deque<Bytes> refusals_;
  std::optional<std::string> close_reason_;
};

}  // namespace vinv::modbus
