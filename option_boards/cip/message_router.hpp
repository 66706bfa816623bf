// The message router: finds the object class that a request names. CIP Vol 1, 5-3 (class 0x02).
//
// A service answers at once or later: a parameter clear takes seconds. What answers later gets a ticket; its reply is
// polled. Whoever asked and is gone forgets the ticket; the service is still carried out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "option_boards/cip/message.hpp"
#include "option_boards/cip/object.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::cip {

struct DeferredReply {
  Ticket ticket = 0;
  std::uint8_t service = 0;  // of the request, without the reply bit
  Reply reply;
  VINV_ARCHIVE(DeferredReply, ticket, service, reply);
};

class MessageRouter {
 public:
  // Requests that may wait for their answer; one more is refused with kResourceUnavailable before any object sees it.
  static constexpr std::size_t kMaxWaiting = 64;

  // Serves the classes first to last; ranges do not overlap. The object outlives the router.
  void add(std::uint16_t first_class, std::uint16_t last_class, Object& object);
  void add(std::uint16_t class_id, Object& object) { add(class_id, class_id, object); }
  // In order of their numbers; of a range each class.
  std::vector<std::uint16_t> classes() const;

  // Empty: reply is the answer (kPathDestinationUnknown for a class that nobody serves, kReplyDataTooLarge for data
  // beyond the limit). A ticket: the answer comes by poll_reply, reply is clear.
  std::optional<Ticket> handle(Instant now, Request request, Reply& reply);

  // For objects: answers what was taken with Handled::kLater. Unknown and forgotten tickets are ignored.
  void complete(Ticket ticket, Reply reply);
  // True while somebody waits for this answer.
  bool awaits(Ticket ticket) const;
  // For engines: nobody waits any more.
  void forget(Ticket ticket);
  // Everybody who waits is forgotten: the device restarts.
  void forget_all();
  // For engines: call until empty after each handle_ of the device.
  std::optional<DeferredReply> poll_reply();

 private:
  struct Entry {
    std::uint16_t first = 0, last = 0;
    Object* object = nullptr;
  };
  struct Waiting {
    Ticket ticket = 0;
    std::uint8_t service = 0;
    std::uint64_t reply_limit = 0;
    VINV_ARCHIVE(Waiting, ticket, service, reply_limit);
  };
  struct State {
    Ticket last_ticket = 0;
    std::vector<Waiting> waiting;
    std::deque<DeferredReply> finished;
    VINV_ARCHIVE(State, last_ticket, waiting, finished);
  };
  Object* find(std::uint16_t class_id) const;

  std::vector<Entry> entries_;  // in order of their classes
  State state_;

  friend void archive(Archive& a, MessageRouter& router) { a.io(router.state_); }
};

}  // namespace vinv::cip
