// Values of signals with their unit, read and shown. A signal's unit is text of its inverter ("Hz", "degC", "-");
// people write any unit of the same dimension ("1.2 kW" for a signal in W).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::scenario {

// A number in the signal's unit. The error is a sentence with the units that are allowed.
Result<double, std::string> parse_value(std::string_view text, std::string_view signal_unit);

// "48.2 Hz", "5" for unit "-", "C" for "degC".
std::string show_value(double value, std::string_view signal_unit);

// "2 s", "150 ms"; up to the nanosecond, without trailing zeros.
std::string show_duration(Duration d);
// "3.412 s"
std::string show_time(Instant t);

// "05 06 5D", two digits a byte.
std::string show_bytes(ByteView bytes);

}  // namespace vinv::scenario
