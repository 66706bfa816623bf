#include "sim/rig/board_line.hpp"

#include <utility>

namespace vinv::rig {

void BoardLine::connect(Instant now, std::unique_ptr<transports::ByteStream> stream, LineOptions options,
                        OnTraffic on_traffic) {
  stream_ = std::move(stream);
  options_ = std::move(options);
  on_traffic_ = std::move(on_traffic);
  told_.reset();
  for (boards::SerialChannel* channel : channels_) channel->set_receive_slack(now, options_.receive_slack);
  follow_settings();
  listen();
}

void BoardLine::listen() {
  stream_->set_handlers([this](Instant at, ByteView bytes, bool error) { handle_bytes(at, bytes, error); },
                        [](Instant, const std::string&) {});
}

void BoardLine::handle_bytes(Instant now, ByteView bytes, bool line_error) {
  const std::optional<std::uint32_t> baud = options_.far_end_baud ? options_.far_end_baud() : std::nullopt;
  for (boards::SerialChannel* channel : channels_) {
    // Characters at another speed are noise to a UART, not bytes. Where the far end's speed is seen, each board
    // compares for itself: the carrier knows the settings of the first only.
    const bool error = baud ? *baud != channel->line_settings().baud : line_error;
    channel->handle_bytes(now, bytes, error);
  }
  if (on_traffic_) on_traffic_(now);
}

void BoardLine::send(Instant now, ByteView frame) {
  if (stream_ != nullptr) stream_->send(now, frame);
}

void BoardLine::follow_settings() {
  if (channels_.empty() || !options_.on_settings) return;
  const boards::LineSettings wanted = channels_.front()->line_settings();
  if (told_ == wanted) return;
  told_ = wanted;
  options_.on_settings(wanted);
}

void BoardLine::archive(Archive& a, transports::MemoryStreams& streams, WireTap& tap, const OnTraffic& on_traffic) {
  // Lines in memory have no options, and nobody to tell settings to.
  VINV_MEMBERS(*this, channels, stream, options, traffic, told);
  std::unique_ptr<transports::ByteStream> none;
  streams.archive_end(a, is_outside() ? none : stream);
  if (!a.loads() || a.failed()) return;
  options = {};
  told.reset();
  if (stream == nullptr) return;
  stream = tap.wrap(std::move(stream));
  traffic = on_traffic;
  listen();
}

}  // namespace vinv::rig
