// A serial line as a pseudo-terminal: a client opens our path as if it were the tty of a real port.
//
// No slave is kept open on our side, so that hang-up tells whether a client is there: bytes sent to nobody are lost, as
// on a wire, and a client never finds the answer that the one before it did not wait for.
//
// A pseudo-terminal carries no parity, so of the line settings only the speed is compared; a client whose library
// checks what it has set (pyserial: "Invalid argument") must ask for no parity here. The slave starts raw, at a speed
// that no client sets (134.5 baud): until a client sets one, it is taken to have the right one. What a client set stays
// when it closes, as on a real port.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/event_loop.hpp"
#include "sim/transports/serial_line.hpp"

namespace vinv::transports {

struct SerialPtyOptions {
  // A symbolic link to the slave at a stable name; empty: none. An older link to a pseudo-terminal is replaced,
  // anything else there is refused. Removed at the end.
  std::string link;
  // What our end expects; bytes of a client with another speed are marked as line errors.
  LineSettings settings;
};

class SerialPty : public SerialLine {
 public:
  // Refusal: a sentence. The loop outlives the line.
  static Result<std::unique_ptr<SerialPty>, std::string> open(EventLoop& loop, const SerialPtyOptions& options);
  ~SerialPty() override;
  SerialPty(const SerialPty&) = delete;
  SerialPty& operator=(const SerialPty&) = delete;

  // A client that comes and goes is not the end of the line: on_closed is called only if the line itself fails.
  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override;
  void send(Instant now, ByteView bytes) override;
  void close() override;
  std::string name() const override;  // of the slave: "/dev/pts/5"
  const std::string& link() const;
  bool has_client() const;

  Result<void, std::string> set_line_settings(const LineSettings& settings) override;
  // The client's speed and our parity; empty while no client has set a speed.
  std::optional<LineSettings> peer_settings() const override;
  std::uint64_t lost_bytes() const override;

 private:
  struct Impl;
  explicit SerialPty(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
