// OI-FR-E5NCO: option board of the FR-E500 with CANopen and a Modbus serial port (RS-232C or RS-485).
// OI-FR-E5NCO manual: 2.3 address switches, 2.4 LED, 5.1 start-up parameters, 6 and 7 CANopen, 8 Modbus.
//
// Both sides work at the same time; each sees what the other did to the inverter, and the last command counts. The
// inverter has one write mailbox for both; they take turns (mailbox_share.hpp).
// Switches, Pr.345 and Pr.346 count at power-on, and not again before the next. Pr.347 counts at power-on and after an
// inverter reset. Unspecified: the manual gives no moment for Pr.347; the inverter takes its communication parameters
// so.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/oi_fr_e5nco/canopen_unit.hpp"
#include "option_boards/boards/oi_fr_e5nco/mailbox_share.hpp"
#include "option_boards/boards/oi_fr_e5nco/modbus_unit.hpp"
#include "option_boards/boards/oi_fr_e5nco/startup_settings.hpp"
#include "option_boards/boards/option_board.hpp"
#include "option_boards/modbus/rtu_server.hpp"

namespace vinv::boards::oi_fr_e5nco {

inline constexpr std::string_view kType = "oi-fr-e5nco";

class Board final : public OptionBoard, private SerialChannel {
 public:
  // The drive outlives the board. Without supply until handle_power.
  Board(port::DrivePort& drive, AddressSwitches switches);

  std::string_view type() const override { return kType; }
  void handle_power(Instant now, bool on) override;
  void handle_drive_tick(Instant now) override;
  void handle_timeout(Instant now) override;
  std::optional<Instant> next_deadline() const override;
  // SW1 (tens) and SW2 (units), 0-9 each.
  Result<void, std::string> set_switch(std::string_view name, unsigned value) override;
  modbus::Unit* modbus_unit() override { return &unit_; }
  SerialChannel* serial_channel() override { return this; }
  CanChannel* can_channel() override { return &canopen_; }
  std::string_view status_led() const override { return canopen_.led(); }

 private:
  LineSettings line_settings() const override { return state_.serial.line; }
  void handle_bytes(Instant now, ByteView bytes, bool line_error) override;
  std::optional<Bytes> poll_transmit(Instant now) override { return rtu_.poll_transmit(now); }
  void set_receive_slack(Instant now, Duration slack) override;

  void archive_state(Archive& a) override;

  void start(Instant now);
  void open_line(Instant now);

  enum class Supply : std::uint8_t { kOff, kStarting, kOn };  // kStarting: the start-up parameters are not readable yet
  friend VINV_ENUM_RANGE(Supply, kOff, kOn);
  struct State {
    Supply supply = Supply::kOff;
    bool drive_was_ready = false;
    AddressSwitches switches;          // as they stand now
    AddressSwitches sampled_switches;  // as they stood at power-on
    SerialSetup serial;
    Duration receive_slack{};
    Mailbox mailbox;
    VINV_ARCHIVE(State, supply, drive_was_ready, switches, sampled_switches, serial, receive_slack, mailbox);
  };

  State state_;
  MailboxShare modbus_port_;
  MailboxShare canopen_port_;
  port::DrivePort& drive_;
  ModbusUnit unit_;
  CanopenUnit canopen_;
  modbus::RtuServer rtu_{modbus::kSerialLineClient};
};

}  // namespace vinv::boards::oi_fr_e5nco
