#include "sim/rig/live_can.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/rig/words.hpp"
#include "sim/transports/can/slcan_client.hpp"
#include "sim/transports/can/socketcan_port.hpp"
#include "sim/transports/can/socketcand_client.hpp"
#include "sim/transports/can/udp_multicast_port.hpp"

namespace vinv::rig {
namespace {

using Kind = CanNetwork::Kind;

// Of an adapter's tty. Those with USB take any speed; 115200 is what serial ones are delivered with.
constexpr std::uint32_t kAdapterBaud = 115'200;

template <class T>
Result<std::unique_ptr<transports::CanPort>, std::string> as_port(Result<std::unique_ptr<T>, std::string> opened) {
  if (!opened) return Unexpected(opened.error());
  return std::unique_ptr<transports::CanPort>(std::move(opened).value());
}

Result<std::unique_ptr<transports::CanPort>, std::string> open_port(transports::EventLoop& loop,
                                                                    const CanNetwork& net) {
  using namespace transports;
  switch (net.kind) {
    case Kind::kSocketcan: return as_port(SocketCanPort::open(loop, net.device));
    case Kind::kSocketcand: return as_port(SocketcandClient::open(loop, net.remote.host, net.remote.port, net.device));
    case Kind::kSlcanTcp: return as_port(SlcanClient::open_tcp(loop, net.remote.host, net.remote.port, net.bitrate));
    case Kind::kSlcanTty: return as_port(SlcanClient::open_tty(loop, net.device, kAdapterBaud, net.bitrate));
    case Kind::kUdpMulticast: {
      UdpMulticastOptions options;
      if (!net.device.empty()) options.group = net.device;
      return as_port(UdpMulticastPort::open(loop, options));
    }
    case Kind::kVirtual: break;
  }
  return Unexpected(std::string("a virtual bus is not elsewhere"));
}

CanEndpoint endpoint_elsewhere(const CanNetwork& net) {
  CanEndpoint e;
  e.bitrate = net.bitrate;
  switch (net.kind) {
    case Kind::kVirtual: break;
    case Kind::kSocketcan: e.socketcan = net.device; break;
    case Kind::kSocketcand:
      e.socketcand = host_port(net.remote.host, net.remote.port);
      e.channel = net.device;
      break;
    case Kind::kSlcanTcp: e.slcan = host_port(net.remote.host, net.remote.port); break;
    case Kind::kSlcanTty: e.slcan = net.device; break;
    case Kind::kUdpMulticast:
      e.udp_multicast = net.device.empty() ? transports::UdpMulticastOptions{}.group : net.device;
      break;
  }
  return e;
}

}  // namespace

LiveCan::LiveCan(transports::EventLoop& loop, Plant& plant, const std::string& runtime_folder,
                 std::int64_t start_unix_ns)
    : loop_(loop), plant_(plant), start_unix_ns_(start_unix_ns) {
  const auto& networks = plant.file().can;
  for (const CanNetwork& net : networks) endpoints_.push_back(endpoint_elsewhere(net));
  for (std::size_t i = 0; i < networks.size(); ++i) {
    if (!is_used(i)) continue;
    if (networks[i].kind != Kind::kVirtual) join(i);
    if (networks[i].socketcand && endpoints_[i].channel.empty()) serve_socketcand(i);
    serve_slcan(i, runtime_folder);
  }
  for (const auto& d : plant.drives())
    if (d->controller) d->can = endpoints_[*d->spec.board->can];
}

bool LiveCan::is_used(std::size_t bus) const {
  return std::any_of(plant_.drives().begin(), plant_.drives().end(),
                     [&](const auto& d) { return d->controller && *d->spec.board->can == bus; });
}

void LiveCan::refuse(Position at, const CanNetwork& network, const std::string& why, const std::string& allowed) {
  throw PlantFileError(plant_.file().path, {{at, "network " + network.name + ": " + why + "; allowed: " + allowed}});
}

void LiveCan::join(std::size_t bus) {
  const CanNetwork& net = plant_.file().can[bus];
  auto port = open_port(loop_, net);
  if (!port)
    refuse(net.at, net, port.error(),
           net.kind == Kind::kSocketcan ? "a CAN interface of this machine (`vinverter doctor` lists them), or virtual."
                                        : std::string(kCanWays) + ".");
  plant_.can_line(bus).join(loop_.now(), std::move(port).value());
}

// One server for all buses with this address; port 0 is a server of the bus's own.
void LiveCan::serve_socketcand(std::size_t bus) {
  const auto& networks = plant_.file().can;
  const CanNetwork& net = networks[bus];
  std::vector<std::size_t> served;
  transports::SocketcandOptions options;
  options.start_unix_ns = start_unix_ns_;
  for (std::size_t i = bus; i < networks.size(); ++i) {
    const auto& other = networks[i].socketcand;
    const bool same = other && other->host == net.socketcand->host && other->port == net.socketcand->port;
    if (i != bus && (!same || net.socketcand->port == 0 || !is_used(i))) continue;
    served.push_back(i);
    options.buses.push_back({networks[i].channel, &plant_.can_line(i).bus()});
  }
  auto server =
      transports::SocketcandServer::open(loop_, {net.socketcand->host, net.socketcand->port}, std::move(options));
  if (!server) {
    const bool is_default = net.socketcand->at.line == 0;
    refuse(is_default ? net.at : net.socketcand->at, net, server.error(),
           std::string("another address or port for socketcand (port 0 picks a free one), or none") +
               (is_default ? ", as in networks: { " + net.name + ": { can: virtual, socketcand: \"127.0.0.1:0\" } }."
                           : "."));
  }
  for (const std::size_t i : served) {
    endpoints_[i].socketcand = host_port((*server)->host(), (*server)->port());
    endpoints_[i].channel = networks[i].channel;
  }
  socketcand_.push_back(std::move(server).value());
}

void LiveCan::serve_slcan(std::size_t bus, const std::string& runtime_folder) {
  const CanNetwork& net = plant_.file().can[bus];
  if (net.slcan_pty) {
    const std::string link = runtime_folder + "/" + net.name + ".slcan";
    auto pty = transports::SlcanPty::open(loop_, link, plant_.can_line(bus).bus());
    if (!pty) refuse(net.at, net, pty.error(), "an address and port for slcan, or none.");
    endpoints_[bus].slcan = link;
    slcan_ptys_.push_back(std::move(pty).value());
  }
  if (!net.slcan) return;
  auto server = transports::SlcanServer::open(loop_, {net.slcan->host, net.slcan->port}, plant_.can_line(bus).bus());
  if (!server)
    refuse(net.slcan->at, net, server.error(), "another address or port for slcan (port 0 picks a free one), or none.");
  endpoints_[bus].slcan = host_port((*server)->host(), (*server)->port());
  slcan_.push_back(std::move(server).value());
}

void LiveCan::record(const std::string& what) {
  const auto& networks = plant_.file().can;
  std::vector<std::size_t> recorded;
  std::vector<std::string_view> names;
  std::string file = what;
  const std::size_t equals = what.find('=');
  const std::string only = equals == std::string::npos ? "" : what.substr(0, equals);
  for (std::size_t i = 0; i < networks.size(); ++i) {
    if (!is_used(i)) continue;
    names.push_back(networks[i].name);
    if (networks[i].name == only) recorded.push_back(i), file = what.substr(equals + 1);
  }
  if (recorded.empty() && is_plant_word(only))
    throw std::runtime_error("--record-can " + what + ": there is no CAN network \"" + only + "\" with drives; " +
                             allowed_words(only, names));
  for (std::size_t i = 0; recorded.empty() && i < networks.size(); ++i)
    if (is_used(i)) recorded.push_back(i);
  if (recorded.empty()) throw std::runtime_error("--record-can " + what + ": no drive is on a CAN bus.");

  std::shared_ptr<transports::CandumpLog> log;
  std::shared_ptr<transports::CaptureFile> capture;
  const auto keep = [](auto created, auto& to, auto& list) {
    if (!created) throw std::runtime_error(created.error());
    list.push_back(to = std::move(created).value());
  };
  if (file.ends_with(".log"))
    keep(transports::CandumpLog::create(file, start_unix_ns_), log, logs_);
  else if (file.ends_with(".pcapng"))
    keep(transports::CaptureFile::create(file, start_unix_ns_), capture, captures_);
  else
    throw std::runtime_error("--record-can " + what + ": allowed: a file that ends in .log (candump) or .pcapng.");
  for (const std::size_t i : recorded) {
    const CanNetwork& net = networks[i];
    plant_.can_line(i).bus().observe(
        std::make_shared<transports::CanRecorder>(net.channel.empty() ? net.device : net.channel, log, capture));
  }
}

std::string LiveCan::recording_failure() const {
  for (const auto& log : logs_)
    if (!log->error().empty()) return log->error();
  for (const auto& capture : captures_)
    if (!capture->error().empty()) return capture->error();
  return {};
}

}  // namespace vinv::rig
