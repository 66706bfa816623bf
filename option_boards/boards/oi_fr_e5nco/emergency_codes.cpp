#include "option_boards/boards/oi_fr_e5nco/emergency_codes.hpp"

#include <array>
#include <string_view>

#include "sim/base/table_text.hpp"
#include "vinv_boards_data.hpp"

namespace vinv::boards::oi_fr_e5nco {
namespace {

std::array<EmergencyCode, 256> parse(std::string_view csv) {
  std::array<EmergencyCode, 256> codes;
  codes.fill({kGenericError, 0x01});
  take_until(csv, '\n');
  while (!csv.empty()) {
    std::string_view line = take_until(csv, '\n');
    take_until(line, ',');  // the alarm's name
    const auto data_code = number_of_field<std::uint8_t>(take_until(line, ','), 0, 16);
    const auto error_code = number_of_field<std::uint16_t>(take_until(line, ','), 0, 16);
    codes[data_code] = {error_code, number_of_field<std::uint8_t>(take_until(line, ','), 0, 16)};
  }
  return codes;
}

}  // namespace

EmergencyCode emergency_code_of(std::uint8_t data_code) {
  static const std::array<EmergencyCode, 256> kCodes = parse(data::OI_FR_E5NCO_EMERGENCY_CODES);
  return kCodes[data_code];
}

}  // namespace vinv::boards::oi_fr_e5nco
