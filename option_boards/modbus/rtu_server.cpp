#include "option_boards/modbus/rtu_server.hpp"

#include <algorithm>
#include <utility>

#include "option_boards/modbus/crc16.hpp"
#include "sim/base/check.hpp"

namespace vinv::modbus {
namespace {

constexpr std::uint8_t kBroadcastAddress = 0;
constexpr std::size_t kCrcLength = 2;
constexpr std::uint32_t kFixedIntervalsAbove = 19200;  // baud

}  // namespace

SilentIntervals silent_intervals(std::uint32_t baud, unsigned bits_per_character) {
  VINV_CHECK(baud > 0);
  const auto characters = [&](std::int64_t tenths) {
    return Duration{tenths * 100'000'000 * static_cast<std::int64_t>(bits_per_character) / baud};
  };
  SilentIntervals intervals{characters(10), characters(15), characters(35)};
  if (baud > kFixedIntervalsAbove) {
    intervals.t1_5 = std::chrono::microseconds(750);
    intervals.t3_5 = std::chrono::microseconds(1750);
  }
  return intervals;
}

void RtuServer::start(Instant now, const Settings& settings) {
  stop();
  state_.settings = settings;
  state_.silence = silent_intervals(settings.baud, settings.bits_per_character);
  // Whatever is on the line now may be the rest of a frame.
  state_.open = true;
  state_.receiving = true;
  state_.discard = true;
  state_.last_character_at = now;
}

void RtuServer::stop() {
  if (state_.transaction != Transaction::kNone) units_[state_.unit_index]->forget(client_);
  state_ = State{};
}

Instant RtuServer::frame_ends_at() const {
  return state_.last_character_at + state_.silence.t3_5 + state_.settings.receive_slack;
}

void RtuServer::handle_bytes(Instant now, ByteView bytes, bool line_error) {
  if (!state_.open || (bytes.empty() && !line_error)) return;
  handle_timeout(now);
  if (!state_.receiving) {
    state_.receiving = true;
    state_.length = 0;
    state_.discard = state_.transaction != Transaction::kNone;
  } else if (!bytes.empty()) {
    const auto reception = state_.silence.character * static_cast<std::int64_t>(bytes.size() - 1);
    const Duration gap = now - state_.last_character_at - reception;
    if (gap > state_.silence.t1_5 + state_.settings.receive_slack) state_.discard = true;
  }
  const std::size_t room = kMaxFrame - state_.length;
  if (line_error || bytes.size() > room) state_.discard = true;
  const std::size_t n = std::min(bytes.size(), room);
  std::copy_n(bytes.begin(), n, state_.frame.begin() + static_cast<std::ptrdiff_t>(state_.length));
  state_.length += n;
  state_.last_character_at = now;
}

void RtuServer::handle_timeout(Instant now) {
  if (state_.receiving && now >= frame_ends_at()) end_frame(now);
}

void RtuServer::end_frame(Instant now) {
  state_.receiving = false;
  if (!state_.discard) dispatch(now, ByteView(state_.frame).first(state_.length));
}

void RtuServer::dispatch(Instant now, ByteView frame) {
  if (frame.size() < kMinFrame) return;
  const ByteView covered = frame.first(frame.size() - kCrcLength);
  if (read_le16(frame, covered.size()) != crc16(covered)) return;
  const std::uint8_t address = frame[0];
  const ByteView pdu = covered.subspan(1);
  if (address == kBroadcastAddress) {
    for (Unit* unit : units_) {
      if (unit->address() != 0) unit->handle_request(now, client_, Addressing::kBroadcast, pdu);
    }
    return;
  }
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (units_[i]->address() != address) continue;
    state_.transaction = Transaction::kAwaitingUnit;
    state_.unit_index = i;
    state_.unit_address = address;
    units_[i]->handle_request(now, client_, Addressing::kUnit, pdu);
    return;
  }
}

std::optional<Instant> RtuServer::next_deadline() const {
  if (state_.receiving) return frame_ends_at();
  if (state_.transaction == Transaction::kAnswering) return state_.answer_at;
  return std::nullopt;
}

std::optional<Bytes> RtuServer::poll_transmit(Instant now) {
  handle_timeout(now);
  if (state_.transaction == Transaction::kAwaitingUnit) {
    Unit& unit = *units_[state_.unit_index];
    const bool listens = unit.address() != 0;
    if (const auto pdu = listens ? unit.poll_answer(now, client_) : std::nullopt) {
      state_.answer.clear();
      state_.answer.push_back(state_.unit_address);
      state_.answer.insert(state_.answer.end(), pdu->begin(), pdu->end());
      append_le16(state_.answer, crc16(state_.answer));
      state_.answer_at = now + state_.settings.answer_delay;
      state_.transaction = Transaction::kAnswering;
    } else if (!listens || !unit.has_request(client_)) {
      unit.forget(client_);
      state_.transaction = Transaction::kNone;
    }
  }
  if (state_.transaction != Transaction::kAnswering || state_.receiving || now < state_.answer_at) return std::nullopt;
  state_.transaction = Transaction::kNone;
  return std::exchange(state_.answer, {});
}

void RtuServer::archive_state(Archive& a) {
  VINV_MEMBERS(*this, client, units, state);
  a.must_match("number of Modbus units", units.size());
  a.io(state);
  a.require(state.settings.baud > 0, "a serial line has no speed");
  a.require(state.length <= kMaxFrame, "a Modbus frame is longer than there can be");
  a.require(state.transaction == Transaction::kNone || state.unit_index < units.size(),
            "a request is with a Modbus unit that there is not");
  a.require(state.answer.size() <= kMaxFrame, "a Modbus answer is longer than there can be");
}

}  // namespace vinv::modbus
