// A CIP device as the engine of its network sees it: explicit messages, I/O, identity.
//
// The engine adds the objects of its network (Connection Manager, DeviceNet object) to the router, hands requests to
// it, drains its deferred replies after each handle_ call of board or engine, and moves I/O data through io().
#pragma once

#include <cstdint>

#include "option_boards/cip/identity.hpp"
#include "option_boards/cip/io_points.hpp"
#include "option_boards/cip/message_router.hpp"

namespace vinv::cip {

class Device {
 public:
  virtual ~Device() = default;

  virtual MessageRouter& router() = 0;
  virtual IoPoints& io() = 0;
  virtual const Identity& identity() const = 0;
  // Attribute 5 of the Identity object, and the same device's State.
  virtual std::uint16_t identity_status() const = 0;
  virtual IdentityState identity_state() const = 0;
  // A connection for explicit messages (class 3). I/O connections are told to io().
  virtual void on_explicit_connection(Instant /*now*/, IoEvent /*event*/) {}
};

}  // namespace vinv::cip
