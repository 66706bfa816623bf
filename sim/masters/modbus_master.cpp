#include "sim/masters/modbus_master.hpp"

#include <algorithm>
#include <utility>

#include "option_boards/modbus/crc16.hpp"
#include "option_boards/modbus/rtu_server.hpp"
#include "sim/base/check.hpp"

namespace vinv::masters {
namespace {

constexpr std::size_t kMbapLength = 7;
constexpr std::size_t kMaxPdu = 253;
constexpr std::size_t kMinRtuFrame = 4;
constexpr std::size_t kMaxRtuFrame = 256;

}  // namespace

ModbusMaster::ModbusMaster(const ModbusMasterSettings& settings) : settings_(settings) { follow_settings(); }

void ModbusMaster::follow_settings() {
  const modbus::SilentIntervals intervals = modbus::silent_intervals(settings_.baud, settings_.bits_per_character);
  character_ = intervals.character;
  silence_ = intervals.t3_5;
}

void ModbusMaster::archive_state(Archive& a) {
  VINV_MEMBERS(*this, settings, character, silence, state);
  ModbusMasterSettings is = settings;
  VINV_FIELDS(a, ModbusMaster, is, state);
  a.require(is.framing == settings.framing, "a Modbus master has another framing");
  a.require(is.baud > 0 && is.bits_per_character >= 8 && is.bits_per_character <= 12, "a serial line has no speed");
  for (const Cycle& c : state.cycles) a.require(c.interval > Duration{}, "a cyclic request has no interval");
  if (!a.loads() || a.failed()) return;
  settings = is;
  follow_settings();
}

Duration ModbusMaster::frame_time(std::size_t bytes) const {
  if (settings_.framing == ModbusFraming::kTcp) return Duration{};
  return character_ * static_cast<std::int64_t>(bytes);
}

void ModbusMaster::handle_connected(Instant now) {
  state_.connected = true;
  state_.close_requested = false;
  state_.received.clear();
  state_.damaged = false;
  state_.frame_ends_at.reset();
  state_.line_free_at = now + silence_;
}

void ModbusMaster::handle_disconnected() {
  state_.connected = false;
  state_.received.clear();
  state_.frame_ends_at.reset();
  const ModbusAnswer none = Unexpected(ModbusFailure{ModbusFailure::Kind::kNotConnected});
  if (state_.current) finish(none);
  while (!state_.queue.empty()) {
    Waiting what = std::move(state_.queue.front());
    state_.queue.pop_front();
    report(std::move(what), none, 0);
  }
}

std::optional<ModbusRequestId> ModbusMaster::submit(Instant, ModbusRequest request) {
  VINV_CHECK(request.is_legal());
  if (state_.queue.size() >= kMaxWaiting) return std::nullopt;
  const ModbusRequestId id = state_.next_id++;
  Waiting what{id, std::nullopt, std::move(request)};
  if (state_.connected)
    state_.queue.push_back(std::move(what));
  else
    report(std::move(what), Unexpected(ModbusFailure{ModbusFailure::Kind::kNotConnected}), 0);
  return id;
}

std::optional<std::size_t> ModbusMaster::add_cycle(Instant now, ModbusRequest request, Duration interval) {
  VINV_CHECK(request.is_legal() && interval > Duration{});
  if (state_.cycles.size() >= kMaxCycles) return std::nullopt;
  state_.cycles.push_back({std::move(request), interval, now, false});
  return state_.cycles.size() - 1;
}

void ModbusMaster::start_cycles(Instant now) {
  for (std::size_t i = 0; i < state_.cycles.size(); ++i) {
    Cycle& c = state_.cycles[i];
    if (now < c.due_at) continue;
    c.due_at += c.interval * ((now - c.due_at) / c.interval + 1);
    if (c.waits || !state_.connected || state_.queue.size() >= kMaxWaiting) continue;
    c.waits = true;
    state_.queue.push_back({state_.next_id++, i, c.request});
  }
}

void ModbusMaster::report(Waiting what, const ModbusAnswer& answer, unsigned attempts) {
  if (what.cycle && *what.cycle < state_.cycles.size()) state_.cycles[*what.cycle].waits = false;
  if (state_.results.size() >= kMaxResults) state_.results.pop_front();
  state_.results.push_back({what.id, what.cycle, std::move(what.request), answer, attempts});
}

void ModbusMaster::finish(const ModbusAnswer& answer) {
  Current done = std::move(*state_.current);
  state_.current.reset();
  report(std::move(done.what), answer, done.attempts);
}

void ModbusMaster::attempt_failed(ModbusFailure failure) {
  Current& current = *state_.current;
  current.answer_by.reset();
  if (current.attempts > settings_.retries) finish(Unexpected(failure));
}

void ModbusMaster::handle_bytes(Instant now, ByteView bytes, bool line_error) {
  if (!state_.connected) return;
  handle_timeout(now);
  if (settings_.framing == ModbusFraming::kTcp) {
    state_.received.insert(state_.received.end(), bytes.begin(), bytes.end());
    take_adus();
    return;
  }
  if (line_error || state_.received.size() + bytes.size() > kMaxRtuFrame) {
    state_.damaged = true;
    state_.received.clear();
  } else {
    state_.received.insert(state_.received.end(), bytes.begin(), bytes.end());
  }
  state_.frame_ends_at = now + silence_;
  state_.line_free_at = std::max(state_.line_free_at, *state_.frame_ends_at);
}

void ModbusMaster::end_rtu_frame() {
  const Bytes frame = std::exchange(state_.received, {});
  const bool damaged = std::exchange(state_.damaged, false);
  if (!state_.current || !state_.current->answer_by) return;  // nobody was asked
  const ByteView view(frame);
  const ByteView covered = view.first(frame.size() < 2 ? 0 : frame.size() - 2);
  if (damaged || frame.size() < kMinRtuFrame || read_le16(view, covered.size()) != modbus::crc16(covered))
    return attempt_failed({ModbusFailure::Kind::kBadFrame});
  const ModbusRequest& request = state_.current->what.request;
  if (frame[0] != request.unit) return;
  const ModbusAnswer answer = parse_answer(request, covered.subspan(1));
  // An echo of the request before it, for example; the right answer may still come.
  if (!answer && answer.error().kind == ModbusFailure::Kind::kWrongAnswer)
    return attempt_failed({ModbusFailure::Kind::kWrongAnswer});
  finish(answer);
}

void ModbusMaster::take_adus() {
  while (state_.received.size() >= kMbapLength) {
    const ByteView view(state_.received);
    const std::size_t length = read_be16(view, 4);
    if (read_be16(view, 2) != 0 || length < 2 || length > kMaxPdu + 1) {
      state_.close_requested = true;
      state_.received.clear();
      return;
    }
    const std::size_t end = kMbapLength - 1 + length;
    if (view.size() < end) return;
    const std::uint16_t transaction_id = read_be16(view, 0);
    const Bytes pdu(view.begin() + kMbapLength, view.begin() + static_cast<std::ptrdiff_t>(end));
    const std::uint8_t unit = view[6];
    state_.received.erase(state_.received.begin(), state_.received.begin() + static_cast<std::ptrdiff_t>(end));
    // Of an attempt that was given up, or a duplicate.
    if (!state_.current || !state_.current->answer_by || state_.current->transaction_id != transaction_id) continue;
    if (state_.current->what.request.unit != unit) {
      attempt_failed({ModbusFailure::Kind::kWrongAnswer});
      continue;
    }
    finish(parse_answer(state_.current->what.request, pdu));
  }
}

void ModbusMaster::handle_timeout(Instant now) {
  if (state_.frame_ends_at && now >= *state_.frame_ends_at) {
    state_.frame_ends_at.reset();
    end_rtu_frame();
  }
  // An answer that has begun is waited for.
  if (state_.current && state_.current->answer_by && now >= *state_.current->answer_by && !state_.frame_ends_at)
    attempt_failed({ModbusFailure::Kind::kTimeout});
  start_cycles(now);
}

std::optional<Instant> ModbusMaster::next_deadline() const {
  std::optional<Instant> next;
  const auto consider = [&](Instant at) { next = next ? std::min(*next, at) : at; };
  for (const Cycle& c : state_.cycles) consider(c.due_at);
  if (!state_.connected) return next;
  if (state_.frame_ends_at) {
    consider(*state_.frame_ends_at);
  } else if (state_.current && state_.current->answer_by) {
    consider(*state_.current->answer_by);
  } else if (waiting() > 0) {
    consider(state_.line_free_at);
  }
  return next;
}

std::optional<Bytes> ModbusMaster::poll_transmit(Instant now) {
  handle_timeout(now);
  if (!state_.connected || state_.frame_ends_at) return std::nullopt;
  if (state_.current && state_.current->answer_by) return std::nullopt;
  const bool rtu = settings_.framing == ModbusFraming::kRtu;
  if (rtu && now < state_.line_free_at) return std::nullopt;
  if (!state_.current) {
    if (state_.queue.empty()) return std::nullopt;
    state_.current.emplace();
    state_.current->what = std::move(state_.queue.front());
    state_.queue.pop_front();
  }
  Current& current = *state_.current;
  const ModbusRequest& request = current.what.request;
  ++current.attempts;
  const Bytes pdu = emit_pdu(request);
  Bytes frame;
  if (rtu) {
    frame.push_back(request.unit);
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    append_le16(frame, modbus::crc16(frame));
    const Instant sent = now + frame_time(frame.size());
    state_.line_free_at = sent + silence_;
    current.answer_by = sent + settings_.timeout;
    if (request.unit == kModbusBroadcast) {
      state_.line_free_at = sent + std::max(silence_, settings_.turnaround);
      finish(request.values);
    }
    return frame;
  }
  current.transaction_id = state_.next_transaction_id++;
  append_be16(frame, current.transaction_id);
  append_be16(frame, 0);
  append_be16(frame, static_cast<std::uint16_t>(pdu.size() + 1));
  frame.push_back(request.unit);
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  current.answer_by = now + settings_.timeout;
  return frame;
}

std::optional<ModbusResult> ModbusMaster::poll_result() {
  if (state_.results.empty()) return std::nullopt;
  ModbusResult first = std::move(state_.results.front());
  state_.results.pop_front();
  return first;
}

}  // namespace vinv::masters
