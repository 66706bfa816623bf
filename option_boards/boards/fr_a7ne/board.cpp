#include "option_boards/boards/fr_a7ne/board.hpp"

namespace vinv::boards::fr_a7ne {

void Board::handle_power(Instant now, bool on) {
  state_.now = now;
  unit_.handle_power(now, on);
}

void Board::handle_drive_tick(Instant now) {
  state_.now = now;
  unit_.handle_drive_tick(now);
}

void Board::set_failed(Instant now, bool failed) {
  state_.now = now;
  unit_.set_failed(now, failed);
}

void Board::plug(Instant now, bool plugged) {
  state_.now = now;
  state_.plugged = plugged;
  unit_.set_link(now, plugged);
}

void Board::handle_activity(Instant now) {
  state_.now = now;
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
  LedSituation s = unit_.led_situation();
  s.traffic = state_.now < state_.traffic_until;
  return s;
}

std::vector<Led> Board::leds() const {
  const LedSituation s = situation();
  return {{"MS", module_led(s)}, {"NS", network_led(s)}, {"LINK/ACT", link_led(s)}};
}

void Board::archive_state(Archive& a) {
  VINV_MEMBERS(*this, unit, state, stored);
  a.must_match("option board", kType);
  VINV_FIELDS(a, Board, unit, state, stored);
}

}  // namespace vinv::boards::fr_a7ne
