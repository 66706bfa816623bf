#include "option_boards/boards/fr_a7ne/cip_unit.hpp"

#include <algorithm>
#include <utility>

#include "option_boards/boards/fr_a7ne/refusal_codes.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

constexpr std::uint16_t kFirstAddressParameter = 434;
constexpr std::uint8_t kOptionAlarm = 0xF3;  // E.3

}  // namespace

bool CipUnit::take_restart() { return std::exchange(state_.restarted, false); }

void CipUnit::handle_power(Instant now, bool on) {
  if (on == (state_.supply != Supply::kOff)) return;
  state_.now = now;
  restart();
  state_.supplied_at = now;
  state_.started = false;
  state_.supply = on ? Supply::kStarting : Supply::kOff;
  if (on) start();
}

// Everything but the flash memory is as after power-on; whoever waited is forgotten.
void CipUnit::restart() {
  const Flash flash = state_.flash;
  const Instant now = state_.now;
  const bool link_down = state_.link_down;
  const bool address_conflict = state_.address_conflict;
  const bool was_started = state_.started;
  const bool broken = state_.broken;
  DriveLink link = state_.link;
  link.clear();
  state_ = {};
  state_.link = link;
  state_.flash = flash;
  state_.now = now;
  state_.link_down = link_down;
  state_.address_conflict = address_conflict;
  state_.started = was_started;
  state_.broken = broken;
  state_.restarted = true;
  state_.supply = Supply::kStarting;
  router_.forget_all();
  report_line_error();
  drive_.set_option_failed(broken);
}

bool CipUnit::read_startup_parameters() {
  StartupParameters read;
  const auto one = [&](std::uint16_t number, auto& into) {
    const auto value = drive_.read_parameter({number, 0});
    if (value) into = static_cast<std::remove_reference_t<decltype(into)>>(*value);
    // A family without the parameter has the default.
    return value || value.error() != port::Refusal::kNotReady;
  };
  if (!one(346, read.pr346) || !one(540, read.pr540)) return false;
  for (std::size_t i = 0; i < read.pr434_to_445.size(); ++i) {
    if (!one(static_cast<std::uint16_t>(kFirstAddressParameter + i), read.pr434_to_445[i])) return false;
  }
  state_.startup = read;
  return true;
}

void CipUnit::start() {
  if (!drive_.ready() || !read_startup_parameters()) return;
  state_.supply = Supply::kOn;
  state_.started = true;
  state_.was_ready = true;
  state_.network = settings_at_start(state_.startup, state_.flash, config_.ethernet.lease);
  state_.assemblies = assemblies_of(state_.startup.pr346);
  state_.control_from_net_at_start = control_from_net();
  look_for_link();
  look_for_duplicate();
  set_failed(state_.now, state_.broken);
}

void CipUnit::handle_drive_tick(Instant now) {
  state_.now = now;
  if (state_.supply == Supply::kOff) return;
  if (state_.restart_due) restart();
  if (state_.supply == Supply::kStarting) start();
  if (state_.supply != Supply::kOn) return;
  advance(now);
  const bool ready = drive_.ready();
  const bool reset = state_.was_ready && !ready;
  // At the next tick: what the inverter has just decided is still answered. Bit 11 of Pr.540 does not count after E.3.
  if (reset && (!keeps_connections_over_reset(state_.startup.pr540) || state_.option_alarm)) state_.restart_due = true;
  state_.was_ready = ready;
  if (ready) state_.option_alarm = drive_.active_alarm() == kOptionAlarm;
  // The inverter has forgotten what was on.
  if (reset || !network_mode()) {
    state_.terminals = state_.wanted = {};
    state_.run = {};
  }
}

void CipUnit::handle_timeout(Instant now) {
  if (state_.supply == Supply::kOn) advance(now);
}

void CipUnit::advance(Instant now) {
  while (const auto finished = state_.link.advance(now, drive_)) on_finished(*finished);
  write_polled_parameter(now);
}

void CipUnit::on_finished(const Finished& finished) {
  const bool done = finished.outcome.has_value();
  if (finished.request.kind == port::WriteRequest::Kind::kCommand) {
    if (done) {
      state_.terminals = finished.request.terminals;
    } else {
      want(state_.terminals, cip::run_signals_of(state_.terminals));
    }
  }
  if (!finished.job) return;
  if (done && finished.job->effect == Effect::kFlashClear) state_.flash = {};
  cip::Reply reply;
  if (!done)
    reply.refuse(status_of(finished.outcome.error()));
  else if (finished.storage_failed)
    reply.refuse(cip::GeneralStatus::kStoreOperationFailure);
  router_.complete(finished.job->ticket, std::move(reply));
}

std::uint32_t CipUnit::parameter_or(std::uint16_t number, std::uint32_t fallback) const {
  const auto value = drive_.read_parameter({number, 0});
  return value ? *value : fallback;
}

// Pr.550 = 1: the RS-485 terminals command in NET operation (4.4).
bool CipUnit::control_from_net() const {
  return network_mode() && parameter_or(338, 0) == 0 && parameter_or(550, 0) != 1;
}
bool CipUnit::reference_from_net() const {
  return network_mode() && parameter_or(339, 0) != 1 && parameter_or(550, 0) != 1;
}

// 4.7, column "Running speed monitor".
cip::SpeedScale CipUnit::speed_scale() const {
  constexpr std::uint32_t kRpmOffset = 100, kUsualPoles = 4, kDefaultReference = 6000;
  const std::uint32_t pr37 = parameter_or(37, 0), pr144 = parameter_or(144, kUsualPoles);
  if (pr144 > kRpmOffset) return cip::SpeedScale::of_poles(pr144 - kRpmOffset);
  if (pr37 != 0) return cip::SpeedScale::of_machine(pr37, std::max(1u, parameter_or(505, kDefaultReference)));
  return cip::SpeedScale::of_poles(pr144 == 0 ? kUsualPoles : pr144);
}

std::uint16_t CipUnit::speed_actual() const {
  constexpr std::int64_t kMost = 32767;
  const auto frequency = drive_.read_monitor(1);
  return static_cast<std::uint16_t>(std::min(kMost, speed_scale().speed_of(frequency ? *frequency : 0)));
}

// 4.6: not while a line error lasts; with Pr.349 = 1 in NET operation only.
bool CipUnit::fault_reset_allowed() const { return !line_error() && (network_mode() || parameter_or(349, 0) != 1); }

void CipUnit::want(port::NetTerminals terminals, cip::RunSignals run) {
  state_.wanted = terminals;
  state_.run = run;
}

port::NetTerminals CipUnit::with_run(cip::RunSignals run) {
  port::NetTerminals terminals = state_.wanted;
  const cip::RunSignals start = cip::run_signals(kRunStyle, state_.run, run, cip::run_signals_of(terminals));
  terminals.set(port::NetTerminal::kStf, start.forward);
  terminals.set(port::NetTerminal::kStr, start.reverse);
  want(terminals, run);
  return terminals;
}

std::optional<cip::GeneralStatus> CipUnit::refuses_explicit(Instant now) const {
  if (state_.link.explicit_busy(now)) return cip::GeneralStatus::kObjectStateConflict;
  if (!online()) return cip::GeneralStatus::kDeviceStateConflict;
  return std::nullopt;
}

cip::SetResult CipUnit::post(Instant now, ExplicitJob job, cip::Ticket ticket) {
  if (const auto refused = refuses_explicit(now)) return Unexpected(cip::Status(*refused));
  job.ticket = ticket;
  state_.link.start(now, job);
  advance(now);
  return cip::Handled::kLater;
}

cip::SetResult CipUnit::post(Instant now, const port::WriteRequest& request, cip::Ticket ticket) {
  ExplicitJob job;
  job.add(request);
  return post(now, job, ticket);
}

}  // namespace vinv::boards::fr_a7ne
