// CIP: paths, requests, replies and Unconnected_Sends that are read and written again are the same bytes.
#include <cstddef>
#include <cstdint>

#include "option_boards/cip/message.hpp"
#include "option_boards/cip/unconnected_send.hpp"
#include "sim/base/check.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace vinv::cip {
namespace {

void paths(ByteView bytes, PathForm form) {
  EpathReader reader(bytes, form);
  Bytes again;
  while (!reader.at_end()) {
    const std::size_t before = reader.offset();
    const auto segment = reader.next();
    if (!segment) {
      VINV_CHECK(segment.error().offset == before && reader.offset() == before);
      break;
    }
    VINV_CHECK(reader.offset() > before);
    append_segment(again, *segment, form);
  }
  VINV_CHECK(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(reader.offset())) == again);
}

void messages(ByteView bytes) {
  const auto parsed = parse_request(bytes);
  if (parsed.request) {
    Bytes again;
    append_request(again, *parsed.request);
    const auto second = parse_request(again);
    VINV_CHECK(second.request && second.request->path == parsed.request->path && second.service == parsed.service);
    VINV_CHECK(Bytes(second.request->data.begin(), second.request->data.end()) ==
               Bytes(parsed.request->data.begin(), parsed.request->data.end()));
  }
  if (const auto reply = parse_reply(bytes)) {
    Bytes again;
    append_reply(again, reply->service, {reply->status, {reply->data.begin(), reply->data.end()}});
    VINV_CHECK(again.size() == bytes.size());
    again[1] = bytes[1];  // reserved
    VINV_CHECK(again == Bytes(bytes.begin(), bytes.end()));
  }
  if (const auto send = parse_unconnected_send(bytes)) {
    Bytes again;
    append_unconnected_send(again, *send);
    VINV_CHECK(again == Bytes(bytes.begin(), bytes.end()));
    Reply reply;
    VINV_CHECK(route_ends_here(*send, reply) == send->route_path.empty());
  }
}

}  // namespace
}  // namespace vinv::cip

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  const std::uint8_t what = input.byte();
  const vinv::Bytes rest = input.chunk(size);
  switch (what % 3) {
    case 0: vinv::cip::paths(rest, vinv::cip::PathForm::kPadded); break;
    case 1: vinv::cip::paths(rest, vinv::cip::PathForm::kPacked); break;
    default: vinv::cip::messages(rest); break;
  }
  return 0;
}
