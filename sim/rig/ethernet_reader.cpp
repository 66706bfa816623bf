#include "sim/rig/ethernet_reader.hpp"

#include <map>
#include <set>

#include "sim/base/ipv4.hpp"
#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

constexpr std::uint32_t kFirstAddress = ipv4(127, 0, 0, 2);
constexpr std::size_t kMostNameCharacters = 48;  // FR-A7NE manual, 7.8.2

bool is_host(std::uint32_t address) {
  const std::uint32_t first = address >> 24;
  return first != 0 && first < 224 && address != 0xffffffff;
}

// By the address's class, as a router of the time has it; the loopback network is one.
std::uint32_t mask_of(std::uint32_t address) {
  const std::uint32_t first = address >> 24;
  return first < 128 ? 0xff000000 : first < 192 ? 0xffff0000 : 0xffffff00;
}

std::uint32_t read_address(const YamlMap& map, std::string_view key, Problems& problems) {
  const auto text = map.text(key);
  if (!text) return 0;
  const auto address = parse_ipv4(*text);
  if (address && is_host(*address)) return *address;
  problems.add(*map.find(key), std::string(key) + " in " + map.where() + " is \"" + *text +
                                   "\"; allowed: the IPv4 address of one host, as 127.0.0.2 or 192.168.1.10.");
  return 0;
}

std::string read_name(const YamlMap& map, std::string_view key, Problems& problems) {
  const auto name = map.text(key);
  if (!name || name->size() <= kMostNameCharacters) return name.value_or("");
  problems.add(*map.find(key), std::string(key) + " in " + map.where() + " has " + std::to_string(name->size()) +
                                   " characters; allowed: at most " + std::to_string(kMostNameCharacters) + ".");
  return {};
}

std::optional<boards::LineSetting> read_line(const YamlMap& map, std::string_view key) {
  const auto word = map.word(key, boards::line_setting_words());
  return word ? boards::parse_line_setting(*word) : std::nullopt;
}

void read_ip(const YamlMap& map, boards::IpConfiguration& ip, Problems& problems) {
  ip.address = read_address(map, "address", problems);
  ip.gateway = read_address(map, "gateway", problems);
  ip.name_server = read_address(map, "name_server", problems);
  ip.name_server_2 = read_address(map, "name_server_2", problems);
  ip.domain = read_name(map, "domain", problems);
  if (const auto text = map.text("mask")) {
    const auto mask = parse_ipv4(*text);
    if (mask && *mask != 0 && (~*mask & (~*mask + 1)) == 0)
      ip.mask = *mask;
    else
      problems.add(*map.find("mask"), "mask in " + map.where() + " is \"" + *text +
                                          "\"; allowed: a network mask without gaps, as 255.255.255.0.");
  }
  if (ip.mask == 0 && ip.address != 0) ip.mask = mask_of(ip.address);
}

void read_lease(const YAML::Node& node, const DriveSpec& drive, boards::IpConfiguration& lease, Problems& problems) {
  const YamlMap map(node, "lease of " + drive.name, &plant_file_keys().at("drives[].board.lease"), problems);
  if (map) read_ip(map, lease, problems);
}

// With an address it is that one, not DHCP, unless the file says so.
void read_flash(const YAML::Node& node, const DriveSpec& drive, boards::Flash& flash, Problems& problems) {
  const YamlMap map(node, "flash of " + drive.name, &plant_file_keys().at("drives[].board.flash"), problems);
  if (!map) return;
  read_ip(map, flash.ip, problems);
  flash.dhcp = map.on_off("dhcp").value_or(!map.has("address"));
  flash.host_name = read_name(map, "host_name", problems);
  if (const auto line = read_line(map, "line")) flash.line = *line;
}

}  // namespace

const std::vector<std::string_view>& ethernet_keys() {
  static const std::vector<std::string_view> all{"address", "bind", "lease", "link_partner", "flash", "timing"};
  return all;
}

EthernetSpec read_ethernet(const YamlMap* map, const DriveSpec& drive, Problems& problems) {
  EthernetSpec spec;
  spec.at = drive.at;
  if (map == nullptr) return spec;
  spec.at = map->at();
  if (map->has("address")) {
    spec.at = position_of(*map->find("address"));
    spec.address = read_address(*map, "address", problems);
  }
  if (const auto bind = map->word("bind", {"own", "any"})) spec.any_address = *bind == "any";
  if (const auto timing = map->word("timing", {"real", "fast"})) spec.fast = *timing == "fast";
  if (const YAML::Node* node = map->find("lease")) read_lease(*node, drive, spec.surroundings.lease, problems);
  if (const auto line = read_line(*map, "link_partner")) spec.surroundings.line_partner = *line;
  if (const YAML::Node* node = map->find("flash")) read_flash(*node, drive, spec.surroundings.flash, problems);
  return spec;
}

void assign_addresses(PlantFile& file, Problems& problems) {
  std::map<std::uint32_t, const DriveSpec*> taken;
  for (const DriveSpec& d : file.drives) {
    if (!d.board || !d.board->ethernet || d.board->ethernet->address == 0) continue;
    const EthernetSpec& spec = *d.board->ethernet;
    const auto [first, fresh] = taken.emplace(spec.address, &d);
    if (!fresh)
      problems.add(spec.at, "address " + ipv4_text(spec.address) + " of " + d.name + " is taken by " +
                                first->second->name + "; allowed: another one, each adapter has its own.");
  }
  std::uint32_t next = kFirstAddress;
  for (DriveSpec& d : file.drives) {
    if (!d.board || !d.board->ethernet) continue;
    EthernetSpec& spec = *d.board->ethernet;
    if (spec.address == 0) {
      const auto is_end = [](std::uint32_t address) { return (address & 0xff) == 0 || (address & 0xff) == 0xff; };
      while (taken.contains(next) || is_end(next)) ++next;
      spec.address = next;
      taken.emplace(next, &d);
    }
    boards::EthernetSurroundings& s = spec.surroundings;
    // Locally administered, and the same in each run.
    s.mac = {0x02,
             0,
             static_cast<std::uint8_t>(spec.address >> 24),
             static_cast<std::uint8_t>(spec.address >> 16),
             static_cast<std::uint8_t>(spec.address >> 8),
             static_cast<std::uint8_t>(spec.address)};
    if (s.lease.address == 0) s.lease.address = spec.address;
    if (s.lease.mask == 0) s.lease.mask = mask_of(s.lease.address);
  }
}

}  // namespace vinv::rig
