// Variables of a scenario: `$name` or `${expression}` inside any value. An expression adds and subtracts quantities of
// one dimension, and multiplies and divides them by plain numbers or fractions: ${ramp * 2 + 200 ms}.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "sim/base/result.hpp"

namespace vinv::scenario {

using Variables = std::map<std::string, std::string>;

// The text with every variable replaced. The error is a sentence.
Result<std::string, std::string> substitute(std::string_view text, const Variables& variables);

}  // namespace vinv::scenario
