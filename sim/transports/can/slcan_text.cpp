#include "sim/transports/can/slcan_text.hpp"

#include <algorithm>
#include <utility>

#include "sim/transports/can/number_text.hpp"
#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {

void SlcanLines::feed(ByteView bytes, const OnLine& on_line) {
  for (const std::uint8_t byte : bytes) {
    const char c = static_cast<char>(byte);
    // A person's terminal sends CR LF.
    const bool skip = std::exchange(after_cr_, c == '\r') && c == '\n';
    if (skip) continue;
    if (c == '\r') {
      const auto whole = line_;  // the handler may end us
      on_line({whole.data(), std::exchange(size_, 0)});
    } else if (c == '\a') {
      size_ = 0;
      on_line("\a");
    } else if (size_ < line_.size()) {
      line_[size_++] = c;
    }
  }
}

std::optional<CanFrame> parse_slcan_frame(std::string_view line, bool with_stamp) {
  if (line.empty()) return std::nullopt;
  CanFrame frame;
  switch (line[0]) {
    case 't': break;
    case 'T': frame.extended = true; break;
    case 'r': frame.remote = true; break;
    case 'R': frame.extended = frame.remote = true; break;
    default: return std::nullopt;
  }
  const std::size_t digits = frame.extended ? 8 : 3;
  if (line.size() < 1 + digits + 1) return std::nullopt;
  const auto id = parse_hex(line.substr(1, digits));
  const char length = line[1 + digits];
  if (!id || length < '0' || length > '8') return std::nullopt;
  frame.id = *id;
  frame.length = static_cast<std::uint8_t>(length - '0');
  if (!is_well_formed(frame)) return std::nullopt;
  std::string_view rest = line.substr(1 + digits + 1);
  const std::size_t data_digits = 2 * frame.bytes().size();
  if (with_stamp && rest.size() == data_digits + 4) {
    if (!parse_hex(rest.substr(data_digits))) return std::nullopt;
    rest = rest.substr(0, data_digits);
  }
  if (rest.size() != data_digits) return std::nullopt;
  for (std::size_t i = 0; i < data_digits / 2; ++i) {
    const auto value = parse_hex(rest.substr(2 * i, 2));
    if (!value) return std::nullopt;
    frame.data[i] = static_cast<std::uint8_t>(*value);
  }
  return frame;
}

void append_slcan_frame(std::string& out, const CanFrame& frame, std::optional<std::uint16_t> stamp_ms) {
  out += frame.remote ? (frame.extended ? 'R' : 'r') : (frame.extended ? 'T' : 't');
  append_hex(out, frame.id, frame.extended ? 8 : 3);
  append_hex(out, frame.length, 1);
  for (const std::uint8_t byte : frame.bytes()) append_hex(out, byte, 2);
  if (stamp_ms) append_hex(out, *stamp_ms, 4);
}

std::uint32_t slcan_bitrate_of_registers(std::uint8_t btr0, std::uint8_t btr1) {
  const std::uint32_t prescaler = (btr0 & 0x3fu) + 1;
  const std::uint32_t quanta = 1 + (btr1 & 0x0fu) + 1 + (btr1 >> 4 & 0x07u) + 1;
  const std::uint32_t divisor = prescaler * quanta;
  return divisor == 0 ? 0 : (8'000'000 + divisor / 2) / divisor;
}

std::string slcan_bitrate_command(std::uint32_t bitrate) {
  const auto found = std::find(kSlcanBitrates.begin(), kSlcanBitrates.end(), bitrate);
  if (found != kSlcanBitrates.end()) return "S" + std::to_string(found - kSlcanBitrates.begin());
  // 8 MHz / (8 x 16): prescaler 8, 1 + 13 + 2 quanta, sample point 87.5 %.
  return bitrate == 62'500 ? "s071C" : "";
}

}  // namespace vinv::transports
