#include "sim/masters/eip_scanner.hpp"

#include <algorithm>
#include <utility>

#include "option_boards/cip/message.hpp"
#include "option_boards/ethernet_ip/common_packet.hpp"
#include "option_boards/ethernet_ip/connection_manager.hpp"

namespace vinv::masters {
namespace {

using ethernet_ip::Command;
using ethernet_ip::ConnectionService;
using ethernet_ip::ItemType;

constexpr std::uint16_t kSequenceCount = 2, kRunIdleHeader = 4;
constexpr std::uint8_t kPriorityTick = 0x07, kTimeoutTicks = 0xe9;  // about 30 s
constexpr std::uint16_t kMostSize = 0x1ff;                          // of a Forward_Open that is not large
constexpr std::uint16_t kExplicitSize = 504;

std::uint32_t microseconds(Duration d) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count());
}
Duration timeout_of(Duration interval, std::uint8_t multiplier) {
  return interval * (4 << std::min(multiplier, std::uint8_t{7}));
}

// Type (2 point to point, 1 multicast), low priority, fixed size.
void append_parameters(Bytes& out, bool large, bool multicast, std::uint16_t size) {
  const std::uint16_t flags = multicast ? 0x2000 : 0x4000;
  if (large) {
    append_le16(out, size);
    append_le16(out, flags);
  } else {
    append_le16(out, static_cast<std::uint16_t>(flags | (size & kMostSize)));
  }
}

Bytes manager_path() { return object_path(ethernet_ip::kConnectionManagerClass, 1, 0); }

}  // namespace

void EipScanner::handle_connected(Instant) {
  handle_disconnected();
  state_.link = Link::kRegister;
}

void EipScanner::handle_disconnected() {
  State& s = state_;
  s.link = Link::kDown;
  s.close_requested = false;
  s.session = 0;
  s.stream = {};
  s.answer_by.reset();
  s.class3_open = false;
  if (s.current) s.queue.push_front(*std::exchange(s.current, std::nullopt));
  while (!s.queue.empty()) {
    const Waiting lost = std::move(s.queue.front());
    s.queue.pop_front();
    if (lost.purpose == Purpose::kOpenIo || lost.purpose == Purpose::kReopenIo) s.io = Io::kLost;
    if (lost.purpose == Purpose::kCloseIo) s.io = Io::kClosed;
    if (lost.purpose != Purpose::kReopenIo && lost.purpose != Purpose::kOpenClass3)
      report(lost.id, Unexpected(CipFailure{}));
  }
}

std::optional<CipAskId> EipScanner::queue(CipAsk ask, Purpose purpose) {
  if (state_.queue.size() >= kMaxWaiting) return std::nullopt;
  const CipAskId id = state_.next_id++;
  if (state_.link == Link::kDown) {
    report(id, Unexpected(CipFailure{}));
    return id;
  }
  state_.queue.push_back({id, purpose, std::move(ask)});
  return id;
}

std::optional<CipAskId> EipScanner::submit(Instant, CipAsk ask) { return queue(std::move(ask), Purpose::kUser); }

std::optional<CipAskId> EipScanner::open_io(Instant, const IoWish& wish) {
  State& s = state_;
  s.wish = wish;
  s.wanted = true;
  s.output.resize(wish.output_size);
  s.io = s.link == Link::kDown ? Io::kLost : Io::kOpening;
  s.reopen_at.reset();
  s.serial = s.next_serial++;
  s.t2o_id = settings_.originator_serial << 16 | s.serial;
  return queue(forward_open(wish, s.serial, s.t2o_id), Purpose::kOpenIo);
}

std::optional<CipAskId> EipScanner::close_io(Instant) {
  State& s = state_;
  s.wanted = false;
  s.reopen_at.reset();
  if (s.io != Io::kOpen) {
    const CipAskId id = s.next_id++;
    s.io = Io::kClosed;
    report(id, Unexpected(CipFailure{}));
    return id;
  }
  return queue(forward_close(s.serial), Purpose::kCloseIo);
}

void EipScanner::set_producing(Instant now, bool on) {
  State& s = state_;
  if (on && !s.producing) {
    s.send_at = now;
    if (s.io == Io::kLost && s.wanted) s.reopen_at = now;
  }
  s.producing = on;
}

void EipScanner::report(CipAskId id, CipAnswer answer) {
  if (state_.results.size() >= kMaxResults) state_.results.pop_front();
  state_.results.push_back({id, std::move(answer)});
}

CipAsk EipScanner::forward_open(const IoWish& w, std::uint16_t serial, std::uint32_t t2o_id) const {
  CipAsk ask;
  ask.service =
      static_cast<std::uint8_t>(w.large ? ConnectionService::kLargeForwardOpen : ConnectionService::kForwardOpen);
  ask.path = manager_path();
  Bytes& d = ask.data;
  d = {kPriorityTick, kTimeoutTicks};
  append_le32(d, 0);
  append_le32(d, t2o_id);
  append_le16(d, serial);
  append_le16(d, settings_.vendor_id);
  append_le32(d, settings_.originator_serial);
  d.push_back(w.timeout_multiplier);
  d.insert(d.end(), 3, 0);
  const std::uint16_t count = w.transport_class == 0 ? 0 : kSequenceCount;
  append_le32(d, microseconds(w.output_rpi));
  append_parameters(d, w.large, false,
                    static_cast<std::uint16_t>(w.output_size + count + (w.run_idle_header ? kRunIdleHeader : 0)));
  append_le32(d, microseconds(w.input_rpi));
  append_parameters(d, w.large, w.multicast, static_cast<std::uint16_t>(w.input_size + count));
  d.push_back(static_cast<std::uint8_t>(w.trigger << 4 | w.transport_class));
  Bytes path = w.key;
  cip::append_logical(path, cip::LogicalType::kClass, 0x04, cip::PathForm::kPadded);
  cip::append_logical(path, cip::LogicalType::kConnectionPoint, w.output_point, cip::PathForm::kPadded);
  cip::append_logical(path, cip::LogicalType::kConnectionPoint, w.input_point, cip::PathForm::kPadded);
  d.push_back(static_cast<std::uint8_t>(path.size() / 2));
  d.insert(d.end(), path.begin(), path.end());
  return ask;
}

CipAsk EipScanner::class3_open(std::uint16_t serial, std::uint32_t t2o_id) const {
  constexpr std::uint8_t kServerApplicationClass3 = 0xa3;
  CipAsk ask;
  ask.service = static_cast<std::uint8_t>(ConnectionService::kForwardOpen);
  ask.path = manager_path();
  Bytes& d = ask.data;
  d = {kPriorityTick, kTimeoutTicks};
  append_le32(d, 0);
  append_le32(d, t2o_id);
  append_le16(d, serial);
  append_le16(d, settings_.vendor_id);
  append_le32(d, settings_.originator_serial);
  d.push_back(settings_.class3_multiplier);
  d.insert(d.end(), 3, 0);
  for (int direction = 0; direction < 2; ++direction) {
    append_le32(d, microseconds(settings_.class3_rpi));
    append_le16(d, 0x4200 | kExplicitSize);  // variable
  }
  d.push_back(kServerApplicationClass3);
  const Bytes path = object_path(ethernet_ip::kMessageRouterClass, 1, 0);
  d.push_back(static_cast<std::uint8_t>(path.size() / 2));
  d.insert(d.end(), path.begin(), path.end());
  return ask;
}

CipAsk EipScanner::forward_close(std::uint16_t serial) const {
  CipAsk ask;
  ask.service = static_cast<std::uint8_t>(ConnectionService::kForwardClose);
  ask.path = manager_path();
  Bytes& d = ask.data;
  d = {kPriorityTick, kTimeoutTicks};
  append_le16(d, serial);
  append_le16(d, settings_.vendor_id);
  append_le32(d, settings_.originator_serial);
  const IoWish& w = state_.wish;
  Bytes path;
  cip::append_logical(path, cip::LogicalType::kClass, 0x04, cip::PathForm::kPadded);
  cip::append_logical(path, cip::LogicalType::kConnectionPoint, w.output_point, cip::PathForm::kPadded);
  cip::append_logical(path, cip::LogicalType::kConnectionPoint, w.input_point, cip::PathForm::kPadded);
  d.push_back(static_cast<std::uint8_t>(path.size() / 2));
  d.push_back(0);
  d.insert(d.end(), path.begin(), path.end());
  return ask;
}

Bytes EipScanner::encapsulated(std::uint16_t command, ByteView data) const {
  ethernet_ip::EncapsulationHeader header;
  header.command = command;
  header.length = static_cast<std::uint16_t>(data.size());
  header.session = state_.session;
  for (std::size_t i = 0; i < 4; ++i) header.context[i] = static_cast<std::uint8_t>(state_.context >> 8 * i);
  Bytes out;
  ethernet_ip::append_header(out, header);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

static Bytes request_of(const CipAsk& ask) {
  Bytes out{ask.service, static_cast<std::uint8_t>(ask.path.size() / 2)};
  out.insert(out.end(), ask.path.begin(), ask.path.end());
  out.insert(out.end(), ask.data.begin(), ask.data.end());
  return out;
}

Bytes EipScanner::unconnected(const CipAsk& ask) const {
  const Bytes request = request_of(ask);
  Bytes data;
  append_le32(data, 0);
  append_le16(data, 0);
  append_le16(data, 2);
  ethernet_ip::append_item_header(data, ItemType::kNullAddress, 0);
  ethernet_ip::append_item_header(data, ItemType::kUnconnectedData, request.size());
  data.insert(data.end(), request.begin(), request.end());
  return encapsulated(static_cast<std::uint16_t>(Command::kSendRRData), data);
}

Bytes EipScanner::over_class3(const CipAsk& ask) const {
  const Bytes request = request_of(ask);
  Bytes data;
  append_le32(data, 0);
  append_le16(data, 0);
  append_le16(data, 2);
  ethernet_ip::append_item_header(data, ItemType::kConnectedAddress, 4);
  append_le32(data, state_.class3_o2t);
  ethernet_ip::append_item_header(data, ItemType::kConnectedData, request.size() + kSequenceCount);
  append_le16(data, state_.class3_count);
  data.insert(data.end(), request.begin(), request.end());
  return encapsulated(static_cast<std::uint16_t>(Command::kSendUnitData), data);
}

std::optional<Bytes> EipScanner::poll_tcp(Instant now) {
  State& s = state_;
  if (s.link == Link::kRegister) {
    s.link = Link::kRegistering;
    s.context = s.next_context++;
    s.answer_by = now + settings_.timeout;
    Bytes data;
    append_le16(data, ethernet_ip::kProtocolVersion);
    append_le16(data, 0);
    return encapsulated(static_cast<std::uint16_t>(Command::kRegisterSession), data);
  }
  if (s.link != Link::kUp || s.current || s.queue.empty()) return std::nullopt;
  if (s.queue.front().ask.connected && (!s.class3_open || now >= s.class3_until)) {
    const std::uint16_t serial = s.next_serial++;
    s.class3_open = false;
    s.class3_t2o = settings_.originator_serial << 16 | serial;
    s.queue.push_front({0, Purpose::kOpenClass3, class3_open(serial, s.class3_t2o)});
  }
  s.current = std::move(s.queue.front());
  s.queue.pop_front();
  s.context = s.next_context++;
  s.answer_by = now + settings_.timeout;
  if (!s.current->ask.connected) return unconnected(s.current->ask);
  ++s.class3_count;
  s.class3_until = now + timeout_of(settings_.class3_rpi, settings_.class3_multiplier);
  return over_class3(s.current->ask);
}

void EipScanner::handle_tcp(Instant now, ByteView bytes) {
  while (auto message = state_.stream.take(now, bytes)) {
    if (message->oversized) {
      state_.close_requested = true;
      return;
    }
    handle_message(now, *message);
  }
}

void EipScanner::handle_message(Instant now, const ethernet_ip::EncapsulationMessage& message) {
  State& s = state_;
  const auto command = static_cast<Command>(message.header.command);
  const bool ok = message.header.status == 0;
  if (s.link == Link::kRegistering) {
    if (command != Command::kRegisterSession) return;
    s.answer_by.reset();
    s.session = message.header.session;
    s.link = ok ? Link::kUp : s.link;
    s.close_requested = !ok;
    return;
  }
  if (!s.current || (command != Command::kSendRRData && command != Command::kSendUnitData)) return;
  const bool connected = command == Command::kSendUnitData;
  if (!connected && read_le32(message.header.context, 0) != s.context) return;
  if (!ok) {
    CipFailure failure;
    failure.kind = CipFailure::Kind::kEncapsulation;
    failure.encapsulation = message.header.status;
    return finish(now, Unexpected(failure));
  }
  constexpr std::size_t kInterfaceAndTimeout = 6;
  if (connected != s.current->ask.connected || message.data.size() < kInterfaceAndTimeout) return;
  const auto packet = ethernet_ip::parse_common_packet(message.data.subspan(kInterfaceAndTimeout));
  if (!packet) {
    s.close_requested = true;
    return;
  }
  ByteView reply = packet->data;
  if (connected) {
    if (packet->connection_id != s.class3_t2o || reply.size() < kSequenceCount) return;
    if (read_le16(reply, 0) != s.class3_count) return;
    reply = reply.subspan(kSequenceCount);
  }
  on_reply(now, reply, packet->t2o_sockaddr ? packet->t2o_sockaddr->address : 0);
}

void EipScanner::on_reply(Instant now, ByteView reply, std::uint32_t group) {
  constexpr std::size_t kHead = 4;
  if (reply.size() < kHead || reply[0] != (state_.current->ask.service | cip::kReplyBit)) return;
  const std::size_t words = reply[3];
  if (reply.size() < kHead + 2 * words) return;
  const ByteView data = reply.subspan(kHead + 2 * words);
  if (reply[2] == 0) return finish(now, Bytes(data.begin(), data.end()), group);
  CipFailure failure;
  failure.kind = CipFailure::Kind::kStatus;
  failure.general = reply[2];
  for (std::size_t i = 0; i < words; ++i) failure.extended.push_back(read_le16(reply, kHead + 2 * i));
  finish(now, Unexpected(failure));
}

void EipScanner::finish(Instant now, CipAnswer answer, std::uint32_t group) {
  constexpr std::size_t kOpenReply = 26;
  State& s = state_;
  const Waiting done = *std::exchange(s.current, std::nullopt);
  s.answer_by.reset();
  const bool opened = answer && answer->size() >= kOpenReply;
  switch (done.purpose) {
    case Purpose::kUser: break;
    case Purpose::kCloseIo:
      s.io = Io::kClosed;
      s.input.clear();
      break;
    case Purpose::kOpenClass3:
      s.class3_open = opened;
      if (opened) {
        s.class3_o2t = read_le32(*answer, 0);
        s.class3_count = 0;
        s.class3_until = now + kLeastFirstTimeout;
      } else if (!s.queue.empty()) {
        // Whoever asked hears why.
        const Waiting asked = std::move(s.queue.front());
        s.queue.pop_front();
        report(asked.id, std::move(answer));
      }
      return;
    case Purpose::kOpenIo:
    case Purpose::kReopenIo:
      if (opened) {
        on_opened(now, *answer, group);
      } else if (done.purpose == Purpose::kOpenIo) {
        // Refused: it is not asked for again.
        s.io = Io::kClosed;
        s.wanted = false;
      } else {
        s.io = Io::kLost;
        s.reopen_at = now + settings_.reopen_delay;
      }
      if (done.purpose == Purpose::kReopenIo) return;
      break;
  }
  report(done.id, std::move(answer));
}

void EipScanner::on_opened(Instant now, const Bytes& data, std::uint32_t group) {
  State& s = state_;
  s.io = Io::kOpen;
  s.o2t_id = read_le32(data, 0);
  if (s.wish.multicast) s.t2o_id = read_le32(data, 4);  // the target's choice
  s.group = s.wish.multicast ? group : 0;
  s.o2t_api = std::chrono::microseconds(read_le32(data, 16));
  s.t2o_api = std::chrono::microseconds(read_le32(data, 20));
  s.sequence = 0;
  s.count = 0;
  s.last_sequence.reset();
  s.send_at = now;
  s.lost_at = now + std::max(kLeastFirstTimeout, timeout_of(s.t2o_api, s.wish.timeout_multiplier));
}

void EipScanner::lose_io(Instant now) {
  State& s = state_;
  s.io = Io::kLost;
  s.input.clear();
  s.reopen_at = now + settings_.reopen_delay;
}

void EipScanner::handle_io(Instant now, ByteView datagram) {
  State& s = state_;
  if (s.io != Io::kOpen) return;
  const auto packet = ethernet_ip::parse_common_packet(datagram);
  if (!packet || packet->address != ItemType::kSequencedAddress || packet->connection_id != s.t2o_id) return;
  if (s.last_sequence && static_cast<std::int32_t>(packet->sequence - *s.last_sequence) <= 0) return;
  const std::size_t count = s.wish.transport_class == 0 ? 0 : kSequenceCount;
  if (packet->data.size() != count + s.wish.input_size) return;
  s.last_sequence = packet->sequence;
  const ByteView data = packet->data.subspan(count);
  s.input.assign(data.begin(), data.end());
  ++s.inputs;
  s.lost_at = now + timeout_of(s.t2o_api, s.wish.timeout_multiplier);
}

void EipScanner::handle_timeout(Instant now) {
  State& s = state_;
  if (s.answer_by && now >= *s.answer_by) {
    if (s.current) {
      finish(now, Unexpected(CipFailure{CipFailure::Kind::kTimeout, 0, {}, 0}));
    } else {
      s.answer_by.reset();
      s.close_requested = true;
    }
  }
  if (s.io == Io::kOpen && now >= s.lost_at) lose_io(now);
  if (s.io == Io::kLost && s.reopen_at && now >= *s.reopen_at) {
    s.reopen_at.reset();
    if (!s.wanted || !s.producing) return;
    if (s.link != Link::kUp) {
      s.reopen_at = now + settings_.reopen_delay;
      return;
    }
    s.io = Io::kOpening;
    s.serial = s.next_serial++;
    s.t2o_id = settings_.originator_serial << 16 | s.serial;
    static_cast<void>(queue(forward_open(s.wish, s.serial, s.t2o_id), Purpose::kReopenIo));
  }
}

std::optional<Instant> EipScanner::next_deadline() const {
  const State& s = state_;
  std::optional<Instant> next = s.answer_by;
  const auto consider = [&](Instant at) {
    if (!next || at < *next) next = at;
  };
  if (s.io == Io::kOpen) {
    consider(s.lost_at);
    if (s.producing) consider(s.send_at);
  }
  if (s.io == Io::kLost && s.reopen_at) consider(*s.reopen_at);
  return next;
}

std::optional<Bytes> EipScanner::poll_io(Instant now) {
  State& s = state_;
  if (s.io != Io::kOpen || !s.producing || now < s.send_at) return std::nullopt;
  // What was missed is not made up for.
  while (s.send_at <= now) s.send_at += std::max(s.o2t_api, Duration(std::chrono::microseconds(1)));
  s.sent_version = s.version;
  Bytes payload;
  if (s.wish.transport_class != 0) append_le16(payload, ++s.count);
  if (s.wish.run_idle_header) append_le32(payload, s.run ? 1 : 0);
  if (s.wish.run_idle_header || s.run) payload.insert(payload.end(), s.output.begin(), s.output.end());
  Bytes out;
  append_le16(out, 2);
  ethernet_ip::append_item_header(out, ItemType::kSequencedAddress, 8);
  append_le32(out, s.o2t_id);
  append_le32(out, ++s.sequence);
  ethernet_ip::append_item_header(out, ItemType::kConnectedData, payload.size());
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

std::optional<CipResult> EipScanner::poll_result() {
  if (state_.results.empty()) return std::nullopt;
  CipResult result = std::move(state_.results.front());
  state_.results.pop_front();
  return result;
}

void EipScanner::archive_state(Archive& a) {
  VINV_FIELDS(a, EipScanner, settings_, state_);
  if (!a.loads() || a.failed()) return;
  const State& s = state_;
  a.require(s.queue.size() <= kMaxWaiting + 1 && s.results.size() <= kMaxResults, "a scanner has more than it can");
  a.require(!s.current || s.link == Link::kUp, "a scanner waits for an answer without a session");
  a.require(s.output.size() == s.wish.output_size || !s.wanted, "an output image has another size than its connection");
  a.require(s.io != Io::kOpen || (s.o2t_api.count() > 0 && s.t2o_api.count() > 0), "a connection has no interval");
  const auto whole = [](const Waiting& w) { return w.ask.path.size() % 2 == 0; };
  a.require((!s.current || whole(*s.current)) && std::all_of(s.queue.begin(), s.queue.end(), whole),
            "a path ends in the middle of a word");
}

}  // namespace vinv::masters
