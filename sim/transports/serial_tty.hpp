// A real serial port. Held exclusively. A device that vanishes (a USB adapter pulled out) is looked for until it
// returns; the stream lives on meanwhile and what is sent is lost.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/event_loop.hpp"
#include "sim/transports/serial_line.hpp"

namespace vinv::transports {

struct SerialTtyOptions {
  std::string path;  // "/dev/ttyUSB0"
  LineSettings settings;
};

class SerialTty : public SerialLine {
 public:
  static constexpr Duration kReopenInterval = std::chrono::milliseconds(500);
  // What a person should know: the device vanished, returned, or does not take its settings any more.
  using OnNotice = std::function<void(Instant now, const std::string& sentence)>;

  // Refusal: a sentence. The loop outlives the line.
  static Result<std::unique_ptr<SerialTty>, std::string> open(EventLoop& loop, const SerialTtyOptions& options);
  ~SerialTty() override;
  SerialTty(const SerialTty&) = delete;
  SerialTty& operator=(const SerialTty&) = delete;

  void set_notice(OnNotice on_notice);
  bool is_present() const;

  // on_closed is never called: the device may return.
  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override;
  void send(Instant now, ByteView bytes) override;
  void close() override;
  std::string name() const override;

  // Also kept for the time when the device returns.
  Result<void, std::string> set_line_settings(const LineSettings& settings) override;
  // Not visible on a wire: a mismatch shows as line errors.
  std::optional<LineSettings> peer_settings() const override { return std::nullopt; }
  std::uint64_t lost_bytes() const override;

 private:
  struct Impl;
  explicit SerialTty(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
