// A table over time, of signals that a run is compared with or of a voltage that feeds a motor: CSV, `#` lines are
// comment, then a header of `time_s` and names with their unit ("speed rpm"), as the reports write them, then rows in
// the order of time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"

namespace vinv::rig {

inline constexpr std::size_t kMaxTraceBytes = 64 * 1024 * 1024;

struct Trace {
  struct Column {
    std::string name;  // "speed", of a report "fan_1.speed"
    std::string unit;  // "rpm"; empty or "-": none
    std::vector<double> values;
  };
  std::vector<double> time_s;  // rising, at least two
  std::vector<Column> columns;

  bool covers(double t) const { return t >= time_s.front() && t <= time_s.back(); }
  // Linear between rows; t must be covered.
  double at(const Column& column, double t) const;
  // nullptr if there is none.
  const Column* find(std::string_view name) const;
};

// The error is a sentence without subject: "line 7 has 3 fields, the header 4."
Result<Trace, std::string> parse_trace(std::string_view text);
Result<Trace, std::string> load_trace(const std::string& path);

}  // namespace vinv::rig
