#include "sim/scenario/report/text.hpp"

#include <charconv>
#include <cstdint>

namespace vinv::scenario {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

// Length of the well-formed sequence at the start of text; 0: none. The Unicode Standard, table 3-7.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned low = first == 0xE0 ? 0xA0 : 0x80;
    const unsigned high = first == 0xED ? 0x9F : 0xBF;
    return byte(1) >= low && byte(1) <= high && follows(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned low = first == 0xF0 ? 0x90 : 0x80;
    const unsigned high = first == 0xF4 ? 0x8F : 0xBF;
    return byte(1) >= low && byte(1) <= high && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::string clean_utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto c = static_cast<unsigned char>(text.front());
    const bool control = (c < 0x20 && c != '\t' && c != '\n') || c == 0x7F;
    const std::size_t length = sequence_length(text);
    if (control || length == 0)
      out += kReplacement;
    else
      out += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string html_text(std::string_view text) {
  std::string out;
  out.reserve(text.size() + 16);
  for (const char c : clean_utf8(text)) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string json_for_script(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    switch (c) {
      case '<': out += "\\u003c"; break;
      case '>': out += "\\u003e"; break;
      case '&': out += "\\u0026"; break;
      default: out += c;
    }
  }
  return out;
}

std::string url_text(std::string_view file_name) {
  std::string out;
  for (const char c : file_name) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    if (plain) {
      out += c;
    } else {
      const auto b = static_cast<unsigned char>(c);
      out += {'%', kHexDigits[b >> 4U], kHexDigits[b & 15U]};
    }
  }
  return out;
}

std::string csv_field(std::string_view text) {
  std::string value = clean_utf8(text);
  if (!value.empty() && std::string_view("=+-@\t").find(value.front()) != std::string_view::npos) value.insert(0, "'");
  if (value.find_first_of("\",\n") == std::string::npos) return value;
  std::string out = "\"";
  for (const char c : value) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

void append_seconds(std::string& out, Instant at) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  std::int64_t ns = to_ns(at);
  if (ns < 0) {
    out += '-';
    ns = -ns;
  }
  char digits[24];
  const auto end = std::to_chars(digits, digits + sizeof digits, ns / kPerSecond).ptr;
  out.append(digits, end);
  char fraction[10] = {'.', '0', '0', '0', '0', '0', '0', '0', '0', '0'};
  std::int64_t rest = ns % kPerSecond;
  for (int i = 9; i > 0; --i, rest /= 10) fraction[i] = static_cast<char>('0' + rest % 10);
  std::size_t length = sizeof fraction;
  while (length > 4 && fraction[length - 1] == '0') --length;
  out.append(fraction, length);
}

std::string seconds_text(Instant at) {
  std::string out;
  append_seconds(out, at);
  return out;
}

std::string shown_path(std::string_view path) {
  if (path.empty() || path.front() != '/') return std::string(path);
  const std::size_t last = path.rfind('/');
  const std::size_t before = last == 0 ? std::string_view::npos : path.rfind('/', last - 1);
  return std::string(before == std::string_view::npos ? path.substr(1) : path.substr(before + 1));
}

}  // namespace vinv::scenario
