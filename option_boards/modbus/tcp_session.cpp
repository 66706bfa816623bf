#include "option_boards/modbus/tcp_session.hpp"

#include <algorithm>
#include <utility>

namespace vinv::modbus {
namespace {

constexpr std::size_t kHeaderUpToLength = 6;  // transaction id, protocol id, length
constexpr std::size_t kMinLength = 2;         // length field: unit id and function
constexpr std::size_t kMaxLength = 1 + kMaxPdu;

Bytes emit_adu(std::uint16_t transaction_id, std::uint8_t unit_id, ByteView pdu) {
  Bytes adu;
  adu.reserve(TcpSession::kMbapLength + pdu.size());
  append_be16(adu, transaction_id);
  append_be16(adu, 0);
  append_be16(adu, static_cast<std::uint16_t>(1 + pdu.size()));
  adu.push_back(unit_id);
  adu.insert(adu.end(), pdu.begin(), pdu.end());
  return adu;
}

}  // namespace

void TcpSession::handle_bytes(Instant /*now*/, ByteView bytes) {
  while (!bytes.empty() && !close_reason_) {
    const std::size_t wanted =
        received_ < kHeaderUpToLength ? kHeaderUpToLength : kHeaderUpToLength + read_be16(buffer_, 4);
    const std::size_t n = std::min(wanted - received_, bytes.size());
    std::copy_n(bytes.begin(), n, buffer_.begin() + static_cast<std::ptrdiff_t>(received_));
    received_ += n;
    bytes = bytes.subspan(n);
    if (received_ < wanted) continue;
    if (wanted == kHeaderUpToLength) {
      if (!header_is_modbus()) return;
    } else {
      take_adu();
      received_ = 0;
    }
  }
}

bool TcpSession::header_is_modbus() {
  const std::size_t length = read_be16(buffer_, 4);
  if (read_be16(buffer_, 2) != 0) {
    close_reason_ = "protocol identifier is not 0 (Modbus)";
  } else if (length < kMinLength || length > kMaxLength) {
    close_reason_ = "length field is outside 2-254";
  }
  return !close_reason_;
}

void TcpSession::take_adu() {
  const ByteView adu = ByteView(buffer_).first(received_);
  const std::uint16_t transaction_id = read_be16(adu, 0);
  const std::uint8_t unit_id = adu[6];
  const ByteView pdu = adu.subspan(kMbapLength);
  if (requests_.size() < kMaxQueuedRequests) {
    requests_.push_back({transaction_id, unit_id, nullptr, Bytes(pdu.begin(), pdu.end())});
  } else if (refusals_.size() < kMaxQueuedRefusals) {
    refusals_.push_back(
        emit_adu(transaction_id, unit_id, emit_exception(function_of(pdu), Exception::kServerDeviceBusy)));
  } else {
    close_reason_ = "too many requests without waiting for answers";
  }
}

std::optional<Bytes> TcpSession::poll_transmit(Instant now) {
  if (!refusals_.empty()) {
    Bytes adu = std::move(refusals_.front());
    refusals_.pop_front();
    return adu;
  }
  if (requests_.empty()) return std::nullopt;

  QueuedRequest& request = requests_.front();
  std::optional<Bytes> answer;
  if (request.unit == nullptr) {
    request.unit = router_.route(request.unit_id);
    if (request.unit != nullptr) request.unit->handle_request(now, client_, Addressing::kUnit, request.pdu);
  }
  const bool listens = request.unit != nullptr && request.unit->address() != 0;
  if (listens) answer = request.unit->poll_answer(now, client_);
  if (!answer && (!listens || !request.unit->has_request(client_))) {
    // Nobody there, or switched off with our request: the gateway's own answer.
    if (request.unit != nullptr) request.unit->forget(client_);
    answer = emit_exception(function_of(request.pdu), Exception::kGatewayTargetFailedToRespond);
  }
  if (!answer) return std::nullopt;
  Bytes adu = emit_adu(request.transaction_id, request.unit_id, *answer);
  requests_.pop_front();
  return adu;
}

void TcpSession::handle_closed() {
  if (!requests_.empty() && requests_.front().unit != nullptr) requests_.front().unit->forget(client_);
  requests_.clear();
  refusals_.clear();
  received_ = 0;
}

void TcpSession::archive_state(Archive& a) {
  VINV_MEMBERS(*this, client, router, buffer, received, requests, refusals, close_reason);
  VINV_FIELDS(a, TcpSession, buffer, received, refusals, close_reason);
  // Of an ADU whose header is whole, never all of it.
  const bool header = received >= kHeaderUpToLength;
  a.require(received < kMaxAdu && (!header || close_reason || header_is_modbus()), "a Modbus/TCP header is none");
  a.require(!header || close_reason || received < kHeaderUpToLength + read_be16(buffer, 4),
            "an ADU is longer than it says");
  const std::size_t count = a.count(requests.size(), kMaxQueuedRequests);
  if (a.loads()) requests.clear();
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    if (a.loads()) requests.emplace_back();
    VINV_MEMBERS(requests[i], transaction_id, unit_id, unit, pdu);
    VINV_FIELDS(a, QueuedRequest, transaction_id, unit_id, pdu);
    router.archive_unit(a, unit);
    a.require(!pdu.empty() && pdu.size() <= kMaxPdu, "a Modbus request has no possible length");
  }
}

}  // namespace vinv::modbus
