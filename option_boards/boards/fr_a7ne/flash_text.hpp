// The option's flash memory as a text file: a line per item, a checksum at the end. FR-A7NE manual, 7.8, 7.9.
#pragma once

#include <string>
#include <string_view>

#include "option_boards/boards/ethernet_settings.hpp"
#include "sim/base/result.hpp"

namespace vinv::boards::fr_a7ne {

std::string flash_text(const Flash& flash);
// Refuses a damaged text with a sentence that names the line.
Result<Flash, std::string> parse_flash(std::string_view text);

}  // namespace vinv::boards::fr_a7ne
