#include "sim/rig/network_reader.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

// Of the name by which socketcand clients open a bus: that of a network interface.
constexpr std::size_t kMaxChannel = 15;
constexpr std::array<std::string_view, 4> kCanKeys{"bitrate", "socketcand", "slcan", "channel"};

TcpNetwork default_socketcand() { return {"127.0.0.1", kDefaultSocketcandPort, {}}; }

}  // namespace

std::string_view NetworkReader::words(Kind kind) {
  switch (kind) {
    case Kind::kSerial: return "serial network";
    case Kind::kModbusTcp: return "modbus_tcp network";
    case Kind::kCan: return "can network";
  }
  return {};
}

void NetworkReader::read(const YAML::Node& node) {
  const YamlMap map(node, "networks", nullptr, problems_);
  for (const auto& entry : map.entries()) {
    if (!is_plant_word(entry.key)) {
      problems_.add(entry.at, "name of a network is \"" + entry.key +
                                  "\"; allowed: a letter, then letters, digits, _ and -, 64 in all.");
      continue;
    }
    if (entry.empty) continue;
    const YamlMap net(entry.value, "network " + entry.key, &plant_file_keys().at("networks.*"), problems_);
    if (!net) continue;
    const int kinds = int{net.has("serial")} + int{net.has("modbus_tcp")} + int{net.has("can")};
    if (kinds != 1) {
      problems_.add(entry.at, "network " + entry.key + (kinds == 0 ? " has no kind" : " has several kinds") +
                                  "; allowed: one of serial (pty or a device), modbus_tcp (address:port) and can (" +
                                  std::string(kCanWays) + ").");
      continue;
    }
    if (!net.has("can"))
      for (const std::string_view key : kCanKeys)
        if (net.has(key))
          problems_.add(net.key_position(key),
                        std::string(key) + " in network " + entry.key + " belongs to a can network only.");
    if (const auto device = net.text("serial")) serial(net, entry.key, *device);
    if (const auto text = net.text("modbus_tcp")) modbus_tcp(net, entry.key, *text);
    if (const auto way = net.text("can")) can(net, entry.key, *way);
  }
}

void NetworkReader::serial(const YamlMap& net, const std::string& name, const std::string& device) {
  if (device != "pty" && !device.starts_with("/dev/")) {
    problems_.add(*net.find("serial"),
                  "serial in network " + name + " is \"" + device + "\"; allowed: pty, or a device as /dev/ttyUSB0.");
    return;
  }
  named_.push_back({name, Kind::kSerial, file_.serial.size()});
  file_.serial.push_back({name, device, position_of(*net.find("serial"))});
}

void NetworkReader::modbus_tcp(const YamlMap& net, const std::string& name, const std::string& text) {
  const auto tcp = address(*net.find("modbus_tcp"), "modbus_tcp in network " + name, text, "127.0.0.1:1502");
  if (!tcp) return;
  named_.push_back({name, Kind::kModbusTcp, file_.tcp.size()});
  file_.tcp.push_back(*tcp);
}

void NetworkReader::can(const YamlMap& net, const std::string& name, const std::string& way) {
  auto bus = parse_can_way(way);
  if (!bus) {
    problems_.add(*net.find("can"), "can in network " + name + " is \"" + way + "\"; allowed: " +
                                        std::string(kCanWays) + "." + suggestion(way, {"virtual", "udp_multicast"}));
    return;
  }
  bus->name = name;
  bus->channel = name;
  bus->at = position_of(*net.find("can"));
  if (bus->kind == CanNetwork::Kind::kVirtual) bus->socketcand = default_socketcand();
  if (const auto word = net.text("bitrate")) {
    if (const auto bitrate = parse_can_bitrate(*word))
      bus->bitrate = *bitrate;
    else
      problems_.add(*net.find("bitrate"), "bitrate in network " + name + " is \"" + *word +
                                              "\"; allowed: " + std::string(kCanBitrateWords) + ".");
  }
  if (const auto text = net.text("socketcand")) {
    bus->socketcand.reset();
    if (*text != "none")
      bus->socketcand = address(*net.find("socketcand"), "socketcand in network " + name, *text, "127.0.0.1:29536");
  }
  if (const auto text = net.text("slcan")) {
    bus->slcan_pty = *text == "pty";
    if (*text != "none" && *text != "pty")
      bus->slcan = address(*net.find("slcan"), "slcan in network " + name, *text, "127.0.0.1:3333");
  }
  if (const auto channel = net.text("channel")) bus->channel = *channel;
  if (bus->socketcand && (!is_plant_word(bus->channel) || bus->channel.size() > kMaxChannel))
    problems_.add(
        net.has("channel") ? *net.find("channel") : *net.find("can"),
        "channel of network " + name + " is \"" + bus->channel +
            "\"; allowed: a letter, then letters, digits, _ and -, 15 in all, as socketcand clients open it.");
  named_.push_back({name, Kind::kCan, file_.can.size()});
  file_.can.push_back(std::move(*bus));
}

std::optional<TcpNetwork> NetworkReader::address(const YAML::Node& node, const std::string& what,
                                                 const std::string& text, std::string_view example) {
  auto tcp = parse_host_port(text);
  if (!tcp) {
    const std::string port(example.substr(example.rfind(':')));
    problems_.add(node, what + " is \"" + text + "\"; allowed: address:port, as " + std::string(example) + ", [::1]" +
                            port + " or 0.0.0.0" + port + "; port 0 to 65535, 0 picks a free one.");
    return {};
  }
  tcp->at = position_of(node);
  return tcp;
}

std::vector<std::string_view> NetworkReader::names(Kind kind) const {
  std::vector<std::string_view> out;
  for (const Named& n : named_)
    if (n.kind == kind) out.push_back(n.name);
  return out;
}

const NetworkReader::Named* NetworkReader::find(std::string_view name) const {
  const auto it = std::find_if(named_.begin(), named_.end(), [&](const Named& n) { return n.name == name; });
  return it == named_.end() ? nullptr : &*it;
}

std::string NetworkReader::other_kind(const Named& named, std::string_view key, const DriveSpec& drive) const {
  return std::string(key) + " of " + drive.name + " is \"" + named.name + "\", which is a " +
         std::string(words(named.kind)) + "; allowed: ";
}

std::optional<std::size_t> NetworkReader::serial_line(const std::string& text, const YAML::Node* node,
                                                      const DriveSpec& d) {
  if (text == "none") return {};
  const Position at = node == nullptr ? d.at : position_of(*node);
  if (text == "pty") {
    file_.serial.push_back({d.name, "pty", at});
    return file_.serial.size() - 1;
  }
  if (text.starts_with("/dev/")) {
    for (std::size_t i = 0; i < file_.serial.size(); ++i)
      if (file_.serial[i].device == text) return i;
    file_.serial.push_back({d.name, text, at});
    return file_.serial.size() - 1;
  }
  const Named* named = find(text);
  if (named != nullptr && named->kind == Kind::kSerial) return named->index;
  auto allowed = names(Kind::kSerial);
  allowed.insert(allowed.end(), {"pty", "none"});
  if (named != nullptr)
    problems_.add(at, other_kind(*named, "modbus_rtu", d) + "a device as /dev/ttyUSB0, " + join(allowed) + ".");
  else
    problems_.add(at, "modbus_rtu of " + d.name + " is \"" + text + "\"; allowed: a device as /dev/ttyUSB0, " +
                          join(allowed) + "." + suggestion(text, allowed));
  return {};
}

std::optional<std::size_t> NetworkReader::tcp_port(const std::string& text, const YAML::Node* node,
                                                   const DriveSpec& d) {
  if (text == "none") return {};
  const Position at = node == nullptr ? d.at : position_of(*node);
  if (const Named* named = find(text)) {
    if (named->kind == Kind::kModbusTcp) return named->index;
    problems_.add(at, other_kind(*named, "modbus_tcp", d) + "address:port, none, or a modbus_tcp network.");
    return {};
  }
  auto tcp = parse_host_port(text);
  if (!tcp) {
    auto allowed = names(Kind::kModbusTcp);
    allowed.push_back("none");
    problems_.add(at, "modbus_tcp of " + d.name + " is \"" + text +
                          "\"; allowed: address:port (127.0.0.1:1502; port 0 to 65535, 0 picks a free one), " +
                          join(allowed) + "." + suggestion(text, allowed));
    return {};
  }
  tcp->at = at;
  // One address is one port for all who name it; port 0 written out is a port of the drive's own.
  if (tcp->port != 0) {
    for (std::size_t i = 0; i < file_.tcp.size(); ++i)
      if (file_.tcp[i].host == tcp->host && file_.tcp[i].port == tcp->port) return i;
  }
  file_.tcp.push_back(*tcp);
  return file_.tcp.size() - 1;
}

std::optional<std::size_t> NetworkReader::can_bus(const std::string& text, const YAML::Node* node, const DriveSpec& d) {
  if (text == "none") return {};
  const Position at = node == nullptr ? d.at : position_of(*node);
  if (const Named* named = find(text)) {
    if (named->kind == Kind::kCan) return named->index;
    problems_.add(at, other_kind(*named, "network", d) + "none, or a can network.");
    return {};
  }
  // A bus that is elsewhere is one for all who name it; a bus of ours has a name.
  auto way = parse_can_way(text);
  if (way && way->kind != CanNetwork::Kind::kVirtual) {
    for (std::size_t i = 0; i < file_.can.size(); ++i)
      if (text_of(file_.can[i]) == text_of(*way)) return i;
    way->name = text_of(*way);
    way->at = at;
    file_.can.push_back(std::move(*way));
    return file_.can.size() - 1;
  }
  if (node != nullptr && text != kDefaultCanName) {
    auto allowed = names(Kind::kCan);
    allowed.insert(allowed.end(), {kDefaultCanName, "none"});
    problems_.add(at, "network of " + d.name + " is \"" + text + "\"; allowed: " + join(allowed) +
                          ", or a bus elsewhere, as socketcan:vcan0." + suggestion(text, allowed));
    return {};
  }
  CanNetwork bus;
  bus.name = bus.channel = kDefaultCanName;
  bus.socketcand = default_socketcand();
  bus.at = at;
  named_.push_back({bus.name, Kind::kCan, file_.can.size()});
  file_.can.push_back(std::move(bus));
  return file_.can.size() - 1;
}

// A socketcand server tells its buses apart by their channel; an slcan server has one bus.
void NetworkReader::check_can_endpoints() {
  std::map<std::string, std::string> socketcand, slcan;
  for (const CanNetwork& net : file_.can) {
    if (net.socketcand && net.socketcand->port != 0) {
      const std::string where = host_port(net.socketcand->host, net.socketcand->port);
      const auto [first, fresh] = socketcand.emplace(where + "/" + net.channel, net.name);
      if (!fresh)
        problems_.add(net.at, "network " + net.name + " has the socketcand channel \"" + net.channel +
                                  "\" of network " + first->second + " at " + where +
                                  "; allowed: another channel, or another address.");
    }
    if (net.slcan && net.slcan->port != 0) {
      const std::string where = host_port(net.slcan->host, net.slcan->port);
      const auto [first, fresh] = slcan.emplace(where, net.name);
      if (!fresh)
        problems_.add(net.slcan->at, "slcan in network " + net.name + " is \"" + where + "\", which network " +
                                         first->second + " has; allowed: an address for each bus.");
    }
  }
}

}  // namespace vinv::rig
