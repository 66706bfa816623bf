#include "sim/masters/canopen_station.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000, kRemoteFlag = 0x40000000;
constexpr std::uint32_t kStandardMask = 0x7ff, kExtendedMask = 0x1fffffff;

}  // namespace

Bytes wire_bytes(const CanFrame& frame) {
  Bytes out;
  append_be32(out, frame.id | (frame.extended ? kExtendedFlag : 0) | (frame.remote ? kRemoteFlag : 0));
  for (std::size_t i = 0; i < frame.length; ++i) out.push_back(frame.data[i]);
  if (frame.remote) std::fill(out.begin() + 4, out.end(), std::uint8_t{0});
  return out;
}

std::optional<CanFrame> can_frame(ByteView bytes) {
  if (bytes.size() < 4 || bytes.size() > 12) return std::nullopt;
  CanFrame frame;
  const std::uint32_t word = read_be32(bytes, 0);
  frame.extended = (word & kExtendedFlag) != 0;
  frame.remote = (word & kRemoteFlag) != 0;
  frame.id = word & ~(kExtendedFlag | kRemoteFlag);
  if (frame.id > (frame.extended ? kExtendedMask : kStandardMask)) return std::nullopt;
  frame.length = static_cast<std::uint8_t>(bytes.size() - 4);
  if (!frame.remote) std::copy(bytes.begin() + 4, bytes.end(), frame.data.begin());
  return frame;
}

CanopenStation::CanopenStation(kernel::Scheduler& scheduler, const CanopenMasterSettings& settings,
                               std::unique_ptr<transports::CanPort> port)
    : Station(scheduler), master_(settings), port_(std::move(port)), runner_(*this) {
  transports::CanHandlers handlers;
  handlers.on_frame = [this](Instant at, const CanFrame& frame) {
    log(at, false, wire_bytes(frame));
    if (!silent()) master_.handle_frame(at, frame);
    settle(at);
  };
  handlers.on_sent = [this](Instant at, const CanFrame& frame) {
    log(at, true, wire_bytes(frame));
    settle(at);
  };
  port_->set_handlers(std::move(handlers));
  master_.start(scheduler.now());
  settle(scheduler.now());
}

CanopenStation::~CanopenStation() = default;

void CanopenStation::archive(Archive& a) {
  Station::archive(a);
  VINV_FIELDS(a, CanopenStation, master_, runner_, state_);
  runner_.require_client(a, canopen::kLastNode, true);
  a.require(runner_.in_access() == (state_.access || state_.access_result), "a master waits for an answer to nothing");
}

bool CanopenStation::send_frame(Instant now, ByteView bytes) {
  const auto frame = can_frame(bytes);
  if (!frame) return false;
  master_.send(*frame);
  settle(now);
  return true;
}

std::optional<Instant> CanopenStation::work(Instant now) {
  for (bool again = true; again;) {
    again = false;
    master_.handle_timeout(now);
    // Bus off: what is due is lost, as in a controller whose queue is flushed; the client's time-outs go on.
    const transports::CanState state = port_->status().state;
    const bool deaf = silent() || state == transports::CanState::kBusOff || state == transports::CanState::kOffline;
    while (deaf || port_->queue_room() > 0) {
      const auto frame = master_.poll_transmit(now);
      if (!frame) break;
      if (!deaf) port_->send(now, *frame);
    }
    while (auto event = master_.poll_event()) {
      again = true;
      if (!event->sdo || state_.access != event->sdo->id) {
        if (state_.events.size() >= CanopenMaster::kMaxEvents) state_.events.erase(state_.events.begin());
        state_.events.push_back(*std::move(event));
        continue;
      }
      state_.access.reset();
      if (event->sdo->value)
        state_.access_result = event->sdo->value->raw;
      else
        state_.access_result = Unexpected(text_of(event->sdo->value.error()));
    }
    const auto step = runner_.step();
    const bool busy = runner_.busy(), asked = state_.access.has_value();
    runner_.advance(now);
    again = again || busy != runner_.busy() || step != runner_.step() || asked != state_.access.has_value();
  }
  std::optional<Instant> next = master_.next_deadline();
  if (const auto at = runner_.next_deadline(); at && (!next || *at < *next)) next = at;
  return next;
}

std::vector<CanopenEvent> CanopenStation::take_events() { return std::exchange(state_.events, {}); }

void CanopenStation::ask(const SdoTransfer& transfer) {
  VINV_CHECK(!state_.access);
  state_.access_result.reset();
  state_.access = master_.transfer(transfer);
  if (!state_.access) state_.access_result = Unexpected(std::string("too many transfers wait for this master"));
}

void CanopenStation::begin_write(Instant, std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) {
  ask({node, static_cast<std::uint16_t>(item >> 8), static_cast<std::uint8_t>(item), true, size, raw});
}

void CanopenStation::begin_read(Instant, std::uint8_t node, Item item, std::uint8_t size) {
  ask({node, static_cast<std::uint16_t>(item >> 8), static_cast<std::uint8_t>(item), false, size, 0});
}

std::optional<Result<std::uint32_t, std::string>> CanopenStation::poll_access() {
  return std::exchange(state_.access_result, std::nullopt);
}

void CanopenStation::command(Instant, std::uint8_t node, std::uint32_t command) {
  master_.command(static_cast<canopen::NmtCommand>(command), node);
}

void CanopenStation::set_output(std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) {
  master_.set_output(node, item >> 8, item & 0xff, size, raw);
}

void CanopenStation::send_output(Instant, std::uint8_t node, Item item) { master_.send_output(node, item >> 8); }

std::optional<std::array<std::uint8_t, 8>> CanopenStation::emergency(std::uint8_t node) const {
  const auto newest = master_.emergency_of(node);
  if (!newest) return std::nullopt;
  std::array<std::uint8_t, 8> bytes{};
  bytes[0] = static_cast<std::uint8_t>(newest->error_code);
  bytes[1] = static_cast<std::uint8_t>(newest->error_code >> 8);
  bytes[2] = newest->error_register;
  std::copy(newest->manufacturer.begin(), newest->manufacturer.end(), bytes.begin() + 3);
  return bytes;
}

std::string CanopenStation::name_of(Item item) const {
  char text[24];
  std::snprintf(text, sizeof text, "object %04XH:%u", item >> 8, item & 0xff);
  return text;
}

}  // namespace vinv::masters
