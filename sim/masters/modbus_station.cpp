#include "sim/masters/modbus_station.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {

ModbusStation::ModbusStation(kernel::Scheduler& scheduler, const ModbusMasterSettings& settings, Dial dial)
    : Station(scheduler), master_(settings), dial_(std::move(dial)), runner_(*this) {
  connect(scheduler.now());
  settle(scheduler.now());
}

ModbusStation::~ModbusStation() = default;

void ModbusStation::connect(Instant now) {
  redial_at_.reset();
  stream_ = dial_(now);
  if (stream_ == nullptr) {
    redial_at_ = now + kRedialDelay;
    return;
  }
  stream_->set_handlers(
      [this](Instant at, ByteView bytes, bool line_error) {
        log(at, false, Bytes(bytes.begin(), bytes.end()));
        if (!silent()) master_.handle_bytes(at, bytes, line_error);
        settle(at);
      },
      [this](Instant at, const std::string&) {
        disconnect(at);
        settle(at);
      });
  master_.handle_connected(now);
}

void ModbusStation::disconnect(Instant now) {
  master_.handle_disconnected();
  redial_at_ = now + kRedialDelay;
}

void ModbusStation::transmit(Instant now, ByteView frame) {
  if (silent() || stream_ == nullptr) return;
  log(now, true, Bytes(frame.begin(), frame.end()));
  stream_->send(now, frame);
}

bool ModbusStation::send_frame(Instant now, ByteView frame) {
  if (!master_.connected() || frame.empty()) return false;
  transmit(now, frame);
  return true;
}

std::optional<Instant> ModbusStation::work(Instant now) {
  if (redial_at_ && now >= *redial_at_) connect(now);
  for (bool again = true; again;) {
    again = false;
    master_.handle_timeout(now);
    while (const auto frame = master_.poll_transmit(now)) transmit(now, *frame);
    bool unanswered = master_.close_requested();
    while (auto result = master_.poll_result()) {
      again = true;
      if (!result->answer && result->answer.error().kind == ModbusFailure::Kind::kTimeout) unanswered = true;
      if (access_ != result->id) {
        if (results_.size() >= ModbusMaster::kMaxResults) results_.erase(results_.begin());
        results_.push_back(*std::move(result));
        continue;
      }
      access_.reset();
      if (result->answer)
        access_result_ = std::uint32_t{result->answer->front()};
      else
        access_result_ = Unexpected(text_of(result->answer.error()));
    }
    if (unanswered && master_.connected() && master_.settings().framing == ModbusFraming::kTcp) {
      stream_->close();
      disconnect(now);
      again = true;
    }
    const auto step = runner_.state().step;
    const bool busy = runner_.busy(), asked = access_.has_value();
    runner_.advance(now);
    again = again || busy != runner_.busy() || step != runner_.state().step || asked != access_.has_value();
  }
  std::optional<Instant> next = master_.next_deadline();
  const auto consider = [&](const std::optional<Instant>& at) {
    if (at && (!next || *at < *next)) next = at;
  };
  consider(runner_.next_deadline());
  consider(redial_at_);
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

std::vector<ModbusResult> ModbusStation::take_results() { return std::exchange(results_, {}); }

void ModbusStation::ask(Instant now, ModbusRequest request) {
  VINV_CHECK(!access_);
  access_result_.reset();
  access_ = master_.submit(now, std::move(request));
  if (!access_) access_result_ = Unexpected(std::string("too many requests wait for this master"));
}

void ModbusStation::begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t, std::uint32_t raw) {
  ask(now, ModbusRequest::write(node, static_cast<std::uint16_t>(item), static_cast<std::uint16_t>(raw)));
}

void ModbusStation::begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t) {
  ask(now, ModbusRequest::read(node, static_cast<std::uint16_t>(item)));
}

std::optional<Result<std::uint32_t, std::string>> ModbusStation::poll_access() {
  return std::exchange(access_result_, std::nullopt);
}

// Profiles over Modbus have no steps of these kinds.
void ModbusStation::command(Instant, std::uint8_t, std::uint32_t) { VINV_CHECK(false); }
void ModbusStation::set_output(std::uint8_t, Item, std::uint8_t, std::uint32_t) { VINV_CHECK(false); }
void ModbusStation::send_output(Instant, std::uint8_t, Item) { VINV_CHECK(false); }

std::string ModbusStation::name_of(Item item) const { return "register " + std::to_string(item); }

}  // namespace vinv::masters
