// A Modbus unit (server) as its framings see it: whole PDUs in, whole PDUs out, possibly later.
// MODBUS Application Protocol Specification V1.1b3, section 4.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::modbus {

// Who asked: the serial line, or one TCP connection. Chosen by the caller, unique per unit.
using ClientId = std::uint32_t;

// What a board uses for its own serial line; TCP connections count up from 0.
inline constexpr ClientId kSerialLineClient = 0xffffffff;

enum class Addressing : std::uint8_t { kUnit, kBroadcast };

class Unit {
 public:
  virtual ~Unit() = default;

  // The unit's address now, 1-247; 0 while it does not listen (no supply, no valid address).
  virtual std::uint8_t address() const = 0;
  // Starts a request; a client has at most one outstanding. A broadcast is executed and never answered.
  virtual void handle_request(Instant now, ClientId client, Addressing addressing, ByteView pdu) = 0;
  // The answer PDU for the client's request, once it is due; empty while the inverter has not decided or a delay runs.
  virtual std::optional<Bytes> poll_answer(Instant now, ClientId client) = 0;
  // False once the client's request is answered, or lost because the unit stopped listening meanwhile: no answer will
  // come. A unit that never stops may leave it at true.
  virtual bool has_request(ClientId /*client*/) const { return true; }
  // The client is gone: its request is still executed, its answer dropped.
  virtual void forget(ClientId client) = 0;
};

}  // namespace vinv::modbus
