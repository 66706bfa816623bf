#include "sim/masters/station.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {

Station::~Station() {
  if (wake_event_ != 0) scheduler_.cancel(wake_event_);
}

void Station::begin(Instant now, const BoardProfile& profile, const Order& order) {
  runner().begin(now, profile, order);
  settle(now);
}

std::vector<Bytes> Station::take_frames() { return std::exchange(frames_, {}); }

void Station::set_silent(Instant now, bool silent) {
  silent_ = silent;
  settle(now);
}

void Station::log(Instant now, bool sent, Bytes bytes, std::uint32_t connection) {
  if (on_wire_) on_wire_({now, sent, bytes, connection});
  if (sent || silent_) return;
  if (frames_.size() >= kMaxFrames) frames_.erase(frames_.begin());
  frames_.push_back(std::move(bytes));
}

void Station::settle(Instant now) {
  if (settling_) return;
  settling_ = true;
  const std::optional<Instant> next = work(now);
  settling_ = false;
  if (next == wake_at_) return;
  if (wake_event_ != 0) scheduler_.cancel(wake_event_);
  wake_at_ = next;
  wake_event_ = 0;
  if (!next) return;
  wake_event_ =
      scheduler_.schedule(std::max(*next, scheduler_.now()), kernel::Priority::kWire, [this](Instant at) { wake(at); });
}

void Station::wake(Instant now) {
  wake_event_ = 0;
  wake_at_.reset();
  settle(now);
}

void Station::archive(Archive& a) {
  VINV_MEMBERS(*this, scheduler, wake_event, wake_at, settling, silent, frames, on_wire);
  VINV_CHECK(!settling);
  VINV_FIELDS(a, Station, wake_at, silent, frames);
  scheduler.archive_event(a, wake_event, [this](Instant at) { wake(at); });
  a.require(wake_at.has_value() == (wake_event != 0), "a master waits and never wakes");
}

}  // namespace vinv::masters
