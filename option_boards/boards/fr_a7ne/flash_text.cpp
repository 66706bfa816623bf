#include "option_boards/boards/fr_a7ne/flash_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "option_boards/boards/fr_a7ne/network_settings.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/ipv4.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

constexpr std::string_view kHeader = "vinverter flash 1 fr-a7ne";

std::string checksum_of(std::string_view text) {
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx",
                static_cast<unsigned long long>(
                    snapshot_checksum({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()})));
  return hex;
}

// Names come from a master as any bytes; what is not printable is written in hexadecimal.
std::string escaped(std::string_view name) {
  std::string out;
  for (const char c : name) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    out += c > ' ' && c < 127 && c != '%' ? std::string(1, c) : std::string(hex);
  }
  return out;
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned value = 0;
    if (i + 3 > text.size()) return std::nullopt;
    const char* const first = text.data() + i + 1;
    const auto [end, error] = std::from_chars(first, first + 2, value, 16);
    if (error != std::errc() || end != first + 2) return std::nullopt;
    out += static_cast<char>(value);
    i += 2;
  }
  return out.size() <= kMostNameCharacters ? std::optional(out) : std::nullopt;
}

bool parse_value(std::string_view text, bool& value) {
  value = text == "on";
  return value || text == "off";
}
bool parse_value(std::string_view text, std::uint32_t& value) {
  const auto address = parse_ipv4(text);
  value = address.value_or(0);
  return address.has_value();
}
bool parse_value(std::string_view text, std::string& value) {
  const auto name = unescaped(text);
  value = name.value_or("");
  return name.has_value();
}
bool parse_value(std::string_view text, LineSetting& value) {
  const auto line = parse_line_setting(text);
  value = line.value_or(LineSetting{});
  return line.has_value();
}
std::string text_of(bool value) { return value ? "on" : "off"; }
std::string text_of(std::uint32_t value) { return ipv4_text(value); }
std::string text_of(const std::string& value) { return escaped(value); }
std::string text_of(const LineSetting& value) { return std::string(line_setting_word(value)); }

template <class F, class Visit>
void each_item(F& flash, Visit&& visit) {
  visit("dhcp", flash.dhcp);
  visit("address", flash.ip.address);
  visit("mask", flash.ip.mask);
  visit("gateway", flash.ip.gateway);
  visit("name_server", flash.ip.name_server);
  visit("name_server_2", flash.ip.name_server_2);
  visit("domain", flash.ip.domain);
  visit("host_name", flash.host_name);
  visit("line", flash.line);
}

}  // namespace

std::string flash_text(const Flash& flash) {
  std::string out(kHeader);
  out += "\n";
  each_item(flash,
            [&](const char* key, const auto& value) { out += std::string(key) + " = " + text_of(value) + "\n"; });
  return out + "checksum = " + checksum_of(out) + "\n";
}

Result<Flash, std::string> parse_flash(std::string_view text) {
  Flash flash;
  std::string refusal;
  std::size_t at = 0, number = 0;
  const auto line = [&] {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view found = text.substr(at, end - at);
    at = std::min(end + 1, text.size());
    ++number;
    return found;
  };
  const auto refuse = [&](const std::string& why) {
    if (refusal.empty()) refusal = "line " + std::to_string(number) + ": " + why;
  };
  if (line() != kHeader) refuse("this is no flash memory of an fr-a7ne");
  each_item(flash, [&](const char* key, auto& value) {
    if (!refusal.empty()) return;
    const std::string begin = std::string(key) + " = ";
    const std::string_view found = line();
    if (!found.starts_with(begin)) return refuse(std::string(key) + " is missing");
    if (!parse_value(found.substr(begin.size()), value)) refuse(std::string(key) + " has no such value");
  });
  if (!refusal.empty()) return Unexpected(refusal);
  const std::string_view body = text.substr(0, at);
  if (line() != "checksum = " + checksum_of(body)) refuse("the checksum does not match the contents");
  if (refusal.empty() && at != text.size()) refuse("something follows the checksum");
  if (refusal.empty() && !text.ends_with('\n')) refuse("the line has no end");
  if (!refusal.empty()) return Unexpected(refusal);
  return flash;
}

}  // namespace vinv::boards::fr_a7ne
