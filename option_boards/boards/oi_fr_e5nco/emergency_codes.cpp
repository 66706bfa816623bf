#include "option_boards/boards/oi_fr_e5nco/emergency_codes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "sim/base/check.hpp"
#include "vinv_boards_data.hpp"

namespace vinv::boards::oi_fr_e5nco {
namespace {

std::string_view take_until(std::string_view& text, char delimiter) {
  const std::size_t end = std::min(text.find(delimiter), text.size());
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return taken;
}

std::uint16_t hex(std::string_view field) {
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value, 16);
  VINV_CHECK(error == std::errc{} && end == field.data() + field.size());
  return value;
}

std::array<EmergencyCode, 256> parse(std::string_view csv) {
  std::array<EmergencyCode, 256> codes;
  codes.fill({kGenericError, 0x01});
  take_until(csv, '\n');
  while (!csv.empty()) {
    std::string_view line = take_until(csv, '\n');
    take_until(line, ',');  // the alarm's name
    const std::uint16_t data_code = hex(take_until(line, ','));
    const std::uint16_t error_code = hex(take_until(line, ','));
    const std::uint16_t error_register = hex(take_until(line, ','));
    VINV_CHECK(data_code < codes.size() && error_register <= 0xff);
    codes[data_code] = {error_code, static_cast<std::uint8_t>(error_register)};
  }
  return codes;
}

}  // namespace

EmergencyCode emergency_code_of(std::uint8_t data_code) {
  static const std::array<EmergencyCode, 256> kCodes = parse(data::OI_FR_E5NCO_EMERGENCY_CODES);
  return kCodes[data_code];
}

}  // namespace vinv::boards::oi_fr_e5nco
