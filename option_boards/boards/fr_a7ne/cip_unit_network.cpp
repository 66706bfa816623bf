// What the network and the FR-A7NE are to each other: link, address, connections, and what identity and LEDs tell of
// it. FR-A7NE manual, 1.2, 4.2, 4.5.1, 7.1.2 and 8.
#include <algorithm>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"

namespace vinv::boards::fr_a7ne {

void CipUnit::set_link(Instant, bool up) {
  state_.link_down = !up;
  look_for_link();
  look_for_duplicate();
  report_line_error();
}

void CipUnit::look_for_link() {
  if (online() && has_link()) state_.link_seen = true;
}

void CipUnit::set_address_conflict(Instant, bool conflict) {
  state_.address_conflict = conflict;
  look_for_duplicate();
  report_line_error();
}

// To be found it takes an address and a link, at the start or later.
void CipUnit::look_for_duplicate() {
  if (!state_.address_conflict || !on_network()) return;
  state_.duplicate_address = true;
  // Its connections end without a word, so the owner's data stays away.
  if (tally(cip::IoRole::kExclusiveOwner).open > 0) state_.owner_timed_out = true;
  leave_network();
}

void CipUnit::leave_network() {
  state_.connections = {};
  state_.restarted = true;
  router_.forget_all();
}

void CipUnit::set_failed(Instant, bool failed) {
  state_.broken = failed;
  if (online() && failed && !state_.failed) {
    state_.failed = true;
    leave_network();
  }
  drive_.set_option_failed(state_.broken || state_.failed);
}

bool CipUnit::on_network() const {
  return online() && has_link() && state_.network.ip.address != 0 && !state_.duplicate_address && !state_.failed;
}

// 4.5.1. Not: Forward_Close, the end of a TCP connection, time-outs of connections without output data.
bool CipUnit::line_error() const { return state_.owner_timed_out || (state_.link_seen && !has_link()); }

void CipUnit::report_line_error() { drive_.set_communication_lost(line_error()); }

void CipUnit::count(ConnectionTally& tally, cip::IoEvent event) {
  if (event == cip::IoEvent::kOpened) {
    ++tally.open;
    tally.timed_out = false;
    return;
  }
  tally.open = std::max(tally.open, 1u) - 1;
  if (event == cip::IoEvent::kTimedOut) tally.timed_out = true;
}

void CipUnit::on_explicit_connection(Instant, cip::IoEvent event) { count(state_.connections[kExplicit], event); }

void CipUnit::on_connection(Instant, const cip::IoConnection& connection, cip::IoEvent event) {
  count(tally(connection.role), event);
  if (connection.role != cip::IoRole::kExclusiveOwner) return;
  if (event == cip::IoEvent::kOpened) state_.acted_before = false;  // whatever comes first is new
  state_.owner_timed_out = event == cip::IoEvent::kTimedOut;
  report_line_error();
}

LedSituation CipUnit::led_situation() const {
  LedSituation s;
  s.supplied = state_.supply != Supply::kOff;
  s.self_test = self_tests();
  s.initializing = !drive_.ready();
  s.major_fault = state_.broken || state_.failed;
  s.minor_fault = drive_.status().alarm;
  s.has_address = online() && state_.network.ip.address != 0;
  s.duplicate_address = state_.duplicate_address;
  for (const ConnectionTally& of_kind : state_.connections) {
    s.connected = s.connected || of_kind.open > 0;
    s.timed_out = s.timed_out || of_kind.timed_out;
  }
  s.link = online() && has_link();
  return s;
}

// 7.1.2 *2 with the meaning of CIP for bit 0. Deviation: the manual prints 0 for allocated. Bit 11, a LED that is lit
// red, nobody sees: a failed option and one with a duplicate address are not on the network.
std::uint16_t CipUnit::identity_status() const {
  constexpr std::uint16_t kOwned = 1u << 0, kMinorFault = 1u << 8, kBlinksRed = 1u << 10;
  const LedSituation leds = led_situation();
  std::uint16_t status = 0;
  if (state_.connections[static_cast<std::size_t>(cip::IoRole::kExclusiveOwner)].open > 0) status |= kOwned;
  if (leds.minor_fault) status |= kMinorFault;
  if (leds.minor_fault || leds.timed_out) status |= kBlinksRed;
  return status;
}

cip::IdentityState CipUnit::identity_state() const {
  if (!online()) return cip::IdentityState::kSelfTesting;
  return state_.network.ip.address == 0 ? cip::IdentityState::kStandby : cip::IdentityState::kOperational;
}

}  // namespace vinv::boards::fr_a7ne
