// Snapshots of a whole plant: scheduler, drives, boards and wires, in a fixed order.
#include <algorithm>
#include <cstdio>

#include "sim/base/check.hpp"
#include "sim/rig/plant.hpp"

namespace vinv::rig {
namespace {

// A plant and nobody else's events.
struct Whole {
  Plant& plant;
  kernel::Scheduler& scheduler;
  friend void archive(Archive& a, Whole& whole) {
    a.io(whole.plant);
    whole.plant.streams().archive_owners(a);
    whole.scheduler.archive_waiting(a);
  }
};

}  // namespace

std::string Plant::snapshot_objection() const {
  for (std::size_t i = 0; i < ports_.size(); ++i)
    if (ports_[i]->outside() > 0)
      return "a snapshot does not hold the connections of clients: " + std::to_string(ports_[i]->outside()) +
             " are open at Modbus/TCP port " + std::to_string(file_.tcp[i].port) + ".";
  for (std::size_t i = 0; i < lines_.size(); ++i)
    if (lines_[i].is_outside())
      return "a snapshot does not hold what is outside the plant: serial line " + file_.serial[i].name +
             " is connected.";
  for (const auto& bus : buses_)
    if (bus->bridge() != nullptr)
      return "a snapshot does not hold what is outside the plant: CAN bus " + bus->bus().options().name +
             " is joined to another one.";
  for (const auto& d : drives_)
    if (d->ethernet && d->ethernet->is_outside())
      return "a snapshot does not hold what is outside the plant: the EtherNet/IP adapter of " + d->spec.name +
             " has sockets.";
  const bool on_grid =
      std::all_of(drives_.begin(), drives_.end(), [](const auto& d) { return d->inverter->on_snapshot_grid(); });
  if (on_grid) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "a snapshot is taken at the end of a tick on the drives' snapshot grid (every 100 ms); it is %.6f s.",
                to_seconds(scheduler_.now().time_since_epoch()));
  return text;
}

Result<void, std::string> Plant::save(Bytes& out) {
  if (std::string why = snapshot_objection(); !why.empty()) return Unexpected(std::move(why));
  Whole whole{*this, scheduler_};
  save_snapshot(whole, out);
  return {};
}

Result<void, std::string> Plant::load(ByteView snapshot) {
  if (std::string why = snapshot_objection(); !why.empty()) return Unexpected(std::move(why));
  Whole whole{*this, scheduler_};
  return load_snapshot(whole, snapshot);
}

// What the plant was made as and its inverters do not compare themselves. Nodes, parameters and switches are state.
std::string Plant::signature() const {
  std::string out;
  for (const auto& d : drives_) {
    out += d->spec.name + " (" + d->spec.model.value;
    if (d->spec.board) out += ", " + d->spec.board->type.value;
    if (d->controller) out += " on " + file_.can[*d->spec.board->can].name;
    if (d->ethernet) out += " at " + ipv4_text(d->spec.board->ethernet->address);
    out += ") ";
  }
  return out;
}

void Plant::archive_drive(Archive& a, DriveUnit& drive) {
  // The first ones are what the drive was made as.
  VINV_MEMBERS(drive, spec, tcp, serial, can, ethernet_ip, inverter, board, controller, station, adapter, ethernet,
               claimed_address, has_double, mains, dip_fraction, load_ramp_nm, dip_ends, power_returns, reset_released,
               load_ramp_ends, board_powered, board_deadline, board_event);
  a.io(*inverter);
  if (board) a.io(*board);
  if (ethernet) ethernet->archive(a, streams_);
  VINV_FIELDS(a, DriveUnit, claimed_address, has_double, mains, dip_fraction, load_ramp_nm, board_powered,
              board_deadline);
  DriveUnit* const d = &drive;
  scheduler_.archive_event(a, dip_ends, [d](Instant) { d->end_dip(); });
  scheduler_.archive_event(a, power_returns, [this, d](Instant) { return_power(*d); });
  scheduler_.archive_event(a, reset_released, [d](Instant) { d->release_reset(); });
  scheduler_.archive_event(a, load_ramp_ends, [d](Instant) { d->end_load_ramp(); });
  scheduler_.archive_event(a, board_event, [this, d](Instant at) { board_timeout(at, *d); });
}

void Plant::archive_state(Archive& a) {
  // Who is on which line is what the file says.
  VINV_MEMBERS(*this, file, scheduler, clock, datagrams, drives, streams, lines, drives_on_line, ports, buses,
               serial_taps, tcp_taps, tick_event, ticks);
  a.must_match("plant", signature());
  a.io(scheduler);
  a.io(streams);
  a.io(datagrams);
  if (a.loads()) {
    for (const auto& port : ports) port->drop();
    for (const auto& d : drives)
      if (d->ethernet) d->ethernet->drop();
  }
  for (const auto& d : drives) archive_drive(a, *d);
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].archive(a, streams, serial_taps[i], traffic_of(i));
  for (std::size_t i = 0; i < ports.size(); ++i) ports[i]->archive(a, streams, tcp_taps[i]);
  for (WireTap& tap : serial_taps) a.io(tap);
  for (WireTap& tap : tcp_taps) a.io(tap);
  for (const auto& bus : buses) a.io(*bus);
  VINV_FIELDS(a, Plant, ticks);
  scheduler.archive_event(a, tick_event, [this](Instant at) { tick(at); });
}

}  // namespace vinv::rig
