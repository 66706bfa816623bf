// One serial line with one or more boards on it, and whatever carries its bytes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "option_boards/boards/option_board.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::rig {

class SerialLine {
 public:
  // Speed of the other end where the transport can see it (a pseudo-terminal); empty: not known, taken as right.
  using FarEndBaud = std::function<std::optional<std::uint32_t>()>;
  // The line as the boards want it now: the first board that listens decides. Called when it changes.
  using OnSettings = std::function<void(const boards::LineSettings&)>;
  // Bytes have gone in; the owner then settles the boards of this line.
  using OnTraffic = std::function<void(Instant now)>;

  // The channel outlives the line.
  void add(boards::SerialChannel& channel) { channels_.push_back(&channel); }
  void connect(std::unique_ptr<transports::ByteStream> stream, FarEndBaud far_end_baud, OnSettings on_settings,
               OnTraffic on_traffic);
  bool connected() const { return stream_ != nullptr; }

  void send(Instant now, ByteView frame);
  // Tells the transport when the boards want other settings than before.
  void follow_settings();

 private:
  void handle_bytes(Instant now, ByteView bytes, bool line_error);

  std::vector<boards::SerialChannel*> channels_;
  std::unique_ptr<transports::ByteStream> stream_;
  FarEndBaud far_end_baud_;
  OnSettings on_settings_;
  OnTraffic on_traffic_;
  std::optional<boards::LineSettings> told_;
};

}  // namespace vinv::rig
