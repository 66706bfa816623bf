#include "sim/masters/modbus_station.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {

ModbusStation::ModbusStation(kernel::Scheduler& scheduler, const ModbusMasterSettings& settings, Dial dial,
                             transports::MemoryStreams* net)
    : Station(scheduler), master_(settings), dial_(std::move(dial)), net_(net), runner_(*this) {
  connect(scheduler.now());
  settle(scheduler.now());
}

ModbusStation::~ModbusStation() = default;

void ModbusStation::connect(Instant now) {
  state_.redial_at.reset();
  stream_ = dial_(now);
  if (stream_ == nullptr) {
    state_.redial_at = now + kRedialDelay;
    return;
  }
  listen();
  master_.handle_connected(now);
}

void ModbusStation::listen() {
  stream_->set_handlers(
      [this](Instant at, ByteView bytes, bool line_error) {
        log(at, false, Bytes(bytes.begin(), bytes.end()), connection());
        if (!silent()) master_.handle_bytes(at, bytes, line_error);
        settle(at);
      },
      [this](Instant at, const std::string&) {
        disconnect(at);
        settle(at);
      });
}

void ModbusStation::archive(Archive& a) {
  VINV_CHECK(net_ != nullptr);
  Station::archive(a);
  VINV_FIELDS(a, ModbusStation, master_, runner_, state_);
  net_->archive_end(a, stream_);
  runner_.require_client(a, 255, false);
  a.require(runner_.in_access() == (state_.access || state_.access_result), "a master waits for an answer to nothing");
  a.require(!master_.connected() || stream_ != nullptr, "a master is connected to nothing");
  if (a.loads() && !a.failed() && stream_ != nullptr) listen();
}

// Both ends of a line in memory have one number.
std::uint32_t ModbusStation::connection() const {
  const bool tcp = master_.settings().framing == ModbusFraming::kTcp;
  return tcp && stream_ != nullptr ? stream_->end_number() / 2 : 0;
}

void ModbusStation::disconnect(Instant now) {
  master_.handle_disconnected();
  state_.redial_at = now + kRedialDelay;
}

void ModbusStation::transmit(Instant now, ByteView frame) {
  if (silent() || stream_ == nullptr) return;
  log(now, true, Bytes(frame.begin(), frame.end()), connection());
  stream_->send(now, frame);
}

bool ModbusStation::send_frame(Instant now, ByteView frame) {
  if (!master_.connected() || frame.empty()) return false;
  transmit(now, frame);
  return true;
}

std::optional<Instant> ModbusStation::work(Instant now) {
  if (state_.redial_at && now >= *state_.redial_at) connect(now);
  for (bool again = true; again;) {
    again = false;
    master_.handle_timeout(now);
    while (const auto frame = master_.poll_transmit(now)) transmit(now, *frame);
    bool unanswered = master_.close_requested();
    while (auto result = master_.poll_result()) {
      again = true;
      if (!result->answer && result->answer.error().kind == ModbusFailure::Kind::kTimeout) unanswered = true;
      if (state_.access != result->id) {
        if (state_.results.size() >= ModbusMaster::kMaxResults) state_.results.erase(state_.results.begin());
        state_.results.push_back(*std::move(result));
        continue;
      }
      state_.access.reset();
      if (result->answer)
        state_.access_result = std::uint32_t{result->answer->front()};
      else
        state_.access_result = Unexpected(text_of(result->answer.error()));
    }
    if (unanswered && master_.connected() && master_.settings().framing == ModbusFraming::kTcp) {
      stream_->close();
      disconnect(now);
      again = true;
    }
    const auto step = runner_.step();
    const bool busy = runner_.busy(), asked = state_.access.has_value();
    runner_.advance(now);
    again = again || busy != runner_.busy() || step != runner_.step() || asked != state_.access.has_value();
  }
  std::optional<Instant> next = master_.next_deadline();
  const auto consider = [&](const std::optional<Instant>& at) {
    if (at && (!next || *at < *next)) next = at;
  };
  consider(runner_.next_deadline());
  consider(state_.redial_at);
  return next;
}

std::optional<ModbusRequestId> ModbusStation::submit(Instant now, ModbusRequest request) {
  const auto id = master_.submit(now, std::move(request));
  settle(now);
  return id;
}

std::optional<std::size_t> ModbusStation::add_cycle(Instant now, ModbusRequest request, Duration interval) {
  const auto number = master_.add_cycle(now, std::move(request), interval);
  settle(now);
  return number;
}

std::vector<ModbusResult> ModbusStation::take_results() { return std::exchange(state_.results, {}); }

void ModbusStation::ask(Instant now, ModbusRequest request) {
  VINV_CHECK(!state_.access);
  state_.access_result.reset();
  state_.access = master_.submit(now, std::move(request));
  if (!state_.access) state_.access_result = Unexpected(std::string("too many requests wait for this master"));
}

void ModbusStation::begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t, std::uint32_t raw) {
  ask(now, ModbusRequest::write(node, static_cast<std::uint16_t>(item), static_cast<std::uint16_t>(raw)));
}

void ModbusStation::begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t) {
  ask(now, ModbusRequest::read(node, static_cast<std::uint16_t>(item)));
}

std::optional<Result<std::uint32_t, std::string>> ModbusStation::poll_access() {
  return std::exchange(state_.access_result, std::nullopt);
}

// Profiles over Modbus have no steps of these kinds.
void ModbusStation::command(Instant, std::uint8_t, std::uint32_t) { VINV_CHECK(false); }
void ModbusStation::set_output(std::uint8_t, Item, std::uint8_t, std::uint32_t) { VINV_CHECK(false); }
void ModbusStation::send_output(Instant, std::uint8_t, Item) { VINV_CHECK(false); }

std::string ModbusStation::name_of(Item item) const { return "register " + std::to_string(item); }

}  // namespace vinv::masters
