// What the message router needs of an object class: one that serves all its instances, instance 0 (the class) included.
#pragma once

#include <cstdint>

#include "option_boards/cip/message.hpp"
#include "sim/base/time.hpp"

namespace vinv::cip {

enum class Handled : std::uint8_t {
  kAnswered,  // the reply is complete
  kLater,     // the object keeps request.ticket and answers by MessageRouter::complete
};

class Object {
 public:
  virtual ~Object() = default;
  // reply is clear. path.class_id is one that this object was added for.
  virtual Handled handle(Instant now, const Request& request, Reply& reply) = 0;
};

}  // namespace vinv::cip
