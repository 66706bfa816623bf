#include "sim/scenario/node_values.hpp"

#include <algorithm>
#include <cctype>

#include "sim/rig/quantity.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {

bool contains(const Keys& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::optional<Duration> read_duration(const YAML::Node& node, const std::string& what, Duration minimum,
                                      rig::Problems& problems) {
  constexpr double kLongest_s = 1e6;
  if (!node.IsScalar()) {
    problems.add(node, what + " is " + rig::kind_of(node) + "; allowed: a time, as 2 s or 500 ms.");
    return {};
  }
  const auto parsed = rig::parse_quantity(node.Scalar(), rig::Dimension::kTime);
  if (!parsed) {
    problems.add(node, what + ": " + parsed.error());
    return {};
  }
  if (*parsed < to_seconds(minimum) || *parsed > kLongest_s) {
    problems.add(node, what + " is \"" + node.Scalar() + "\"; allowed: " + show_duration(minimum) + " to 1000000 s.");
    return {};
  }
  return seconds_to_duration(*parsed);
}

std::optional<Bytes> read_hex(const YAML::Node& node, const std::string& what, rig::Problems& problems) {
  constexpr std::size_t kMaxFrameBytes = 1024;
  Bytes out;
  std::string digits;
  bool fine = node.IsScalar();
  for (const char c : fine ? node.Scalar() : std::string{}) {
    if (c == ' ') continue;
    fine = fine && std::isxdigit(static_cast<unsigned char>(c)) != 0;
    digits += c;
  }
  if (!fine || digits.empty() || digits.size() % 2 != 0 || digits.size() / 2 > kMaxFrameBytes) {
    problems.add(node, what + " is " + rig::kind_of(node) + "; allowed: bytes in hexadecimal, as 05 06 5D C2 0F A0.");
    return {};
  }
  for (std::size_t i = 0; i < digits.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  return out;
}

}  // namespace vinv::scenario
