// The text of Lawicel's serial line CAN adapters (CAN232 and CANUSB manuals), as slcand, python-can 4.1 and most CAN
// tools speak it: lines that end in CR.
//
//   tIIILDD..   TIIIIIIIILDD..   rIIIL   RIIIIIIIIL    standard and extended data and remote frames
//
// A received frame may be followed by four digits of a time stamp in milliseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sim/base/bytes.hpp"
#include "sim/base/can_frame.hpp"

namespace vinv::transports {

// Lines of a stream, without the CR. An adapter's BEL, which stands for an error and ends what was there, is a line
// "\a".
class SlcanLines {
 public:
  static constexpr std::size_t kMaxLineBytes = 32;  // the longest is 31: T, 8, 1, 16, 4 and the CR

  using OnLine = std::function<void(std::string_view line)>;
  // A longer line is given to on_line cut off, one byte beyond the limit, so that nobody takes it for another.
  void feed(ByteView bytes, const OnLine& on_line);

 private:
  std::array<char, kMaxLineBytes + 1> line_{};
  std::size_t size_ = 0;
  bool after_cr_ = false;
};

// Exactly one frame, in strict form; with_stamp: four digits may follow.
std::optional<CanFrame> parse_slcan_frame(std::string_view line, bool with_stamp = false);
// Without the CR.
void append_slcan_frame(std::string& out, const CanFrame& frame, std::optional<std::uint16_t> stamp_ms = std::nullopt);
inline std::string slcan_frame(const CanFrame& frame, std::optional<std::uint16_t> stamp_ms = std::nullopt) {
  std::string out;
  append_slcan_frame(out, frame, stamp_ms);
  return out;
}

// S0 to S8. S7 is 800 kbit/s in Lawicel's manuals.
inline constexpr std::array<std::uint32_t, 9> kSlcanBitrates = {10'000,  20'000,  50'000,  100'000,  125'000,
                                                                250'000, 500'000, 800'000, 1'000'000};
// sXXYY: BTR0 and BTR1 of an SJA1000 at 16 MHz; 0 if the registers give no rate.
std::uint32_t slcan_bitrate_of_registers(std::uint8_t btr0, std::uint8_t btr1);
// The command that sets this rate: S, or s for the rates of CanBus that have no S; empty if there is none.
std::string slcan_bitrate_command(std::uint32_t bitrate);

}  // namespace vinv::transports
