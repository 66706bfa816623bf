// What a scanner can be told beside the words of a drive engineer: its connections, its data, raw requests.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/masters/eip_message.hpp"

namespace vinv::masters {

// What the answer must be; anything else fails the task.
struct CipExpectation {
  std::uint8_t general = 0;
  std::optional<std::vector<std::uint16_t>> extended;
  std::optional<Bytes> data;
  Bytes mask;  // of data; empty: every bit
  VINV_ARCHIVE(CipExpectation, general, extended, data, mask);
};

struct EipTask {
  enum class Kind : std::uint8_t {
    kOpen,       // wish, expected
    kClose,      // expected
    kIdle,       // on: packets say idle; done when one has
    kProducing,  // off: nothing is produced and nothing opened again
    kDrop,       // the TCP connection is closed without a word, and dialled again
    kRequest,    // ask, expected
    kOutput,     // bytes: the whole output image; done when it has been sent
    kInput,      // bytes, mask, within: waits for input data
  };
  friend VINV_ENUM_RANGE(Kind, kOpen, kInput);
  Kind kind = Kind::kClose;
  IoWish wish;
  CipAsk ask;
  std::optional<CipExpectation> expected;
  bool on = true;
  Bytes bytes, mask;
  Duration within = std::chrono::milliseconds(100);
  VINV_ARCHIVE(EipTask, kind, wish, ask, expected, on, bytes, mask, within);
};

// What to show; the error is a sentence without full stop.
using TaskOutcome = Result<std::string, std::string>;

// Empty: as expected. Without an expectation a refusal is the outcome.
TaskOutcome judge(const CipAnswer& answer, const std::optional<CipExpectation>& expected);
// "94 00 B0 04".
std::string hex_text(ByteView bytes);
bool matches(ByteView bytes, ByteView expected, ByteView mask);

}  // namespace vinv::masters
