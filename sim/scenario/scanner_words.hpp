// Words of EtherNet/IP scanners beside those of every master: their I/O connection, its data, messages of one's own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/scenario/master_words.hpp"

namespace vinv::scenario {

const std::vector<std::string_view>& scanner_words();

// One of them. The profile has the points and sizes that "open" takes where the file says nothing. The error is a
// sentence without full stop that names what is allowed.
Result<Said, std::string> read_scanner_word(const masters::BoardProfile& profile, std::string_view word,
                                            const rig::Json& value);

}  // namespace vinv::scenario
