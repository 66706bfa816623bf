// Reading the tables that are compiled into the program: rows are lines, fields end at commas, nothing is quoted. A
// mistake in such a table is a mistake in the program.
#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <string_view>

#include "sim/base/check.hpp"

namespace vinv {

// Takes the text up to the delimiter away, and the delimiter; without one, all of it.
inline std::string_view take_until(std::string_view& text, char delimiter) {
  const std::size_t end = std::min(text.find(delimiter), text.size());
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return taken;
}

// A whole field as a number; an empty one is the fallback, 0x in front makes it hexadecimal.
template <std::integral T>
T number_of_field(std::string_view field, T fallback, int base = 10) {
  if (field.empty()) return fallback;
  if (field.starts_with("0x")) {
    field.remove_prefix(2);
    base = 16;
  }
  T value{};
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value, base);
  VINV_CHECK(error == std::errc{} && end == field.data() + field.size());
  return value;
}

}  // namespace vinv
