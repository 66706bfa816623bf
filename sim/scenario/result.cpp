#include "sim/scenario/result.hpp"

#include "sim/scenario/report_writer.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {

std::string failure_text(const RunResult& result, const CheckResult& check) {
  constexpr std::size_t kEventsShown = 5;
  std::string out = result.path;
  if (check.where.line > 0) out += ":" + std::to_string(check.where.line) + ":" + std::to_string(check.where.column);
  out += ": at " + show_time(check.at) + (check.drive.empty() ? "" : " " + check.drive) + ": " + check.what + "\n";
  out += "  expected  " + check.expected + "\n  seen      " + check.seen + "\n";
  if (!check.cause.empty()) out += "  alarm     " + check.cause + "\n";
  const std::size_t end = std::min(check.events_before, result.events.size());
  const std::size_t begin = end > kEventsShown ? end - kEventsShown : 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Event& e = result.events[i];
    out += (i == begin ? "  before    " : "            ") + show_time(e.at) + "  " +
           (e.drive.empty() ? "" : e.drive + ": ") + e.text + "\n";
  }
  return out;
}

std::string report_stem(const RunResult& result) {
  std::string out;
  std::string path = result.path;
  const std::size_t dot = path.rfind('.');
  if (dot != std::string::npos && dot > path.rfind('/') + 1) path.resize(dot);
  // The folder and the name: enough to tell files apart in practice, and readable.
  std::size_t from = path.rfind('/');
  if (from != std::string::npos && from > 0) from = path.rfind('/', from - 1);
  for (const char c : path.substr(from == std::string::npos ? 0 : from + 1))
    out += c == '/' ? '_' : static_cast<unsigned char>(c) < 0x21 ? '_' : c;
  return out;
}

}  // namespace vinv::scenario
