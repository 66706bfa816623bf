#include "sim/rig/ethernet_reader.hpp"

#include <array>
#include <map>
#include <set>

#include "sim/base/ipv4.hpp"
#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

constexpr std::uint32_t kFirstAddress = ipv4(127, 0, 0, 2);
constexpr std::size_t kMostDomainCharacters = 48;  // FR-A7NE manual, 7.8.2

struct PartnerWord {
  std::string_view word;
  boards::LineSetting setting;
};
constexpr std::array kPartners{PartnerWord{"auto", {true, false, 10}}, PartnerWord{"10_half", {false, false, 10}},
                               PartnerWord{"10_full", {false, true, 10}}, PartnerWord{"100_half", {false, false, 100}},
                               PartnerWord{"100_full", {false, true, 100}}};

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

void read_lease(const YAML::Node& node, const DriveSpec& drive, boards::IpConfiguration& lease, Problems& problems) {
  const YamlMap map(node, "lease of " + drive.name, &plant_file_keys().at("drives[].board.lease"), problems);
  if (!map) return;
  lease.address = read_address(map, "address", problems);
  lease.gateway = read_address(map, "gateway", problems);
  lease.name_server = read_address(map, "name_server", problems);
  lease.name_server_2 = read_address(map, "name_server_2", problems);
  if (const auto text = map.text("mask")) {
    const auto mask = parse_ipv4(*text);
    if (mask && *mask != 0 && (~*mask & (~*mask + 1)) == 0)
      lease.mask = *mask;
    else
      problems.add(*map.find("mask"), "mask in lease of " + drive.name + " is \"" + *text +
                                          "\"; allowed: a network mask without gaps, as 255.255.255.0.");
  }
  if (const auto domain = map.text("domain")) {
    if (domain->size() <= kMostDomainCharacters)
      lease.domain = *domain;
    else
      problems.add(*map.find("domain"), "domain in lease of " + drive.name + " has " + std::to_string(domain->size()) +
                                            " characters; allowed: at most 48.");
  }
}

}  // namespace

const std::vector<std::string_view>& ethernet_keys() {
  static const std::vector<std::string_view> all{"address", "bind", "lease", "link_partner", "timing"};
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
  std::vector<std::string_view> words;
  for (const PartnerWord& p : kPartners) words.push_back(p.word);
  if (const auto word = map->word("link_partner", words))
    for (const PartnerWord& p : kPartners)
      if (p.word == *word) spec.surroundings.line_partner = p.setting;
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
