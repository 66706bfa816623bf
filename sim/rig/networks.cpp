#include "sim/rig/networks.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

struct Bitrate {
  std::string_view word;
  std::uint32_t bitrate;
};
constexpr std::array kBitrates{Bitrate{"20k", 20'000},   Bitrate{"50k", 50'000},   Bitrate{"62.5k", 62'500},
                               Bitrate{"100k", 100'000}, Bitrate{"125k", 125'000}, Bitrate{"250k", 250'000},
                               Bitrate{"500k", 500'000}, Bitrate{"1M", 1'000'000}};

bool is_ipv4(std::string_view host) {
  int parts = 0;
  for (std::size_t at = 0; at <= host.size(); ++parts) {
    const std::size_t dot = std::min(host.find('.', at), host.size());
    const std::string_view octet = host.substr(at, dot - at);
    double value = 0;
    if (octet.empty() || octet.size() > 3 || octet.find_first_not_of("0123456789") != std::string_view::npos ||
        !parse_number(octet, value) || value > 255)
      return false;
    at = dot + 1;
  }
  return parts == 4;
}

bool is_ipv6(std::string_view host) {
  return host.find_first_not_of("0123456789abcdefABCDEF:.") == std::string_view::npos &&
         host.find(':') != std::string_view::npos;
}

// Of a network interface or of a socketcand server's bus: no blanks, no slash, at most 15 characters.
bool is_interface_name(std::string_view name) {
  constexpr std::size_t kMaxName = 15;
  return !name.empty() && name.size() <= kMaxName && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c > ' ' && c < 127 && c != '/' && c != ':' && c != '<' && c != '>';
  });
}

bool starts(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

}  // namespace

std::optional<TcpNetwork> parse_host_port(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return {};
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  double number = 0;
  if (!parse_number(port, number) || number < 0 || number > 65535 || port.find('.') != std::string_view::npos)
    return {};
  TcpNetwork net;
  net.port = static_cast<std::uint16_t>(number);
  if (host == "localhost") host = "127.0.0.1";
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
    if (!is_ipv6(host)) return {};
  } else if (!is_ipv4(host)) {
    return {};
  }
  net.host = host;
  return net;
}

std::string host_port(const std::string& host, std::uint16_t port) {
  const bool is_v6 = host.find(':') != std::string::npos;
  return (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::optional<CanNetwork> parse_can_way(std::string_view text) {
  using Kind = CanNetwork::Kind;
  CanNetwork net;
  if (text == "virtual") return net;
  if (starts(text, "socketcand:")) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos || !is_interface_name(text.substr(slash + 1))) return {};
    const auto remote = parse_host_port(text.substr(0, slash));
    if (!remote || remote->port == 0) return {};
    net.kind = Kind::kSocketcand;
    net.remote = *remote;
    net.device = text.substr(slash + 1);
    return net;
  }
  if (starts(text, "socketcan:")) {
    if (!is_interface_name(text)) return {};
    net.kind = Kind::kSocketcan;
    net.device = text;
    return net;
  }
  if (starts(text, "slcan:")) {
    if (text.starts_with("/dev/") && text.size() > 5) {
      net.kind = Kind::kSlcanTty;
      net.device = text;
      return net;
    }
    const auto remote = parse_host_port(text);
    if (!remote || remote->port == 0) return {};
    net.kind = Kind::kSlcanTcp;
    net.remote = *remote;
    return net;
  }
  if (text == "udp_multicast") {
    net.kind = Kind::kUdpMulticast;
    return net;
  }
  if (starts(text, "udp_multicast:") && (is_ipv4(text) || is_ipv6(text))) {
    net.kind = Kind::kUdpMulticast;
    net.device = text;
    return net;
  }
  return {};
}

std::string text_of(const CanNetwork& network) {
  using Kind = CanNetwork::Kind;
  switch (network.kind) {
    case Kind::kVirtual: return "virtual";
    case Kind::kSocketcan: return "socketcan:" + network.device;
    case Kind::kSocketcand:
      return "socketcand:" + host_port(network.remote.host, network.remote.port) + "/" + network.device;
    case Kind::kSlcanTcp: return "slcan:" + host_port(network.remote.host, network.remote.port);
    case Kind::kSlcanTty: return "slcan:" + network.device;
    case Kind::kUdpMulticast: return network.device.empty() ? "udp_multicast" : "udp_multicast:" + network.device;
  }
  return {};
}

std::optional<std::uint32_t> parse_can_bitrate(std::string_view text) {
  for (const Bitrate& row : kBitrates)
    if (text == row.word || text == std::to_string(row.bitrate)) return row.bitrate;
  return {};
}

}  // namespace vinv::rig
