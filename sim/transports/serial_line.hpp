// What a serial line is besides a stream of bytes: a speed and a parity, which both ends must have alike.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

// Eight data bits and one stop bit always.
struct LineSettings {
  std::uint32_t baud = 9600;
  enum class Parity : std::uint8_t { kNone, kOdd, kEven } parity = Parity::kNone;
  friend constexpr bool operator==(const LineSettings&, const LineSettings&) = default;
};

// "19200 8E1"
std::string text(const LineSettings& settings);

class SerialLine : public ByteStream {
 public:
  // What our end uses from now on; a board calls for it when it samples its parameters. The reason if the line cannot.
  virtual Result<void, std::string> set_line_settings(const LineSettings& settings) = 0;
  // What the other end uses, as far as it can be seen from here.
  virtual std::optional<LineSettings> peer_settings() const = 0;
  // Bytes that the other end did not take in time: a serial line loses them and does not disconnect.
  virtual std::uint64_t lost_bytes() const = 0;
};

}  // namespace vinv::transports
