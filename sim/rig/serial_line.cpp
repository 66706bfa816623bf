#include "sim/rig/serial_line.hpp"

#include <utility>

namespace vinv::rig {

void SerialLine::connect(std::unique_ptr<transports::ByteStream> stream, FarEndBaud far_end_baud,
                         OnSettings on_settings, OnTraffic on_traffic) {
  stream_ = std::move(stream);
  far_end_baud_ = std::move(far_end_baud);
  on_settings_ = std::move(on_settings);
  on_traffic_ = std::move(on_traffic);
  told_.reset();
  stream_->set_handlers([this](Instant now, ByteView bytes, bool error) { handle_bytes(now, bytes, error); },
                        [](Instant, const std::string&) {});
  follow_settings();
}

void SerialLine::handle_bytes(Instant now, ByteView bytes, bool line_error) {
  const std::optional<std::uint32_t> baud = far_end_baud_ ? far_end_baud_() : std::nullopt;
  for (boards::SerialChannel* channel : channels_) {
    // Characters at another speed are noise to a UART, not bytes.
    const bool mismatch = baud && *baud != channel->line_settings().baud;
    channel->handle_bytes(now, bytes, line_error || mismatch);
  }
  if (on_traffic_) on_traffic_(now);
}

void SerialLine::send(Instant now, ByteView frame) {
  if (stream_ != nullptr) stream_->send(now, frame);
}

void SerialLine::follow_settings() {
  if (channels_.empty() || !on_settings_) return;
  const boards::LineSettings wanted = channels_.front()->line_settings();
  if (told_ == wanted) return;
  told_ = wanted;
  on_settings_(wanted);
}

}  // namespace vinv::rig
