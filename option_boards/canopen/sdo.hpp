// SDO frames of a server that has expedited transfers only. CiA DS-301 v4.0, 9.2.2.2.
#pragma once

#include <cstdint>
#include <optional>

#include "option_boards/canopen/abort_code.hpp"
#include "sim/base/can_frame.hpp"

namespace vinv::canopen {

struct SdoRequest {
  enum class Kind : std::uint8_t {
    kUpload,
    kDownload,     // expedited
    kAbort,        // by the client; never answered
    kUnsupported,  // segmented and block transfers, unknown command specifiers
  };
  Kind kind = Kind::kUnsupported;
  std::uint16_t index = 0;  // 0:0 where the request names no object (segments)
  std::uint8_t sub = 0;
  std::uint32_t raw_value = 0;  // kDownload: the data bytes, the first lowest, bytes beyond the size are 0
  unsigned size = 0;            // kDownload: 1-4; 0 if not indicated, and raw_value has all four
};

// Empty: no SDO request at all (remote frame, not 8 bytes), which a server does not answer.
std::optional<SdoRequest> parse_sdo_request(const CanFrame& frame);

// size: 1-4.
CanFrame emit_upload_answer(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub, std::uint32_t raw_value,
                            unsigned size);
CanFrame emit_download_answer(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub);
CanFrame emit_abort(std::uint32_t cob_id, std::uint16_t index, std::uint8_t sub, AbortCode code);

}  // namespace vinv::canopen
