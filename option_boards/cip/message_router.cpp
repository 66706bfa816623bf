#include "option_boards/cip/message_router.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::cip {
namespace {

void limit(Reply& reply, std::uint64_t bytes) {
  if (reply.data.size() > bytes) reply.refuse(GeneralStatus::kReplyDataTooLarge);
}

}  // namespace

void MessageRouter::add(std::uint16_t first_class, std::uint16_t last_class, Object& object) {
  VINV_CHECK(first_class <= last_class);
  const auto after =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.last >= first_class; });
  VINV_CHECK(after == entries_.end() || after->first > last_class);
  entries_.insert(after, Entry{first_class, last_class, &object});
}

Object* MessageRouter::find(std::uint16_t class_id) const {
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), class_id, [](const Entry& e, auto id) { return e.last < id; });
  return found != entries_.end() && found->first <= class_id ? found->object : nullptr;
}

std::vector<std::uint16_t> MessageRouter::classes() const {
  std::vector<std::uint16_t> all;
  for (const Entry& e : entries_) {
    for (unsigned id = e.first; id <= e.last; ++id) all.push_back(static_cast<std::uint16_t>(id));
  }
  return all;
}

std::optional<Ticket> MessageRouter::handle(Instant now, Request request, Reply& reply) {
  reply.clear();
  Object* const object = find(request.path.class_id);
  if (object == nullptr) {
    reply.refuse(GeneralStatus::kPathDestinationUnknown);
    return std::nullopt;
  }
  if (state_.waiting.size() + state_.finished.size() >= kMaxWaiting) {
    reply.refuse(GeneralStatus::kResourceUnavailable);
    return std::nullopt;
  }
  if (++state_.last_ticket == 0) ++state_.last_ticket;
  request.ticket = state_.last_ticket;
  // Before the object sees it, so that complete() may come from within.
  state_.waiting.push_back({request.ticket, request.service, request.reply_limit});
  if (object->handle(now, request, reply) == Handled::kLater) {
    reply.clear();
    return request.ticket;
  }
  if (!state_.waiting.empty() && state_.waiting.back().ticket == request.ticket && state_.finished.empty()) {
    state_.waiting.pop_back();
  } else {
    forget(request.ticket);
  }
  limit(reply, request.reply_limit);
  return std::nullopt;
}

void MessageRouter::complete(Ticket ticket, Reply reply) {
  const auto found =
      std::find_if(state_.waiting.begin(), state_.waiting.end(), [&](const Waiting& w) { return w.ticket == ticket; });
  if (found == state_.waiting.end()) return;
  limit(reply, found->reply_limit);
  state_.finished.push_back({ticket, found->service, std::move(reply)});
  state_.waiting.erase(found);
}

bool MessageRouter::awaits(Ticket ticket) const {
  return std::any_of(state_.waiting.begin(), state_.waiting.end(),
                     [&](const Waiting& w) { return w.ticket == ticket; });
}

void MessageRouter::forget(Ticket ticket) {
  std::erase_if(state_.waiting, [&](const Waiting& w) { return w.ticket == ticket; });
  std::erase_if(state_.finished, [&](const DeferredReply& d) { return d.ticket == ticket; });
}

void MessageRouter::forget_all() {
  state_.waiting.clear();
  state_.finished.clear();
}

std::optional<DeferredReply> MessageRouter::poll_reply() {
  if (state_.finished.empty()) return std::nullopt;
  DeferredReply reply = std::move(state_.finished.front());
  state_.finished.pop_front();
  return reply;
}

}  // namespace vinv::cip
