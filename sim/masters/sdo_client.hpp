// SDO client: expedited transfers, one at a time with each node. CiA DS-301 v4.0, 9.2.2.2.
// A server that answers with a segmented transfer gets abort 05040001.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::masters {

inline constexpr std::uint32_t kSdoTimedOut = 0x05040000;  // the client's own abort code
// What DS-301 says of an abort code; empty if it does not know it.
std::string_view abort_text(std::uint32_t code);

struct SdoTransfer {
  std::uint8_t node = 1;  // 1-127
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  bool download = false;
  std::uint8_t size = 0;  // download: bytes, 1-4
  std::uint32_t raw = 0;  // download: the value, its first byte lowest
  friend void archive(Archive& a, SdoTransfer& transfer) {
    VINV_MEMBERS(transfer, node, index, sub, download, size, raw);
    VINV_FIELDS(a, SdoTransfer, node, index, sub, download, size, raw);
    a.require(node >= 1 && node <= 127 && size <= 4 && (!download || size >= 1), "an SDO transfer is none");
  }
};

struct SdoValue {
  std::uint32_t raw = 0;
  std::uint8_t size = 0;  // bytes; 0: the server does not say
  friend bool operator==(SdoValue, SdoValue) = default;
  VINV_ARCHIVE(SdoValue, raw, size);
};

struct SdoFailure {
  enum class Kind : std::uint8_t { kTimeout, kAbort, kUnsupported };
  friend VINV_ENUM_RANGE(Kind, kTimeout, kUnsupported);
  Kind kind = Kind::kTimeout;
  std::uint32_t abort_code = 0;  // kAbort
  friend bool operator==(SdoFailure, SdoFailure) = default;
  VINV_ARCHIVE(SdoFailure, kind, abort_code);
};
// "SDO abort 06020000 (object does not exist)", "no answer".
std::string text_of(SdoFailure failure);

using SdoId = std::uint32_t;
struct SdoResult {
  SdoId id = 0;
  SdoTransfer transfer;
  Result<SdoValue, SdoFailure> value = Unexpected(SdoFailure{});
  VINV_ARCHIVE(SdoResult, id, transfer, value);
};

class SdoClient {
 public:
  static constexpr std::size_t kMaxTransfers = 256;  // waiting or under way; a further one is refused
  static constexpr std::size_t kMaxResults = 256;    // not fetched; then the oldest is lost

  explicit SdoClient(Duration timeout) : timeout_(timeout) {}

  std::optional<SdoId> submit(const SdoTransfer& transfer);
  // True if the frame was an SDO answer of any node.
  bool handle_frame(const CanFrame& frame);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  std::optional<CanFrame> poll_transmit(Instant now);
  std::optional<SdoResult> poll_result();
  std::size_t waiting() const { return state_.transfers.size(); }

 private:
  struct Open {
    SdoId id = 0;
    SdoTransfer transfer;
    std::optional<Instant> answer_by;  // empty: not sent yet
    VINV_ARCHIVE(Open, id, transfer, answer_by);
  };
  struct State {
    SdoId next_id = 1;
    std::vector<Open> transfers;  // in the order of their submission
    std::deque<SdoResult> results;
    std::deque<CanFrame> aborts;  // to be sent
    VINV_ARCHIVE(State, next_id, transfers, results, aborts);
  };
  void finish(std::size_t index, const Result<SdoValue, SdoFailure>& value);
  void abort(const SdoTransfer& transfer, std::uint32_t code);

  Duration timeout_;
  State state_;
  VINV_ARCHIVE(SdoClient, timeout_, state_);
};

}  // namespace vinv::masters
