// FR-A7NE: option board of the FR-A700 with EtherNet/IP. FR-A7NE manual: 1.2 LEDs, 4.2 start-up settings, 4.5 line
// errors. What it is to CIP is CipUnit; here are its supply, its cable and its lamps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "option_boards/boards/fr_a7ne/flash_text.hpp"
#include "option_boards/boards/fr_a7ne/leds.hpp"
#include "option_boards/boards/option_board.hpp"

namespace vinv::boards::fr_a7ne {

inline constexpr std::string_view kType = "fr-a7ne";

class Board final : public OptionBoard, private EthernetChannel {
 public:
  // Unspecified: how long the lamp shows a packet.
  static constexpr Duration kTrafficShown = std::chrono::milliseconds(50);

  // The drive outlives the board. Without supply until handle_power.
  Board(port::DrivePort& drive, const CipUnitConfig& config) : unit_(drive, config), stored_(unit_.flash()) {}

  std::string_view type() const override { return kType; }
  void handle_power(Instant now, bool on) override;
  void handle_drive_tick(Instant now) override;
  void handle_timeout(Instant now) override { unit_.handle_timeout(now); }
  std::optional<Instant> next_deadline() const override { return unit_.next_deadline(); }
  Result<void, std::string> set_switch(std::string_view name, unsigned value) override;
  bool can_fail() const override { return true; }
  void set_failed(Instant now, bool failed) override;
  EthernetChannel* ethernet_channel() override { return this; }
  std::string_view status_led() const override { return network_led(situation()); }
  // MS, NS and LINK/ACT.
  std::vector<Led> leds() const override;
  std::string flash_text() const override { return fr_a7ne::flash_text(unit_.flash()); }
  bool take_flash_changed() override;
  Result<void, std::string> load_flash(std::string_view text) override;

 private:
  cip::Device& cip_device() override { return unit_; }
  bool take_restart() override { return unit_.take_restart(); }
  std::uint32_t address() const override {
    return unit_.online() && !unit_.duplicate_address() && !unit_.failed() ? unit_.network().ip.address : 0;
  }
  void set_duplicate_address(bool duplicate) override { unit_.set_address_conflict(state_.now, duplicate); }
  bool has_link() const override { return unit_.online() && unit_.has_link(); }
  void plug(Instant now, bool plugged) override;
  bool plugged() const override { return state_.plugged; }
  void handle_activity(Instant now) override;
  void archive_state(Archive& a) override;

  LedSituation situation() const;

  struct State {
    bool plugged = true;
    Instant traffic_until{};
    Instant now{};  // of the last call
    VINV_ARCHIVE(State, plugged, traffic_until, now);
  };

  CipUnit unit_;
  State state_;
  Flash stored_;  // as its owner has it
};

}  // namespace vinv::boards::fr_a7ne
