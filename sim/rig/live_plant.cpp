#include "sim/rig/live_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "sim/rig/folders.hpp"
#include "sim/rig/words.hpp"
#include "sim/transports/serial_pty.hpp"
#include "sim/transports/serial_tty.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;

// Between a parameter write and its way to the disk.
constexpr Duration kHousekeepingInterval = milliseconds(100);
constexpr Duration kReadyInterval = milliseconds(5);
// A drive that never starts up (dead mains, storage alarm) must not keep the others from being announced.
constexpr Duration kReadyTimeout = std::chrono::seconds(10);
// FIFO and latency timer of common USB adapters.
constexpr Duration kTtySlack = milliseconds(20);

transports::LineSettings transport_settings(const boards::LineSettings& s) {
  using Parity = transports::LineSettings::Parity;
  transports::LineSettings out;
  out.baud = s.baud;
  out.parity = s.parity == boards::LineSettings::Parity::kNone  ? Parity::kNone
               : s.parity == boards::LineSettings::Parity::kOdd ? Parity::kOdd
                                                                : Parity::kEven;
  return out;
}

double kilobit(std::uint32_t bitrate) { return bitrate / 1000.0; }

// How a person reaches the node: reads its device type (1000H), or listens.
std::string can_table(const DriveUnit& d, bool bus_is_ours) {
  const CanEndpoint& can = *d.can;
  const unsigned node = d.can_node();
  std::string out = fmt::format("  CANopen     node {}, {} kbit/s\n", node, kilobit(can.bitrate));
  const auto python = [&](std::string_view where, const std::string& bus) {
    out += fmt::format(
        "              {}\n              python3 -c \"import can; b=can.Bus({}); "
        "b.send(can.Message(arbitration_id=0x{:X},is_extended_id=False,data=[64,0,16,0,0,0,0,0])); "
        "[print(m) for m in iter(lambda:b.recv(1),None)]; b.shutdown()\"\n",
        where, bus, 0x600 + node);
  };
  if (!can.socketcan.empty())
    out += fmt::format(
        "              socketcan {}\n              candump {}\n              cansend {} {:03X}#4000100000000000\n",
        can.socketcan, can.socketcan, can.socketcan, 0x600 + node);
  if (!can.socketcand.empty()) {
    const auto at = parse_host_port(can.socketcand);
    python(fmt::format("socketcand {} channel {}", can.socketcand, can.channel),
           fmt::format("interface='socketcand',host='{}',port={},channel='{}'", at->host, at->port, can.channel));
  }
  if (can.slcan.starts_with("/"))
    out += fmt::format("              slcan {}\n              slcand -o {} slcan0\n", can.slcan, can.slcan);
  else if (!can.slcan.empty())
    python("slcan " + can.slcan,
           fmt::format("interface='slcan',channel='socket://{}',bitrate={}", can.slcan, can.bitrate));
  if (!can.udp_multicast.empty())
    python("udp_multicast " + can.udp_multicast,
           fmt::format("interface='udp_multicast',channel='{}'", can.udp_multicast));
  const std::uint32_t own = d.board->can_channel()->bit_rate();
  if (bus_is_ours && own != 0 && own != can.bitrate)
    out += fmt::format("              the board is set to {} kbit/s and cannot communicate\n", kilobit(own));
  return out;
}

template <class T>
T opened(Result<T, std::string> result) {
  if (!result) throw std::runtime_error(result.error());
  return std::move(result).value();
}

}  // namespace

LivePlant::LivePlant(transports::EventLoop& loop, PlantFile file, const Catalogue& catalogue,
                     const LiveOptions& options, Notice notice)
    : loop_(loop), notice_(std::move(notice)) {
  const std::string runtime =
      options.runtime_folder.empty() ? default_runtime_folder(file.name) : options.runtime_folder;
  store_ = std::make_unique<EepromStore>(options.state_folder.empty() ? default_state_folder(file.name)
                                                                      : options.state_folder);
  PlantOptions plant_options;
  plant_options.catalogue = catalogue;
  plant_options.seed = options.seed;
  plant_options.clock = [this] { return loop_.now(); };
  if (!options.fresh) plant_options.stored_eeprom = [this](const std::string& drive) { return store_->load(drive); };
  plant_options.damaged_eeprom = [this](const std::string& drive, const std::string& reason) {
    notice_(drive + ": the stored EEPROM is damaged: " + sentence(reason) + " It is kept as " +
            store_->keep_aside(drive) + "; the drive starts with factory values and its storage alarm.");
  };
  if (!options.fresh)
    plant_options.stored_flash = [this](const std::string& drive) { return store_->load(drive, Memory::kFlash); };
  plant_options.damaged_flash = [this](const std::string& drive, const std::string& reason) {
    notice_(drive + ": the stored memory of the option board is damaged: " + sentence(reason) + " It is kept as " +
            store_->keep_aside(drive, Memory::kFlash) + "; the board starts as it came.");
  };
  plant_ = std::make_unique<Plant>(std::move(file), loop_.scheduler(), std::move(plant_options));
  if (options.fresh)
    for (const auto& d : plant_->drives()) {
      store_->store(d->spec.name, d->inverter->eeprom_text());
      if (d->board && !d->board->flash_text().empty())
        store_->store(d->spec.name, d->board->flash_text(), Memory::kFlash);
    }

  make_private_folder(runtime);
  control_ = std::make_unique<ControlServer>(*plant_);
  control_listener_ = opened(transports::UnixSocketListener::open(
      loop_, runtime + "/" + kControlSocketName, [this](Instant now, std::unique_ptr<transports::ByteStream> stream) {
        control_->accept(now, std::move(stream));
      }));
  open_tcp(options);
  open_ethernet_ip();
  open_serial(runtime);
  can_ = std::make_unique<LiveCan>(loop_, *plant_, runtime, start_unix_ns());
  for (const std::string& what : options.record_can) can_->record(what);
  plant_->start();
  schedule_housekeeping();
}

LivePlant::~LivePlant() {
  for (const kernel::EventId id : {housekeeping_, ready_check_})
    if (id != 0) loop_.scheduler().cancel(id);
}

// What simulated zero is, in nanoseconds since 1970.
std::int64_t LivePlant::start_unix_ns() const {
  const auto unix_now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(unix_now).count() - to_ns(loop_.now());
}

void LivePlant::open_tcp(const LiveOptions& options) {
  if (!options.record_ip.empty()) {
    recorder_ = opened(transports::IpRecorder::open(options.record_ip, start_unix_ns()));
  }
  for (std::size_t i = 0; i < plant_->file().tcp.size(); ++i) {
    const bool used = std::any_of(plant_->drives().begin(), plant_->drives().end(),
                                  [&](const auto& d) { return d->spec.board && d->spec.board->tcp == i; });
    if (!used) continue;
    const TcpNetwork& net = plant_->file().tcp[i];
    transports::TcpListenerOptions listen;
    listen.host = net.host;
    listen.port = net.port;
    // The bound port is known once open() has returned, and nothing is accepted before the loop runs.
    const auto bound = std::make_shared<TcpEndpoint>();
    tcp_.push_back(opened(transports::TcpListener::open(
        loop_, listen, [this, i, bound](Instant now, std::unique_ptr<transports::ByteStream> stream) {
          if (recorder_) stream = recorder_->wrap(now, std::move(stream), bound->host, bound->port);
          plant_->accept_tcp(i, now, std::move(stream));
        })));
    *bound = {tcp_.back()->host(), tcp_.back()->port()};
    for (const auto& d : plant_->drives())
      if (d->spec.board && d->spec.board->tcp == i) d->tcp = *bound;
  }
}

void LivePlant::open_ethernet_ip() {
  ethernet_ip_ = std::make_unique<LiveEthernetIp>(loop_, recorder_.get());
  for (const auto& d : plant_->drives()) {
    if (!d->ethernet) continue;
    const EthernetSpec& spec = *d->spec.board->ethernet;
    EthernetIpAddress where;
    where.address = spec.address;
    where.any_address = spec.any_address;
    std::string notice;
    if (const auto added = ethernet_ip_->add(*d->ethernet, where, &notice); !added)
      throw PlantFileError(plant_->file().path,
                           {{spec.at, d->spec.name + ": EtherNet/IP at " + ipv4_text(spec.address) +
                                          " cannot be opened: " + sentence(added.error()) +
                                          " Each adapter needs TCP and UDP port 44818 and UDP port 2222 of its own "
                                          "address; give the drive another one with address in board."}});
    if (!notice.empty()) notice_(d->spec.name + ": " + sentence(notice));
    d->ethernet_ip = EthernetIpEndpoint{ipv4_text(spec.address)};
  }
}

void LivePlant::open_serial(const std::string& runtime_folder) {
  for (std::size_t i = 0; i < plant_->file().serial.size(); ++i) {
    const bool used = std::any_of(plant_->drives().begin(), plant_->drives().end(),
                                  [&](const auto& d) { return d->spec.board && d->spec.board->serial == i; });
    if (used) open_line(i, runtime_folder);
  }
}

void LivePlant::open_line(std::size_t index, const std::string& runtime_folder) {
  const SerialNetwork& net = plant_->file().serial[index];
  std::unique_ptr<transports::SerialLine> line;
  LineOptions options;
  std::string path;
  if (net.device == "pty") {
    transports::SerialPtyOptions pty;
    pty.link = runtime_folder + "/" + net.name + ".tty";
    path = pty.link;
    line = opened(transports::SerialPty::open(loop_, pty));
  } else {
    transports::SerialTtyOptions tty;
    tty.path = path = net.device;
    auto port = opened(transports::SerialTty::open(loop_, tty));
    port->set_notice([this](Instant, const std::string& sentence) { notice_(sentence); });
    options.receive_slack = kTtySlack;
    line = std::move(port);
  }
  transports::SerialLine* carrier = line.get();  // lives as long as the plant's line
  options.far_end_baud = [carrier]() -> std::optional<std::uint32_t> {
    const auto peer = carrier->peer_settings();
    return peer ? std::optional(peer->baud) : std::nullopt;
  };
  options.on_settings = [this, carrier](const boards::LineSettings& settings) {
    const auto set = carrier->set_line_settings(transport_settings(settings));
    if (!set) notice_(sentence(set.error()));
  };
  plant_->connect_serial(index, std::move(line), std::move(options));
  for (const auto& d : plant_->drives())
    if (d->spec.board && d->spec.board->serial == index) d->serial = SerialEndpoint{path};
}

void LivePlant::schedule_housekeeping() {
  housekeeping_ =
      loop_.scheduler().schedule_every(loop_.scheduler().now() + kHousekeepingInterval, kHousekeepingInterval,
                                       kernel::Priority::kObserver, [this](Instant) { keep_house(); });
}

void LivePlant::collect_memories() {
  plant_->collect_eeproms(
      [this](const std::string& drive, std::string text) { store_->store(drive, std::move(text)); });
  plant_->collect_flashes(
      [this](const std::string& drive, std::string text) { store_->store(drive, std::move(text), Memory::kFlash); });
}

void LivePlant::keep_house() {
  collect_memories();
  if (const std::string failure = store_->take_failure(); !failure.empty()) notice_(failure);
  if (recording_failed_) return;
  const std::string failure = can_->recording_failure();
  recording_failed_ = !failure.empty();
  if (recording_failed_) notice_("recording of CAN ended: " + sentence(failure));
}

void LivePlant::when_ready(std::function<void()> ready) {
  const Instant give_up = loop_.scheduler().now() + kReadyTimeout;
  ready_check_ = loop_.scheduler().schedule_every(loop_.scheduler().now() + kReadyInterval, kReadyInterval,
                                                  kernel::Priority::kObserver,
                                                  [this, give_up, ready = std::move(ready)](Instant now) {
                                                    if (!plant_->settled() && now < give_up) return;
                                                    const auto call = ready;  // the action may end with its event
                                                    loop_.scheduler().cancel(std::exchange(ready_check_, 0));
                                                    call();
                                                  });
}

std::string LivePlant::store_eeproms() {
  collect_memories();
  return store_->flush();
}

Json LivePlant::ready_json() const {
  Json out;
  out["drives"] = Json::array();
  for (const auto& d : plant_->drives())
    out["drives"].push_back({{"name", d->spec.name},
                             {"family", d->inverter->family()},
                             {"board", d->board ? Json(d->board->type()) : Json()},
                             {"endpoints", endpoints_json(*d)}});
  out["control"] = control_path();
  return out;
}

std::string LivePlant::table() const {
  std::string out;
  for (const auto& d : plant_->drives()) {
    out += fmt::format("{}  {} {}, motor {}\n", d->spec.name, d->inverter->family(), d->inverter->model(),
                       d->spec.motor.value.name);
    if (d->tcp) {
      out +=
          fmt::format("  Modbus/TCP  {} unit {}\n              mbpoll -m tcp -p {} -a {} -0 -r 24000 -c 1 -t 4 -1 {}\n",
                      host_port(d->tcp->host, d->tcp->port), d->unit(), d->tcp->port, d->unit(), d->tcp->host);
    }
    if (d->serial) {
      const auto line = d->board->serial_channel()->line_settings();
      using Parity = boards::LineSettings::Parity;
      const char* parity = line.parity == Parity::kNone ? "none" : line.parity == Parity::kOdd ? "odd" : "even";
      out += fmt::format(
          "  Modbus RTU  {} unit {}, {} baud, parity {}\n              mbpoll -m rtu -b {} -P {} -a {} -0 -r 24000 -c "
          "1 -t 4 -1 {}\n",
          d->serial->path, d->unit(), line.baud, parity, line.baud, parity, d->unit(), d->serial->path);
    }
    if (d->ethernet_ip)
      out += fmt::format(
          "  EtherNet/IP {0} TCP and UDP {1}, I/O on UDP {2}\n              python3 -c \"import socket; "
          "s=socket.socket(socket.AF_INET,socket.SOCK_DGRAM); s.settimeout(2); "
          "s.sendto(bytes([0x63]+23*[0]),('{0}',{1})); "
          "print(s.recv(1500)[63:-1])\"\n",
          d->ethernet_ip->host, d->ethernet_ip->tcp, d->ethernet_ip->udp_io);
    if (d->can) out += can_table(*d, plant_->file().can[*d->spec.board->can].kind == CanNetwork::Kind::kVirtual);
    if (!d->board) out += "  no option board\n";
  }
  return out;
}

}  // namespace vinv::rig
