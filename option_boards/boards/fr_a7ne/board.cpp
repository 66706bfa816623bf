#include "option_boards/boards/fr_a7ne/board.hpp"

namespace vinv::boards::fr_a7ne {

void Board::handle_power(Instant now, bool on) {
  state_.now = now;
  state_.supplied = on;
  state_.duplicate_address = false;
  unit_.handle_power(now, on);
  follow_link(now);
}

void Board::handle_drive_tick(Instant now) {
  state_.now = now;
  unit_.handle_drive_tick(now);
  follow_link(now);
}

// The line settings are known when the option has started; before, only a cable that is not there is a lost link.
bool Board::has_link() const { return state_.supplied && state_.plugged && (!unit_.online() || unit_.line().link); }

void Board::follow_link(Instant now) {
  const bool up = !state_.supplied || has_link();  // without supply nobody tells the inverter anything
  if (up == state_.link_told) return;
  state_.link_told = up;
  unit_.set_link(now, up);
}

void Board::plug(Instant now, bool plugged) {
  state_.plugged = plugged;
  follow_link(now);
}

void Board::handle_activity(Instant now, std::size_t connections) {
  state_.now = now;
  state_.connections = connections;
  state_.traffic_until = now + kTrafficShown;
}

Result<void, std::string> Board::set_switch(std::string_view name, unsigned) {
  return Unexpected("fr-a7ne has no switch \"" + std::string(name) + "\"; it has none at all");
}

bool Board::take_flash_changed() {
  if (unit_.flash() == stored_) return false;
  stored_ = unit_.flash();
  return true;
}

Result<void, std::string> Board::load_flash(std::string_view text) {
  const auto flash = parse_flash(text);
  if (!flash) return Unexpected(flash.error());
  unit_.set_flash(*flash);
  stored_ = *flash;
  return {};
}

LedSituation Board::situation() const {
  LedSituation s;
  s.supplied = state_.supplied;
  s.self_test = !unit_.online();
  s.initializing = !drive_.ready();
  s.minor_fault = drive_.status().alarm;
  s.has_address = address() != 0;
  s.duplicate_address = state_.duplicate_address;
  s.connected = state_.connections > 0;
  s.timed_out = unit_.owner_timed_out();
  s.link = has_link();
  s.traffic = state_.now < state_.traffic_until;
  return s;
}

std::vector<Led> Board::leds() const {
  const LedSituation s = situation();
  return {{"MS", module_led(s)}, {"NS", network_led(s)}, {"LINK/ACT", link_led(s)}};
}

void Board::archive_state(Archive& a) {
  VINV_MEMBERS(*this, drive, unit, state, stored);
  a.must_match("option board", kType);
  VINV_FIELDS(a, Board, unit, state, stored);
}

}  // namespace vinv::boards::fr_a7ne
