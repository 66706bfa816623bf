#include "option_boards/canopen/sdo.hpp"

namespace vinv::canopen {
namespace {

constexpr std::uint8_t kSdoLength = 8;

// The client's command specifiers, bits 7-5 of the first byte.
enum Ccs : std::uint8_t {
  kInitiateDownload = 1,
  kInitiateUpload = 2,
  kAbortTransfer = 4,
  kBlockUpload = 5,
  kBlockDownload = 6
};

CanFrame answer(std::uint32_t cob_id, std::uint8_t command, std::uint16_t index, std::uint8_t sub, std::uint32_t raw) {
  const auto byte = [](std::uint32_t v, unsigned n) { return static_cast<std::uint8_t>(v >> 8 * n); };
  return CanFrame::standard(
      cob_id, {command, byte(index, 0), byte(index, 1), sub, byte(raw, 0), byte(raw, 1), byte(raw, 2), byte(raw, 3)});
}

}  // namespace

std::optional<SdoRequest> parse_sdo_request(const CanFrame& frame) {
  if (frame.remote || frame.length != kSdoLength) return std::nullopt;
  const std::uint8_t command = frame.data[0];
  const std::uint8_t ccs = command >> 5;
  SdoRequest request;
  const auto take_object = [&] {
    request.index = read_le16(frame.bytes(), 1);
    request.sub = frame.data[3];
  };
  switch (ccs) {
    case kInitiateUpload:
      request.kind = SdoRequest::Kind::kUpload;
      take_object();
      break;
    case kInitiateDownload: {
      take_object();
      const bool expedited = (command & 2) != 0, size_indicated = (command & 1) != 0;
      if (!expedited) break;
      request.kind = SdoRequest::Kind::kDownload;
      request.raw_value = read_le32(frame.bytes(), 4);
      if (size_indicated) {
        request.size = 4u - (command >> 2 & 3u);
        if (request.size < 4) request.raw_value &= (1u << 8 * request.size) - 1;
      }
      break;
    }
    case kAbortTransfer:
      request.kind = SdoRequest::Kind::kAbort;
      take_object();
      break;
    case kBlockUpload:
      if ((command & 3) == 0) take_object();
      break;
    case kBlockDownload:
      if ((command & 1) == 0) take_object();
      break;
    default: break;
  }
  return request;
}

CanFrame emit_upload_answer(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub, std::uint32_t raw_value,
                            unsigned size) {
  if (size < 4) raw_value &= (1u << 8 * size) - 1;
  return answer(cob_id, static_cast<std::uint8_t>(0x43 | (4 - size) << 2), index, sub, raw_value);
}

CanFrame emit_download_answer(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub) {
  return answer(cob_id, 0x60, index, sub, 0);
}

CanFrame emit_abort(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub, AbortCode code) {
  return answer(cob_id, 0x80, index, sub, static_cast<std::uint32_t>(code));
}

}  // namespace vinv::canopen
