// The data of an HTML report, as elements that its scripts read: a JSON text, and packed columns beside it that are
// decoded only when they are shown. Nothing in them can end an element.
//   #run    JSON: name, end (s), columns, states, events, checks, wire
//   #times  base64 of float64, seconds; #cN: of float32, one for each column that is not constant
//   #wire   a line for each record: nanoseconds since the one before, kind (0 CAN, 1 CAN error, 2 serial, 3 TCP),
//           index of network, index of sender, identifier in hex, bytes in hex
#pragma once

#include <cstddef>
#include <string>

#include "sim/scenario/result.hpp"

namespace vinv::scenario {

inline constexpr std::size_t kMaxWireRecordsInPage = 250'000;

void append_data_elements(std::string& page, const RunResult& result);

}  // namespace vinv::scenario
