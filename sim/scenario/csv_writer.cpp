#include "sim/scenario/csv_writer.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "sim/scenario/junit.hpp"

namespace vinv::scenario {
namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string_view kind_name(Event::Kind kind) {
  switch (kind) {
    case Event::Kind::kAction: return "action";
    case Event::Kind::kState: return "state";
    case Event::Kind::kTrip: return "trip";
    case Event::Kind::kCheck: return "check";
    case Event::Kind::kNote: return "note";
    case Event::Kind::kWire: return "wire";
  }
  return "";
}

}  // namespace

std::string signals_csv(const Recording& r) {
  fmt::memory_buffer out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "time_s");
  for (const SignalColumn& c : r.columns)
    fmt::format_to(to, ",{}.{}{}", c.drive, c.name, c.unit == "-" ? "" : " " + c.unit);
  out.push_back('\n');
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    fmt::format_to(to, "{:.6f}", to_seconds(r.times[i]));
    for (const SignalColumn& c : r.columns) fmt::format_to(to, ",{:.9g}", c.values[i]);
    out.push_back('\n');
  }
  return fmt::to_string(out);
}

std::string events_csv(const RunResult& result) {
  std::string out = "time_s,kind,drive,line,text\n";
  for (const Event& e : result.events)
    out += fmt::format("{:.6f},{},{},{},{}\n", to_seconds(e.at), kind_name(e.kind), e.drive, e.line, field(e.text));
  return out;
}

void CsvWriter::write(const Scenario*, const RunResult& result) {
  if (result.verdict == Verdict::kNotRun) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw std::runtime_error("the folder " + folder_ + " cannot be made: " + error.message() + ".");
  const std::string stem = folder_ + "/" + report_stem(result);
  write_file(stem + ".csv", signals_csv(result.recording));
  write_file(stem + ".events.csv", events_csv(result));
}

}  // namespace vinv::scenario
