#include "sim/rig/plant.hpp"

#include <algorithm>
#include <utility>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

// Of a switched network in one room.
constexpr Duration kEthernetDelay = std::chrono::microseconds(100);

Problem problem(Position at, const std::string& drive, const std::string& message) {
  return {at, drive + ": " + sentence(message)};
}

}  // namespace

Plant::Plant(PlantFile file, kernel::Scheduler& scheduler, PlantOptions options)
    : file_(std::move(file)),
      scheduler_(scheduler),
      clock_(std::move(options.clock)),
      datagrams_(scheduler, kEthernetDelay),
      streams_(scheduler),
      lines_(file_.serial.size()),
      drives_on_line_(file_.serial.size()),
      serial_taps_(file_.serial.size(), WireTap(scheduler)),
      tcp_taps_(file_.tcp.size(), WireTap(scheduler)) {
  for (std::size_t i = 0; i < serial_taps_.size(); ++i) serial_taps_[i].reseed(options.seed + i);
  for (std::size_t i = 0; i < tcp_taps_.size(); ++i) tcp_taps_[i].reseed(options.seed + i);
  for (std::size_t i = 0; i < file_.tcp.size(); ++i) ports_.push_back(std::make_unique<TcpPort>(scheduler_));
  for (const CanNetwork& net : file_.can) {
    buses_.push_back(std::make_unique<CanLine>(scheduler_, net));
    buses_.back()->set_seed(options.seed + buses_.size() - 1);
  }
  std::vector<Problem> problems;
  for (const DriveSpec& spec : file_.drives) {
    drives_.push_back(build(spec, options, problems));
    if (drives_.back()->board) wire(*drives_.back(), options.seed + drives_.size() - 1);
  }
  if (!problems.empty()) throw PlantFileError(file_.path, std::move(problems));
}

void Plant::reseed(std::uint64_t seed) {
  for (std::size_t i = 0; i < serial_taps_.size(); ++i) serial_taps_[i].reseed(seed + i);
  for (std::size_t i = 0; i < tcp_taps_.size(); ++i) tcp_taps_[i].reseed(seed + i);
  for (std::size_t i = 0; i < buses_.size(); ++i) buses_[i]->reseed(seed + i);
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (drives_[i]->ethernet) drives_[i]->ethernet->reseed(seed + i);
}

// The board is fitted.
void Plant::wire(DriveUnit& d, std::uint64_t seed) {
  const BoardSpec& spec = *d.spec.board;
  boards::SerialChannel* serial = d.board->serial_channel();
  modbus::Unit* unit = d.board->modbus_unit();
  boards::CanChannel* can = d.board->can_channel();
  if (spec.serial && serial != nullptr) {
    lines_[*spec.serial].add(*serial);
    drives_on_line_[*spec.serial].push_back(&d);
  }
  if (spec.tcp && unit != nullptr) ports_[*spec.tcp]->add(*unit);
  if (spec.can && can == nullptr && spec.can_at.line > 0)
    refuse(spec.can_at, d.spec.name, "board " + spec.type.value + " has no CAN; leave network out, or write none");
  if (spec.can && can != nullptr)
    d.controller = buses_[*spec.can]->add(now(), *can, d.spec.name, [this, &d](Instant at) { settle(at, d); });
  boards::EthernetChannel* ethernet = d.board->ethernet_channel();
  if (!spec.ethernet || ethernet == nullptr) return;
  ethernet_ip::AdapterOptions options;
  options.seed = seed;
  d.station = ethernet;
  d.adapter = std::make_unique<ethernet_ip::Adapter>(ethernet->cip_device(), options);
  d.ethernet = std::make_unique<EthernetIpPort>(scheduler_, *d.adapter, [this, &d](Instant at) { settle(at, d); });
  d.ethernet->reseed(seed);
  auto udp = datagrams_.open({spec.ethernet->address, ethernet_ip::kEncapsulationPort});
  auto io = datagrams_.open({spec.ethernet->address, ethernet_ip::kIoPort});
  if (!udp || !io) refuse(spec.ethernet->at, d.spec.name, (udp ? io : udp).error());
  d.ethernet->connect(std::move(*udp), std::move(*io), EthernetIpPort::Carrier::kInside);
}

Plant::~Plant() {
  if (tick_event_ != 0) scheduler_.cancel(tick_event_);
  for (const auto& d : drives_)
    for (const kernel::EventId id :
         {d->board_event, d->dip_ends, d->power_returns, d->reset_released, d->load_ramp_ends})
      if (id != 0) scheduler_.cancel(id);
}

void Plant::refuse(Position at, const std::string& drive, const std::string& message) const {
  throw PlantFileError(file_.path, {problem(at, drive, message)});
}

std::unique_ptr<DriveUnit> Plant::build(const DriveSpec& spec, const PlantOptions& options,
                                        std::vector<Problem>& problems) {
  auto d = std::make_unique<DriveUnit>();
  d->spec = spec;

  inverter::InverterConfig config;
  config.model = spec.model.value;
  config.motor = spec.motor.value;
  config.load = spec.load.value;
  plant::LossSettings losses = spec.ideal ? plant::LossSettings{} : plant::typical_losses(config.motor);
  losses.viscous_nm_s = spec.friction.viscous_nm_s.value_or(losses.viscous_nm_s);
  losses.coulomb_nm = spec.friction.coulomb_nm.value_or(losses.coulomb_nm);
  losses.iron_loss_w_at_rated = spec.losses.iron_loss_w_at_rated.value_or(losses.iron_loss_w_at_rated);
  losses.inverter_loss_fraction = spec.losses.inverter_loss_fraction.value_or(losses.inverter_loss_fraction);
  losses.standby_w = spec.losses.standby_w.value_or(losses.standby_w);
  config.losses = losses;
  if (spec.mains_v_rms) config.mains = plant::MainsState{.voltage_v_rms = *spec.mains_v_rms};
  config.mains_frequency_hz = spec.mains_frequency_hz;
  config.mains_phase_rad = spec.mains_phase_rad;
  config.voltage_table = spec.voltage_table;
  config.ambient_c = spec.ambient_c;
  config.brake_resistance_ohm = spec.brake_resistor_ohm;
  config.source_resistance_ohm = spec.source_resistance_ohm;
  config.option_fitted = spec.board.has_value();
  if (spec.board && spec.board->connector) config.option_connector = *spec.board->connector;
  config.solver.choice = spec.solver;
  // `node:` stands for the switches and for the factory value of the parameter that overrides them: after all clear or
  // with a damaged EEPROM masters still find the drive where they look for it.
  if (spec.board)
    if (const std::string_view parameter = node_parameter(spec.board->type.value); !parameter.empty())
      config.factory_values.emplace_back(parameter, spec.board->node.value);
  // So do the bus's bit rate and its parameter.
  if (spec.board && spec.board->can)
    if (const auto rate = can_bitrate_value(spec.board->type.value, file_.can[*spec.board->can].bitrate))
      config.factory_values.emplace_back(rate->parameter, rate->value);
  auto made = options.catalogue.make_inverter(spec.family, config);
  if (!made) refuse(spec.model.at, spec.name, made.error());
  d->inverter = std::move(made).value();
  if (const auto set = d->inverter->set_motor_source(spec.motor_source); !set) refuse(spec.at, spec.name, set.error());
  // Not what the plant has now: the breaker is open.
  d->mains =
      config.mains.value_or(plant::MainsState{.voltage_v_rms = d->inverter->plant().config().nominal_mains_v_rms});

  if (spec.board && spec.board->bad_contact)
    if (const auto set = d->inverter->inject_fault("option", true); !set)
      refuse(spec.board->type.at, spec.name, set.error());

  std::optional<std::string> stored;
  if (options.stored_eeprom) stored = options.stored_eeprom(spec.name);
  if (!stored) {
    first_parameters(*d, problems);
  } else if (const auto loaded = d->inverter->load_eeprom(*stored); !loaded) {
    if (options.damaged_eeprom) options.damaged_eeprom(spec.name, loaded.error());
  }
  inputs(*d, problems);

  if (spec.board) {
    boards::BoardConfig board;
    board.type = spec.board->type.value;
    board.node = spec.board->node.value;
    if (const auto& ethernet = spec.board->ethernet) {
      board.serial_number = ethernet->address;
      board.ethernet = ethernet->surroundings;
      board.fast = ethernet->fast;
    }
    auto fitted = options.catalogue.make_board(board, d->inverter->port());
    if (!fitted) refuse(spec.board->node.at, spec.name, fitted.error());
    d->board = std::move(fitted).value();
    if (options.stored_flash && !d->board->flash_text().empty())
      if (const auto flash = options.stored_flash(spec.name))
        if (const auto loaded = d->board->load_flash(*flash); !loaded && options.damaged_flash)
          options.damaged_flash(spec.name, loaded.error());
  }
  return d;
}

// What a drive has when it starts for the first time.
void Plant::first_parameters(DriveUnit& d, std::vector<Problem>& problems) {
  for (const auto& [name, value] : d.spec.parameters)
    if (const auto set = d.inverter->preset_parameter(name.value, value.value); !set)
      problems.push_back(problem(name.at, d.spec.name, set.error()));
}

void Plant::inputs(DriveUnit& d, std::vector<Problem>& problems) {
  for (const auto& [name, on] : d.spec.terminals) {
    if (const auto set = d.inverter->set_terminal(name.value, on); !set) {
      std::vector<std::string_view> known;
      for (const auto& t : d.inverter->terminals()) known.push_back(t.first);
      problems.push_back(problem(name.at, d.spec.name, sentence(set.error()) + suggestion(name.value, known)));
    }
  }
  for (const auto& [name, value] : d.spec.analog)
    if (const auto set = d.inverter->set_analog(name.value, value); !set)
      problems.push_back(problem(name.at, d.spec.name, set.error()));
}

void Plant::start() {
  for (const auto& d : drives_)
    if (d->spec.power) set_power(*d, true);
  tick_event_ = scheduler_.schedule_every(scheduler_.now() + inverter::Inverter::kControlPeriod,
                                          inverter::Inverter::kControlPeriod, kernel::Priority::kDrive,
                                          [this](Instant at) { tick(at); });
}

DriveUnit* Plant::find(std::string_view name) {
  const auto it = std::find_if(drives_.begin(), drives_.end(), [&](const auto& d) { return d->spec.name == name; });
  return it == drives_.end() ? nullptr : it->get();
}

void Plant::connect_serial(std::size_t line, std::unique_ptr<transports::ByteStream> stream, LineOptions options) {
  lines_[line].connect(now(), serial_taps_[line].wrap(std::move(stream)), std::move(options), traffic_of(line));
}

BoardLine::OnTraffic Plant::traffic_of(std::size_t line) {
  return [this, line](Instant at) {
    for (DriveUnit* d : drives_on_line_[line]) settle(at, *d);
  };
}

void Plant::accept_tcp(std::size_t port, Instant now, std::unique_ptr<transports::ByteStream> stream) {
  ports_[port]->accept(now, tcp_taps_[port].wrap(std::move(stream)));
}

WireTap* Plant::serial_tap_of(const DriveUnit& drive) {
  const auto& board = drive.spec.board;
  return board && board->serial && drive.board->serial_channel() != nullptr ? &serial_taps_[*board->serial] : nullptr;
}

WireTap* Plant::tcp_tap_of(const DriveUnit& drive) {
  if (drive.ethernet) return &drive.ethernet->tcp_tap();
  const auto& board = drive.spec.board;
  return board && board->tcp && drive.board->modbus_unit() != nullptr ? &tcp_taps_[*board->tcp] : nullptr;
}

WireTap* Plant::udp_tap_of(const DriveUnit& drive) { return drive.ethernet ? &drive.ethernet->udp_tap() : nullptr; }

CanLine* Plant::can_line_of(const DriveUnit& drive) {
  return drive.controller ? buses_[*drive.spec.board->can].get() : nullptr;
}

void Plant::set_power(DriveUnit& drive, bool on) {
  drive.inverter->set_power(on);
  follow_power(now(), drive);
  settle(now(), drive);
}

void Plant::return_power(DriveUnit& drive) {
  drive.power_returns = 0;
  set_power(drive, true);
}

void Plant::follow_power(Instant now, DriveUnit& d) {
  const bool powered = d.inverter->powered();
  if (powered == d.board_powered || !d.board) return;
  d.board_powered = powered;
  d.board->handle_power(now, powered);
}

void Plant::tick(Instant now) {
  ++ticks_;
  for (const auto& d : drives_) {
    d->inverter->tick(now);
    if (!d->board) continue;
    follow_power(now, *d);
    d->board->handle_drive_tick(now);
    settle(now, *d);
  }
  for (const auto& port : ports_) port->poll(now);
}

void Plant::settle(Instant now, DriveUnit& d) {
  if (!d.board) return;
  if (boards::SerialChannel* channel = d.board->serial_channel(); channel != nullptr && d.spec.board->serial) {
    BoardLine& line = lines_[*d.spec.board->serial];
    while (const auto frame = channel->poll_transmit(now)) line.send(now, *frame);
    line.follow_settings();
  }
  if (d.controller) buses_[*d.spec.board->can]->settle(now, *d.controller);
  if (d.ethernet) follow_ethernet(now, d);
  const auto deadline = d.board->next_deadline();
  if (deadline == d.board_deadline) return;
  if (d.board_event != 0) scheduler_.cancel(d.board_event);
  d.board_deadline = deadline;
  d.board_event = 0;
  if (!deadline) return;
  d.board_event = scheduler_.schedule(std::max(*deadline, now), kernel::Priority::kBoard,
                                      [this, drive = &d](Instant at) { board_timeout(at, *drive); });
}

void Plant::follow_ethernet(Instant now, DriveUnit& d) {
  boards::EthernetChannel& channel = *d.station;
  if (channel.take_restart()) claim_address(now, d, 0);
  const std::uint32_t address = channel.address();
  // Looked at again whenever the cable comes back.
  const bool is_back = channel.has_link() && !d.ethernet->has_link();
  if (address != d.claimed_address || (is_back && is_taken(d, address))) claim_address(now, d, address);
  d.ethernet->set_link(now, channel.has_link());
  d.ethernet->handle_new_data(now);
  if (d.ethernet->take_activity()) channel.handle_activity(now);
}

bool Plant::is_taken(const DriveUnit& d, std::uint32_t address) const {
  return address != 0 && (d.has_double || std::any_of(drives_.begin(), drives_.end(), [&](const auto& other) {
                            return other.get() != &d && other->adapter && other->adapter->is_started() &&
                                   other->claimed_address == address && other->ethernet->has_link();
                          }));
}

// Address conflict detection: who comes later has to go without.
void Plant::claim_address(Instant now, DriveUnit& d, std::uint32_t address) {
  boards::EthernetChannel& channel = *d.station;
  d.claimed_address = address;
  const bool duplicate = channel.has_link() && is_taken(d, address);
  channel.set_duplicate_address(duplicate);
  const EthernetSpec& spec = *d.spec.board->ethernet;
  if (address == 0 || duplicate)
    d.ethernet->stop(now);
  else
    d.ethernet->start(now, {spec.address, spec.surroundings.lease.mask, ethernet_ip::kIoPort});
}

bool Plant::plug_ethernet(DriveUnit& drive, bool plugged) {
  if (!drive.ethernet) return false;
  drive.station->plug(now(), plugged);
  settle(now(), drive);
  return true;
}

void Plant::set_double(DriveUnit& drive, bool there) {
  if (!drive.ethernet || drive.has_double == there) return;
  drive.has_double = there;
  // The drive defends its address in vain, and asks for it again at its next start only.
  if (there && drive.claimed_address != 0 && drive.station->has_link())
    claim_address(now(), drive, drive.claimed_address);
  settle(now(), drive);
}

DriveUnit* Plant::find_address(std::uint32_t address) {
  const auto at = std::find_if(drives_.begin(), drives_.end(), [&](const auto& d) {
    return d->ethernet && d->spec.board->ethernet->address == address;
  });
  return at == drives_.end() ? nullptr : at->get();
}

std::unique_ptr<transports::ByteStream> Plant::connect_tcp(Instant now, const Ipv4Endpoint& from,
                                                           const Ipv4Endpoint& to,
                                                           const transports::MemoryLinkOptions& options) {
  DriveUnit* const drive = to.port == ethernet_ip::kEncapsulationPort ? find_address(to.address) : nullptr;
  if (drive == nullptr) return nullptr;
  auto [board, master] = streams_.connect(options);
  drive->ethernet->accept(now, std::move(board), from);
  return std::move(master);
}

void Plant::board_timeout(Instant now, DriveUnit& d) {
  d.board_event = 0;
  d.board_deadline.reset();
  d.board->handle_timeout(now);
  settle(now, d);
}

void Plant::collect_flashes(const Store& store) {
  for (const auto& d : drives_)
    if (d->board && d->board->take_flash_changed()) store(d->spec.name, d->board->flash_text());
}

void Plant::collect_eeproms(const Store& store) {
  for (const auto& d : drives_)
    if (d->inverter->take_eeprom_changed()) store(d->spec.name, d->inverter->eeprom_text());
}

bool Plant::settled() const {
  return std::all_of(drives_.begin(), drives_.end(),
                     [](const auto& d) { return !d->inverter->powered() || d->inverter->port().ready(); });
}

}  // namespace vinv::rig
