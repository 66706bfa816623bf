// What the rig knows of an option board: its channels, its deadlines and its switches.
//
// A board is sans-I/O. The rig hands in what arrives on a channel with the time, asks for what to send, calls
// handle_timeout at next_deadline and handle_drive_tick after each control tick of its inverter. After any handle_
// call the rig drains the channels, then reads next_deadline.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "option_boards/cip/device.hpp"
#include "option_boards/modbus/unit.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::boards {

// Serial line settings as the board wants them, or as the other end of the line has them.
struct LineSettings {
  std::uint32_t baud = 9600;
  enum class Parity : std::uint8_t { kNone, kOdd, kEven } parity = Parity::kNone;
  friend constexpr bool operator==(const LineSettings&, const LineSettings&) = default;
  friend VINV_ENUM_RANGE(Parity, kNone, kEven);
  VINV_ARCHIVE(LineSettings, baud, parity);
};

// A channel of bytes with character timing (RS-232C, RS-485). Several boards may share one line.
class SerialChannel {
 public:
  virtual ~SerialChannel() = default;
  virtual LineSettings line_settings() const = 0;
  // Bytes as they came in one piece, or with a parity or framing error somewhere in them.
  virtual void handle_bytes(Instant now, ByteView bytes, bool line_error) = 0;
  // A whole frame to send now; call until empty.
  virtual std::optional<Bytes> poll_transmit(Instant now) = 0;
  // How late and in what bursts the line's driver hands over characters: 0 for a pseudo-terminal or a scenario, the
  // FIFO or latency timer of a real tty otherwise. Silence on the line is measured with this much patience.
  virtual void set_receive_slack(Instant /*now*/, Duration /*slack*/) {}
};

// A node on a CAN bus. After any handle_ call of the board or the node the rig drains it while the bus takes frames.
class CanChannel {
 public:
  virtual ~CanChannel() = default;
  // Bit/s that the board's controller is set to; 0 while it takes no part in the bus (no supply, no valid address).
  virtual std::uint32_t bit_rate() const = 0;
  // 0 while it takes no part.
  virtual std::uint8_t node() const = 0;
  // A frame of another node; frames of its own never come back.
  virtual void handle_frame(Instant now, const CanFrame& frame) = 0;
  // The next frame to send; called only while the controller has room for it.
  virtual std::optional<CanFrame> poll_transmit(Instant now) = 0;
  // The controller went bus-off, or is back.
  virtual void set_bus_off(Instant /*now*/, bool /*bus_off*/) {}
};

// A station on an Ethernet that speaks EtherNet/IP. The engine and its sockets are the rig's.
class EthernetChannel {
 public:
  virtual ~EthernetChannel() = default;
  virtual cip::Device& cip_device() = 0;
  // True once after the option has started anew, with its supply or with the inverter: connections and sessions are
  // gone.
  virtual bool take_restart() = 0;
  // What it has as its own IPv4 address; 0 while it takes no part in the network (no supply, start-up, none set). The
  // rig may have it reached at another one.
  virtual std::uint32_t address() const = 0;
  // Somebody else has the address; until the option starts anew.
  virtual void set_duplicate_address(bool duplicate) = 0;
  // The cable is plugged, and its two ends agree on speed and duplex.
  virtual bool has_link() const = 0;
  virtual void plug(Instant now, bool plugged) = 0;
  virtual bool plugged() const = 0;
  // For its lamps: something has gone in or out.
  virtual void handle_activity(Instant now) = 0;
};

// "NS", "green flashing".
struct Led {
  std::string_view name;
  std::string_view state;
};

class OptionBoard {
 public:
  virtual ~OptionBoard() = default;
  virtual std::string_view type() const = 0;
  // The inverter's supply comes and goes; switches and start-up parameters are sampled when it comes.
  virtual void handle_power(Instant now, bool on) = 0;
  virtual void handle_drive_tick(Instant now) = 0;
  virtual void handle_timeout(Instant now) = 0;
  virtual std::optional<Instant> next_deadline() const = 0;
  // Rotary or DIP switches by their printed name ("SW1"); sampled as the manual says. Refusal: a sentence.
  virtual Result<void, std::string> set_switch(std::string_view name, unsigned value) = 0;

  // A fault of the board itself: its network is silent and the inverter is told. Of boards that can.
  virtual bool can_fail() const { return false; }
  virtual void set_failed(Instant /*now*/, bool /*failed*/) {}

  // Channels; nullptr where the board has none.
  virtual modbus::Unit* modbus_unit() { return nullptr; }
  virtual SerialChannel* serial_channel() { return nullptr; }
  virtual CanChannel* can_channel() { return nullptr; }
  virtual EthernetChannel* ethernet_channel() { return nullptr; }
  // The board's status LED as a person sees it: "off", "green", "green flashing", ... Empty: it has none. Of several,
  // the one that tells about the network.
  virtual std::string_view status_led() const { return {}; }
  // All of them, on a board that has several.
  virtual std::vector<Led> leds() const { return {}; }

  // The board's own memory over power-off, beside the inverter's EEPROM: the text of its file; empty: it has none. The
  // owner stores it after each change, and hands it back before the first power-on.
  virtual std::string flash_text() const { return {}; }
  virtual bool take_flash_changed() { return false; }  // true once after each change
  // Refuses a damaged text with line and reason; the board then has what it came with.
  virtual Result<void, std::string> load_flash(std::string_view /*text*/) {
    return Unexpected(std::string("the board has no memory of its own"));
  }

  // All that the board knows, as a part of a plant's snapshot (docs/decisions/0005-snapshots.md). Loading calls nobody:
  // whoever listens at the channels finds them as they were.
  friend void archive(Archive& a, OptionBoard& board) { board.archive_state(a); }

 protected:
  virtual void archive_state(Archive& a) = 0;
};

}  // namespace vinv::boards
