#include "sim/masters/sdo_client.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "option_boards/canopen/nmt.hpp"
#include "sim/base/check.hpp"

namespace vinv::masters {
namespace {

constexpr std::uint8_t kSdoLength = 8;
constexpr std::uint32_t kUnknownCommand = 0x05040001;

struct AbortText {
  std::uint32_t code;
  std::string_view text;
};
// 9.2.2.2.3.
constexpr AbortText kAbortTexts[] = {
    {0x05030000, "toggle bit not alternated"},
    {0x05040000, "SDO protocol timed out"},
    {0x05040001, "command specifier not valid or unknown"},
    {0x05040002, "invalid block size"},
    {0x05040003, "invalid sequence number"},
    {0x05040004, "CRC error"},
    {0x05040005, "out of memory"},
    {0x06010000, "unsupported access to an object"},
    {0x06010001, "attempt to read a write-only object"},
    {0x06010002, "attempt to write a read-only object"},
    {0x06020000, "object does not exist"},
    {0x06040041, "object cannot be mapped to the PDO"},
    {0x06040042, "mapped objects exceed the length of the PDO"},
    {0x06040043, "general parameter incompatibility"},
    {0x06040047, "general internal incompatibility"},
    {0x06060000, "access failed because of a hardware error"},
    {0x06070010, "data type or length does not match"},
    {0x06070012, "length of the parameter too high"},
    {0x06070013, "length of the parameter too low"},
    {0x06090011, "sub-index does not exist"},
    {0x06090030, "value range exceeded"},
    {0x06090031, "value too high"},
    {0x06090032, "value too low"},
    {0x06090036, "maximum value is less than minimum value"},
    {0x08000000, "general error"},
    {0x08000020, "data cannot be transferred or stored"},
    {0x08000021, "data cannot be transferred or stored because of local control"},
    {0x08000022, "data cannot be transferred or stored in the present device state"},
    {0x08000023, "no object dictionary is present"},
};

// The server's command specifiers, bits 7-5.
enum Scs : std::uint8_t { kUploadAnswer = 2, kDownloadAnswer = 3, kAbort = 4 };

CanFrame frame_of(std::uint8_t command, const SdoTransfer& t, std::uint32_t raw) {
  const auto byte = [](std::uint32_t v, unsigned n) { return static_cast<std::uint8_t>(v >> 8 * n); };
  return CanFrame::standard(
      canopen::kSdoRequestCobId + t.node,
      {command, byte(t.index, 0), byte(t.index, 1), t.sub, byte(raw, 0), byte(raw, 1), byte(raw, 2), byte(raw, 3)});
}

std::uint32_t cut(std::uint32_t raw, unsigned size) { return size < 4 ? raw & ((1u << 8 * size) - 1) : raw; }

}  // namespace

std::string_view abort_text(std::uint32_t code) {
  for (const AbortText& row : kAbortTexts)
    if (row.code == code) return row.text;
  return {};
}

std::string text_of(SdoFailure failure) {
  switch (failure.kind) {
    case SdoFailure::Kind::kTimeout: return "no SDO answer";
    case SdoFailure::Kind::kUnsupported: return "an SDO answer that is not expedited";
    case SdoFailure::Kind::kAbort: break;
  }
  char code[32];
  std::snprintf(code, sizeof code, "SDO abort %08X", failure.abort_code);
  const std::string_view meaning = abort_text(failure.abort_code);
  return meaning.empty() ? code : code + (" (" + std::string(meaning) + ")");
}

std::optional<SdoId> SdoClient::submit(const SdoTransfer& transfer) {
  VINV_CHECK(transfer.node >= 1 && transfer.node <= canopen::kLastNode);
  VINV_CHECK(!transfer.download || (transfer.size >= 1 && transfer.size <= 4));
  if (state_.transfers.size() >= kMaxTransfers) return std::nullopt;
  state_.transfers.push_back({state_.next_id++, transfer, {}});
  return state_.transfers.back().id;
}

void SdoClient::finish(std::size_t index, const Result<SdoValue, SdoFailure>& value) {
  const Open done = state_.transfers[index];
  state_.transfers.erase(state_.transfers.begin() + static_cast<std::ptrdiff_t>(index));
  if (state_.results.size() >= kMaxResults) state_.results.pop_front();
  state_.results.push_back({done.id, done.transfer, value});
}

void SdoClient::abort(const SdoTransfer& transfer, std::uint32_t code) {
  state_.aborts.push_back(frame_of(0x80, transfer, code));
}

bool SdoClient::handle_frame(const CanFrame& frame) {
  if (frame.remote || frame.extended || frame.id <= canopen::kSdoAnswerCobId ||
      frame.id > canopen::kSdoAnswerCobId + canopen::kLastNode)
    return false;
  if (frame.length != kSdoLength) return true;
  const auto node = static_cast<std::uint8_t>(frame.id - canopen::kSdoAnswerCobId);
  const auto it = std::find_if(state_.transfers.begin(), state_.transfers.end(),
                               [&](const Open& o) { return o.transfer.node == node && o.answer_by; });
  if (it == state_.transfers.end()) return true;
  const SdoTransfer& t = it->transfer;
  // Of another transfer: late, or meant for another client.
  if (read_le16(frame.bytes(), 1) != t.index || frame.data[3] != t.sub) return true;
  const auto at = static_cast<std::size_t>(it - state_.transfers.begin());
  const std::uint8_t command = frame.data[0];
  const std::uint32_t raw = read_le32(frame.bytes(), 4);
  switch (command >> 5) {
    case kAbort: finish(at, Unexpected(SdoFailure{SdoFailure::Kind::kAbort, raw})); break;
    case kDownloadAnswer:
      if (t.download) finish(at, SdoValue{t.raw, t.size});
      break;
    case kUploadAnswer: {
      if (t.download) break;
      if ((command & 2) == 0) {
        abort(t, kUnknownCommand);
        finish(at, Unexpected(SdoFailure{SdoFailure::Kind::kUnsupported}));
        break;
      }
      const unsigned size = (command & 1) != 0 ? 4u - (command >> 2 & 3u) : 0;
      finish(at, SdoValue{size == 0 ? raw : cut(raw, size), static_cast<std::uint8_t>(size)});
      break;
    }
    default: break;
  }
  return true;
}

void SdoClient::handle_timeout(Instant now) {
  for (std::size_t i = 0; i < state_.transfers.size();) {
    const Open& open = state_.transfers[i];
    if (!open.answer_by || now < *open.answer_by) {
      ++i;
      continue;
    }
    abort(open.transfer, kSdoTimedOut);
    finish(i, Unexpected(SdoFailure{SdoFailure::Kind::kTimeout}));
  }
}

std::optional<Instant> SdoClient::next_deadline() const {
  std::optional<Instant> next;
  for (const Open& open : state_.transfers)
    if (open.answer_by && (!next || *open.answer_by < *next)) next = open.answer_by;
  return next;
}

std::optional<CanFrame> SdoClient::poll_transmit(Instant now) {
  if (!state_.aborts.empty()) {
    const CanFrame frame = state_.aborts.front();
    state_.aborts.pop_front();
    return frame;
  }
  for (std::size_t i = 0; i < state_.transfers.size(); ++i) {
    Open& open = state_.transfers[i];
    const SdoTransfer& t = open.transfer;
    if (open.answer_by) continue;
    const bool busy = std::any_of(state_.transfers.begin(), state_.transfers.begin() + static_cast<std::ptrdiff_t>(i),
                                  [&](const Open& earlier) { return earlier.transfer.node == t.node; });
    if (busy) continue;
    open.answer_by = now + timeout_;
    if (!t.download) return frame_of(0x40, t, 0);
    return frame_of(static_cast<std::uint8_t>(0x23 | (4 - t.size) << 2), t, cut(t.raw, t.size));
  }
  return std::nullopt;
}

std::optional<SdoResult> SdoClient::poll_result() {
  if (state_.results.empty()) return std::nullopt;
  const SdoResult first = state_.results.front();
  state_.results.pop_front();
  return first;
}

}  // namespace vinv::masters
