#include "sim/transports/port_holder.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sim/base/ipv4.hpp"

namespace vinv::transports {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kListening = "0A";
// As the files have it: four or sixteen bytes, of which each word is in the order of this machine.
constexpr std::size_t kDigitsOfV4 = 8;
const std::string kAnyV6(32, '0');

struct Row {
  std::string address;  // hexadecimal
  std::uint16_t port = 0;
  std::string state;
  std::string inode;
};

// "0: 0200007F:AF12 00000000:0000 0A 00000000:00000000 00:00000000 00000000 1000 0 31415 ..."
bool parse_row(const std::string& line, Row& row) {
  std::istringstream in(line);
  std::string number, local, remote, queues, timer, retransmits, user, timeout;
  if (!(in >> number >> local >> remote >> row.state >> queues >> timer >> retransmits >> user >> timeout >> row.inode))
    return false;
  const std::size_t colon = local.find(':');
  if (colon == std::string::npos) return false;
  row.address = local.substr(0, colon);
  const auto [end, error] = std::from_chars(local.data() + colon + 1, local.data() + local.size(), row.port, 16);
  return error == std::errc() && end == local.data() + local.size();
}

// Empty: not an address that stands in the way.
std::string blocking(const std::string& hex, std::uint32_t wanted) {
  if (hex == kAnyV6) return "[::]";
  std::uint32_t word = 0;
  if (hex.size() != kDigitsOfV4) return {};
  std::from_chars(hex.data(), hex.data() + hex.size(), word, 16);
  const std::uint32_t address = word >> 24 | (word >> 8 & 0xff00) | (word << 8 & 0xff0000) | word << 24;
  return address == 0 || address == wanted || wanted == 0 ? ipv4_text(address) : std::string();
}

std::string program_with(const std::string& inode) {
  const std::string wanted = "socket:[" + inode + "]";
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string id = process.path().filename().string();
    if (id.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code hidden;
    for (fs::directory_iterator fd(process.path() / "fd", hidden), end; !hidden && fd != end; fd.increment(hidden)) {
      std::error_code gone;
      if (fs::read_symlink(fd->path(), gone) != wanted) continue;
      std::string name;
      std::getline(std::ifstream(process.path() / "comm"), name);
      return name + ", process " + id;
    }
  }
  return {};
}

}  // namespace

std::vector<PortHolder> holders_of(PortKind kind, std::uint32_t address, std::uint16_t port) {
  std::vector<PortHolder> holders;
  const std::string file = kind == PortKind::kTcp ? "/proc/net/tcp" : "/proc/net/udp";
  for (const char* version : {"", "6"}) {
    std::ifstream in(file + version);
    for (std::string line; std::getline(in, line);) {
      Row row;
      if (!parse_row(line, row) || row.port != port || (kind == PortKind::kTcp && row.state != kListening)) continue;
      if (std::string where = blocking(row.address, address); !where.empty())
        holders.push_back({std::move(where), program_with(row.inode)});
    }
  }
  return holders;
}

}  // namespace vinv::transports
