#include "sim/scenario/report/csv_report.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "sim/scenario/report/text.hpp"

namespace vinv::scenario {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

// Most signals stand still most of the time: what was written last is written again.
class NumberColumn {
 public:
  static constexpr std::size_t kLongest = 24;

  // Copies kLongest bytes, of which those up to the answer count: one copy of a fixed length is the fastest.
  char* write(char* to, double value) {
    const auto number = static_cast<float>(value);
    if (const auto bits = std::bit_cast<std::uint32_t>(number); bits != bits_ || length_ == 0) {
      bits_ = bits;
      length_ = 1;
      text_[0] = ',';
      if (!std::isnan(number)) {
        length_ = static_cast<std::size_t>(std::to_chars(text_ + 1, text_ + sizeof text_, number).ptr - text_);
      }
    }
    std::memcpy(to, text_, kLongest);
    return to + length_;
  }

 private:
  std::uint32_t bits_ = 0;
  std::size_t length_ = 0;
  char text_[kLongest] = {};
};

}  // namespace

std::string_view kind_word(Event::Kind kind) {
  switch (kind) {
    case Event::Kind::kAction: return "action";
    case Event::Kind::kState: return "state";
    case Event::Kind::kTrip: return "trip";
    case Event::Kind::kCheck: return "check";
    case Event::Kind::kNote: return "note";
    case Event::Kind::kWire: return "wire";
  }
  return "state";
}

std::string signals_csv(const Recording& recording) {
  std::string out = "time_s";
  for (const SignalColumn& c : recording.columns) {
    out += ',';
    out += csv_field((c.drive.empty() ? "" : c.drive + ".") + c.name + (c.unit == "-" ? "" : " [" + c.unit + "]"));
  }
  out += kLineEnd;
  out.reserve(out.size() + recording.times.size() * (recording.columns.size() + 1) * 8);
  std::vector<NumberColumn> numbers(recording.columns.size());
  std::vector<char> line((numbers.size() + 1) * NumberColumn::kLongest);
  for (std::size_t row = 0; row < recording.times.size(); ++row) {
    append_seconds(out, recording.times[row]);
    char* to = line.data();
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      const std::vector<double>& values = recording.columns[c].values;
      to = numbers[c].write(to, row < values.size() ? values[row] : std::nan(""));
    }
    out.append(line.data(), static_cast<std::size_t>(to - line.data()));
    out += kLineEnd;
  }
  return out;
}

std::string states_csv(const Recording& recording) {
  std::string out = "time_s,drive,state,value";
  out += kLineEnd;
  for (const StateTrace& trace : recording.states) {
    const std::string middle = "," + csv_field(trace.drive) + "," + csv_field(trace.name) + ",";
    for (const StateTrace::Change& change : trace.changes) {
      append_seconds(out, change.at);
      out += middle;
      out += csv_field(change.value);
      out += kLineEnd;
    }
  }
  return out;
}

std::string events_csv(const RunResult& result) {
  std::string out = "time_s,kind,drive,text,line";
  out += kLineEnd;
  for (const Event& event : result.events) {
    append_seconds(out, event.at);
    out += ',';
    out += kind_word(event.kind);
    out += ',';
    out += csv_field(event.drive);
    out += ',';
    out += csv_field(event.text);
    out += ',';
    if (event.line > 0) out += std::to_string(event.line);
    out += kLineEnd;
  }
  return out;
}

}  // namespace vinv::scenario
