#include "sim/masters/eip_station.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/masters/eip_item.hpp"

namespace vinv::masters {
namespace {

using eip::ItemKind;

// Output 126 and input 176, output 129 and input 179 (FR-A7NE manual, 7.2).
constexpr std::uint8_t kWriteParameter = 0x80, kParameterEnd = 0x80;
constexpr std::size_t kDataOffset = 2, kSelectionOffset = 4, kReadOffset = 4;
constexpr std::uint64_t kFreshPackets = 2;  // one may have been under way when the question was sent

std::uint32_t little_endian(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) value |= std::uint32_t{bytes[at + i]} << 8 * i;
  return value;
}

bool asks(const EipTask& task) {
  using Kind = EipTask::Kind;
  return task.kind == Kind::kOpen || task.kind == Kind::kClose || task.kind == Kind::kRequest;
}

}  // namespace

EipStation::EipStation(kernel::Scheduler& scheduler, const EipStationSettings& settings, Dial dial,
                       std::unique_ptr<transports::UdpPort> io, transports::MemoryStreams* net)
    : Station(scheduler),
      settings_(settings),
      scanner_(settings.scanner),
      dial_(std::move(dial)),
      io_(std::move(io)),
      net_(net),
      runner_(*this) {
  io_->set_handler([this](Instant at, const Ipv4Endpoint&, ByteView bytes) {
    log(at, false, Bytes(bytes.begin(), bytes.end()), kDatagrams);
    if (!silent()) scanner_.handle_io(at, bytes);
    settle(at);
  });
  connect(scheduler.now());
  settle(scheduler.now());
}

EipStation::~EipStation() = default;

void EipStation::connect(Instant now) {
  state_.redial_at.reset();
  stream_ = dial_(now);
  if (stream_ == nullptr) {
    disconnect(now);
    return;
  }
  listen();
  scanner_.handle_connected(now);
}

void EipStation::listen() {
  stream_->set_handlers(
      [this](Instant at, ByteView bytes, bool) {
        log(at, false, Bytes(bytes.begin(), bytes.end()), connection());
        if (!silent()) scanner_.handle_tcp(at, bytes);
        settle(at);
      },
      [this](Instant at, const std::string&) {
        disconnect(at);
        settle(at);
      });
}

void EipStation::disconnect(Instant now) {
  scanner_.handle_disconnected();
  state_.redial_at = now + kRedialDelay;
}

void EipStation::transmit(Instant now, ByteView frame) {
  if (silent() || stream_ == nullptr) return;
  log(now, true, Bytes(frame.begin(), frame.end()), connection());
  stream_->send(now, frame);
}

bool EipStation::send_frame(Instant now, ByteView frame) {
  if (!scanner_.connected() || frame.empty()) return false;
  transmit(now, frame);
  return true;
}

void EipStation::archive(Archive& a) {
  VINV_CHECK(net_ != nullptr);
  Station::archive(a);
  VINV_FIELDS(a, EipStation, scanner_, runner_, state_);
  net_->archive_end(a, stream_);
  runner_.require_client(a, 255, true);
  const bool answers = state_.access.wait != Wait::kNothing || state_.access_result.has_value();
  a.require(runner_.in_access() == answers, "a scanner waits for an answer to nothing");
  a.require(!scanner_.connected() || stream_ != nullptr, "a scanner is connected to nothing");
  if (a.loads() && !a.failed() && stream_ != nullptr) listen();
}

void EipStation::follow_group() {
  const std::uint32_t group = scanner_.multicast_group();
  if (group == state_.group) return;
  if (state_.group != 0) io_->leave(state_.group);
  // A network in memory has room for every group.
  if (group != 0) static_cast<void>(io_->join(group));
  state_.group = group;
}

std::optional<Instant> EipStation::work(Instant now) {
  if (state_.redial_at && now >= *state_.redial_at && !silent()) connect(now);
  for (bool again = true; again;) {
    scanner_.set_producing(now, state_.producing && !silent());
    scanner_.handle_timeout(now);
    take_results(now);
    if (scanner_.close_requested() && scanner_.connected()) {
      stream_->close();
      disconnect(now);
    }
    while (const auto frame = scanner_.poll_tcp(now)) transmit(now, *frame);
    follow_group();
    while (const auto datagram = scanner_.poll_io(now)) {
      log(now, true, *datagram, kDatagrams);
      io_->send(now, settings_.adapter, *datagram);
    }
    const auto step = runner_.step();
    const bool busy = runner_.busy(), in_access = runner_.in_access();
    again = advance_access(now);
    again = advance_task(now) || again;
    runner_.advance(now);
    again = again || busy != runner_.busy() || step != runner_.step() || in_access != runner_.in_access();
  }
  std::optional<Instant> next = scanner_.next_deadline();
  const auto consider = [&](const std::optional<Instant>& at) {
    if (at && (!next || *at < *next)) next = at;
  };
  const auto consider_later = [&](Instant at) {
    if (at > now) consider(at);
  };
  consider(runner_.next_deadline());
  if (!silent()) consider(state_.redial_at);
  const Wait wait = state_.access.wait;
  // What is over waits for something else.
  if (wait == Wait::kPace || wait == Wait::kWritten) consider_later(state_.access.until);
  if (wait == Wait::kPace || wait == Wait::kReopen) consider_later(state_.access.give_up_at);
  if (state_.task) consider_later(state_.task_until);
  return next;
}

void EipStation::take_results(Instant now) {
  while (auto result = scanner_.poll_result()) {
    if (state_.task_ask == result->id) {
      state_.task_ask.reset();
      // Words wait after it; the next request does not.
      if (state_.task->ask.service == kSetAttributeSingle) state_.write_free_at = now + settings_.write_gap;
      task_done(judge(result->answer, state_.task->expected));
      continue;
    }
    Doing& a = state_.access;
    if (a.ask != result->id) continue;
    a.ask.reset();
    if (a.wait == Wait::kOpen) {
      if (result->answer)
        on_open();
      else
        done(Unexpected("the I/O connection was not opened: " + text_of(result->answer.error())));
      continue;
    }
    if (a.write) state_.write_free_at = now + settings_.write_gap;
    if (!result->answer)
      done(Unexpected(text_of(result->answer.error())));
    else
      done(little_endian(*result->answer, 0, std::min<std::size_t>(result->answer->size(), 4)));
  }
}

void EipStation::done(Result<std::uint32_t, std::string> result) {
  state_.access = {};
  state_.access_result = std::move(result);
}

// --- reads and writes of a profile ---

void EipStation::begin_access(Instant now, bool write, Item item, std::uint8_t size, std::uint32_t raw) {
  VINV_CHECK(state_.access.wait == Wait::kNothing);
  state_.access_result.reset();
  Doing& a = state_.access;
  a.write = write;
  a.item = item;
  a.size = size;
  a.raw = raw;
  a.give_up_at = now + kPatience;
  if (eip::kind_of(item) == ItemKind::kAttribute) {
    a.wait = Wait::kPace;
    a.until = write ? std::max(now, state_.write_free_at) : now;
    return;
  }
  if (scanner_.io_open()) return on_open();
  a.wait = Wait::kReopen;
}

void EipStation::on_open() {
  Doing& a = state_.access;
  Bytes& image = scanner_.output();
  const std::uint8_t low = static_cast<std::uint8_t>(a.item);
  switch (eip::kind_of(a.item)) {
    case ItemKind::kConnection: return done(std::uint32_t{0});
    case ItemKind::kInput:
      a.wait = Wait::kInput;
      a.inputs = scanner_.inputs() + 1;
      return;
    case ItemKind::kParameter:
    case ItemKind::kMonitor:
      if (image.size() < settings_.wish.output_size)
        return done(Unexpected(std::string("the I/O connection has no such output data")));
      image[kSelectionOffset] = low;
      if (eip::kind_of(a.item) == ItemKind::kParameter) {
        image[kSelectionOffset] = static_cast<std::uint8_t>(a.item >> 16);
        image[kSelectionOffset + 1] = low;
        image[1] = static_cast<std::uint8_t>(a.item >> 8);
        if (a.write) {
          image[0] |= kWriteParameter;
          state_.kept_data = read_le16(image, kDataOffset);
          image[kDataOffset] = static_cast<std::uint8_t>(a.raw);
          image[kDataOffset + 1] = static_cast<std::uint8_t>(a.raw >> 8);
        }
      }
      [[fallthrough]];
    case ItemKind::kProduction:
      send_image();
      a.wait = Wait::kSent;
      return;
    case ItemKind::kAttribute: break;
  }
}

void EipStation::on_sent(Instant now) {
  Doing& a = state_.access;
  switch (eip::kind_of(a.item)) {
    case ItemKind::kProduction: return done(std::uint32_t{0});
    case ItemKind::kParameter:
      if (a.write) {
        a.wait = Wait::kWritten;
        a.until = now + kParameterTime;
        return;
      }
      [[fallthrough]];
    default:
      a.wait = Wait::kInput;
      a.inputs = scanner_.inputs() + kFreshPackets;
      return;
  }
}

void EipStation::on_input() {
  Doing& a = state_.access;
  const Bytes& input = scanner_.input();
  if (eip::kind_of(a.item) == ItemKind::kInput) return done(little_endian(input, a.item & 0xff, a.size));
  const std::uint32_t value = little_endian(input, kReadOffset, 2);
  if (a.write && value != a.raw) {
    char text[64];
    std::snprintf(text, sizeof text, "not taken over: it reads back as %u", value);
    return done(Unexpected(std::string(text)));
  }
  done(value);
}

void EipStation::ask(Instant now) {
  Doing& a = state_.access;
  CipAsk ask;
  ask.service = a.write ? kSetAttributeSingle : kGetAttributeSingle;
  ask.path = object_path(a.item >> 16 & 0xff, a.item >> 8 & 0xff, a.item & 0xff);
  ask.connected = settings_.connected;
  if (a.write)
    for (std::size_t i = 0; i < a.size; ++i) ask.data.push_back(static_cast<std::uint8_t>(a.raw >> 8 * i));
  a.wait = Wait::kAnswer;
  a.ask = scanner_.submit(now, std::move(ask));
  if (!a.ask) done(Unexpected(std::string("too many requests wait for this master")));
}

bool EipStation::advance_access(Instant now) {
  Doing& a = state_.access;
  switch (a.wait) {
    case Wait::kNothing:
    case Wait::kAnswer:
    case Wait::kOpen: return false;
    case Wait::kPace:
      if (now < a.until || (!scanner_.connected() && now < a.give_up_at)) return false;
      ask(now);
      return true;
    case Wait::kReopen:
      if (scanner_.io_open()) {
        on_open();
      } else if (now >= a.give_up_at) {
        done(Unexpected(std::string(scanner_.connected() ? "the I/O connection is lost" : "no connection")));
      } else if (scanner_.connected() && !scanner_.io_wanted()) {
        a.wait = Wait::kOpen;
        a.ask = scanner_.open_io(now, settings_.wish);
        if (!a.ask) done(Unexpected(std::string("too many requests wait for this master")));
      } else {
        return false;
      }
      return true;
    default: break;
  }
  if (!scanner_.io_open()) {
    done(Unexpected(std::string("the I/O connection is lost")));
    return true;
  }
  if (a.wait == Wait::kSent) {
    if (scanner_.sent_version() < a.version) return false;
    on_sent(now);
    return true;
  }
  if (a.wait == Wait::kWritten) {
    const Bytes& input = scanner_.input();
    if (now < a.until || input.size() < 2 || (input[1] & kParameterEnd) != 0) return false;
    Bytes& image = scanner_.output();
    image[0] &= static_cast<std::uint8_t>(~kWriteParameter);
    image[kDataOffset] = static_cast<std::uint8_t>(state_.kept_data);
    image[kDataOffset + 1] = static_cast<std::uint8_t>(state_.kept_data >> 8);
    static_cast<void>(scanner_.changed());
    a.wait = Wait::kInput;
    a.inputs = scanner_.inputs() + kFreshPackets;
    return true;
  }
  if (scanner_.inputs() < a.inputs) return false;
  on_input();
  return true;
}

void EipStation::begin_write(Instant now, std::uint8_t, Item item, std::uint8_t size, std::uint32_t raw) {
  begin_access(now, true, item, size, raw);
}
void EipStation::begin_read(Instant now, std::uint8_t, Item item, std::uint8_t size) {
  begin_access(now, false, item, size, 0);
}
std::optional<Result<std::uint32_t, std::string>> EipStation::poll_access() {
  return std::exchange(state_.access_result, std::nullopt);
}

// Beyond the image there is nothing: an input only connection has none.
void EipStation::set_output(std::uint8_t, Item item, std::uint8_t size, std::uint32_t raw) {
  Bytes& image = scanner_.output();
  const std::size_t offset = item & 0xff;
  const std::uint32_t mask = item >> 8 & 0xff;
  if (offset + size > image.size()) return;
  if (mask != 0) {
    image[offset] = static_cast<std::uint8_t>((image[offset] & ~mask) | (raw & mask));
    return;
  }
  for (std::size_t i = 0; i < size; ++i) image[offset + i] = static_cast<std::uint8_t>(raw >> 8 * i);
}

// Profiles over EtherNet/IP have no steps of these kinds.
void EipStation::send_output(Instant, std::uint8_t, Item) { VINV_CHECK(false); }
void EipStation::command(Instant, std::uint8_t, std::uint32_t) { VINV_CHECK(false); }

std::string EipStation::name_of(Item item) const {
  char text[48];
  const unsigned class_id = item >> 16 & 0xff, instance = item >> 8 & 0xff, number = item & 0xff;
  switch (eip::kind_of(item)) {
    case ItemKind::kInput: std::snprintf(text, sizeof text, "input byte %u", number); break;
    case ItemKind::kMonitor: std::snprintf(text, sizeof text, "monitor %02XH", number); break;
    case ItemKind::kConnection:
    case ItemKind::kProduction: return "I/O";
    default: std::snprintf(text, sizeof text, "attribute 0x%02X/%u/%u", class_id, instance, number);
  }
  return text;
}

// --- tasks ---

void EipStation::begin_task(Instant now, const EipTask& task) {
  using Kind = EipTask::Kind;
  state_.task = task;
  state_.task_outcome.reset();
  state_.task_ask.reset();
  state_.task_until = now + (asks(task) ? kPatience : task.within);
  switch (task.kind) {
    case Kind::kOpen:
      if (scanner_.io_open()) task_done(Unexpected(std::string("the I/O connection is open; close it first")));
      break;
    case Kind::kClose:
    case Kind::kRequest: break;
    case Kind::kProducing:
      state_.producing = task.on;
      task_done(std::string());
      break;
    case Kind::kDrop:
      if (stream_ != nullptr) stream_->close();
      disconnect(now);
      task_done(std::string());
      break;
    case Kind::kIdle:
      scanner_.set_run(!task.on);
      if (!scanner_.io_open()) task_done(std::string());
      break;
    case Kind::kOutput:
      if (!scanner_.io_open()) {
        task_done(Unexpected(std::string("no I/O connection is open")));
      } else if (scanner_.output().size() != task.bytes.size()) {
        task_done(Unexpected("the output data of this connection has " + std::to_string(scanner_.output().size()) +
                             " bytes"));
      } else {
        scanner_.output() = task.bytes;
      }
      break;
    case Kind::kInput: break;
  }
  state_.task_version = scanner_.changed();
  settle(now);
}

void EipStation::task_done(TaskOutcome outcome) {
  state_.task.reset();
  state_.task_outcome = std::move(outcome);
}

std::optional<TaskOutcome> EipStation::poll_task() { return std::exchange(state_.task_outcome, std::nullopt); }

bool EipStation::advance_task(Instant now) {
  using Kind = EipTask::Kind;
  if (!state_.task) return false;
  const EipTask& task = *state_.task;
  if (task.kind == Kind::kIdle || task.kind == Kind::kOutput) {
    const bool lost = !scanner_.io_open();
    if (!lost && scanner_.sent_version() < state_.task_version) return false;
    if (lost)
      task_done(Unexpected(std::string("the I/O connection is lost")));
    else
      task_done(std::string());
    return true;
  }
  if (task.kind == Kind::kInput) {
    const Bytes& input = scanner_.input();
    const bool fits = matches(input, task.bytes, task.mask);
    if (!fits && now < state_.task_until) return false;
    const std::string seen = input.empty() ? "nothing" : hex_text(input);
    if (fits)
      task_done(seen);
    else
      task_done(Unexpected("the input data is " + seen + ", not " + hex_text(task.bytes) +
                           (task.mask.empty() ? "" : " in the bits " + hex_text(task.mask))));
    return true;
  }
  if (state_.task_ask || (!scanner_.connected() && now < state_.task_until)) return false;
  state_.task_ask = task.kind == Kind::kOpen    ? scanner_.open_io(now, task.wish)
                    : task.kind == Kind::kClose ? scanner_.close_io(now)
                                                : scanner_.submit(now, task.ask);
  if (!state_.task_ask) task_done(Unexpected(std::string("too many requests wait for this master")));
  return true;
}

}  // namespace vinv::masters
