// One serial line with one or more boards on it, and whatever carries its bytes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "option_boards/boards/option_board.hpp"
#include "sim/rig/wire_tap.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::rig {

// What the line's carrier can do besides bytes; all optional.
struct LineOptions {
  // Speed of the other end where it can be seen (a pseudo-terminal); empty while it is not known, taken as right.
  std::function<std::optional<std::uint32_t>()> far_end_baud;
  // The line as the boards want it from now on; the first board decides.
  std::function<void(const boards::LineSettings&)> on_settings;
  // How late the driver hands over characters, see boards::SerialChannel.
  Duration receive_slack{};
};

class BoardLine {
 public:
  // Bytes have gone in; the owner then settles the boards of this line.
  using OnTraffic = std::function<void(Instant now)>;

  // The channel outlives the line.
  void add(boards::SerialChannel& channel) { channels_.push_back(&channel); }
  void connect(Instant now, std::unique_ptr<transports::ByteStream> stream, LineOptions options, OnTraffic on_traffic);

  bool connected() const { return stream_ != nullptr; }
  void send(Instant now, ByteView frame);
  // Tells the carrier when the boards want other settings than before.
  void follow_settings();

  // Something outside the plant carries its bytes: a snapshot leaves it out.
  bool is_outside() const { return stream_ != nullptr && stream_->end_number() == 0; }
  // Snapshots: after the boards and the net of which the line's carrier is, if any. A load wraps it anew by the tap,
  // which is archived after it.
  void archive(Archive& a, transports::MemoryStreams& streams, WireTap& tap, const OnTraffic& on_traffic);

 private:
  void listen();
  void handle_bytes(Instant now, ByteView bytes, bool line_error);

  std::vector<boards::SerialChannel*> channels_;
  std::unique_ptr<transports::ByteStream> stream_;
  LineOptions options_;
  OnTraffic on_traffic_;
  std::optional<boards::LineSettings> told_;
};

}  // namespace vinv::rig
