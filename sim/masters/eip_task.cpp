#include "sim/masters/eip_task.hpp"

#include <cstdio>

namespace vinv::masters {

std::string hex_text(ByteView bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    char text[4];
    std::snprintf(text, sizeof text, out.empty() ? "%02X" : " %02X", byte);
    out += text;
  }
  return out;
}

bool matches(ByteView bytes, ByteView expected, ByteView mask) {
  if (bytes.size() != expected.size()) return false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint8_t m = i < mask.size() ? mask[i] : 0xff;
    if ((bytes[i] & m) != (expected[i] & m)) return false;
  }
  return true;
}

TaskOutcome judge(const CipAnswer& answer, const std::optional<CipExpectation>& expected) {
  const bool status = !answer && answer.error().kind == CipFailure::Kind::kStatus;
  if (!answer && (!status || !expected)) return Unexpected(text_of(answer.error()));
  const std::string data = answer ? hex_text(*answer) : std::string();
  const std::string said =
      answer ? "general status 00" + (data.empty() ? "" : ", data " + data) : text_of(answer.error());
  if (!expected) return data;
  const std::uint8_t general = answer ? 0 : answer.error().general;
  bool fits = general == expected->general;
  if (expected->extended && !answer) fits = fits && *expected->extended == answer.error().extended;
  if (expected->data) fits = fits && answer && matches(*answer, *expected->data, expected->mask);
  if (fits) return said;
  CipFailure wanted;
  wanted.kind = CipFailure::Kind::kStatus;
  wanted.general = expected->general;
  if (expected->extended) wanted.extended = *expected->extended;
  return Unexpected("answered " + said + ", not " + (expected->general == 0 ? "general status 00" : text_of(wanted)) +
                    (expected->data ? ", data " + hex_text(*expected->data) : std::string()));
}

}  // namespace vinv::masters
