#include "sim/transports/ready_set.hpp"

#include <sys/epoll.h>
#include <sys/timerfd.h>

#include <ctime>

#include "sim/base/check.hpp"

namespace vinv::transports {

namespace {

constexpr std::uint64_t kTimer = 0;  // no place has this id

}  // namespace

ReadySet::ReadySet()
    : epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)),
      found_(kBatch) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = kTimer;
  VINV_CHECK(epoll_.is_open() && timer_.is_open());
  VINV_CHECK(::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, timer_.get(), &event) == 0);
}
ReadySet::~ReadySet() = default;

ReadySet::Id ReadySet::add(int fd, std::uint32_t events, ReadyHandler& handler) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(places_.size()));
    places_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  places_[index].handler = &handler;
  const Id id = std::uint64_t{places_[index].generation} << 32 | index;
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  VINV_CHECK(::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event) == 0);
  return id;
}

void ReadySet::change(Id id, int fd, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, fd, &event);
}

void ReadySet::remove(Id id, int fd) {
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, fd, nullptr);
  const auto index = static_cast<std::uint32_t>(id);
  places_[index].handler = nullptr;
  // What an earlier wait found for this place means nobody any more.
  if (++places_[index].generation != 0) free_.push_back(index);
}

// It stays readable until it is set anew, as it is before each sleep.
void ReadySet::arm(std::chrono::steady_clock::time_point at) {
  if (armed_for_ && *armed_for_ <= at) return;
  armed_for_ = at;
  const auto since = at.time_since_epoch();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since);
  itimerspec setting{};
  setting.it_value.tv_sec = seconds.count();
  setting.it_value.tv_nsec = (since - seconds).count();
  ::timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &setting, nullptr);
}

void ReadySet::rest() {
  const itimerspec off{};
  ::timerfd_settime(timer_.get(), 0, &off, nullptr);
  armed_for_.reset();
}

void ReadySet::wait(std::optional<std::chrono::steady_clock::time_point> until) {
  if (until) arm(*until);
  next_ = count_ = 0;
  const int count = ::epoll_wait(epoll_.get(), found_.data(), static_cast<int>(kBatch), until ? -1 : 0);
  if (count > 0) count_ = static_cast<std::size_t>(count);
}

bool ReadySet::serve_one() {
  while (next_ < count_) {
    const epoll_event& event = found_[next_++];
    const std::uint64_t id = event.data.u64;
    if (id == kTimer) {
      armed_for_.reset();
      continue;
    }
    const Place& place = places_[static_cast<std::uint32_t>(id)];
    if (place.handler == nullptr || place.generation != id >> 32) continue;
    place.handler->on_ready(event.events);
    return true;
  }
  return false;
}

}  // namespace vinv::transports
