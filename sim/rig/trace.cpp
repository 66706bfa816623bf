#include "sim/rig/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sim/base/table_text.hpp"
#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

constexpr std::string_view kTime = "time_s";

Result<void, std::string> read_header(std::string_view line, Trace& trace) {
  if (take_until(line, ',') != kTime) return Unexpected("has no header that begins with \"time_s\".");
  while (!line.empty()) {
    std::string_view field = take_until(line, ',');
    Trace::Column column;
    column.name = take_until(field, ' ');
    column.unit = field;
    if (column.name.empty()) return Unexpected("has a column without a name.");
    if (trace.find(column.name) != nullptr) return Unexpected("has two columns \"" + column.name + "\".");
    trace.columns.push_back(std::move(column));
  }
  return {};
}

}  // namespace

double Trace::at(const Column& column, double t) const {
  const auto after = std::upper_bound(time_s.begin() + 1, time_s.end() - 1, t);
  const auto i = static_cast<std::size_t>(after - time_s.begin());
  const double part = (t - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
  return column.values[i - 1] + part * (column.values[i] - column.values[i - 1]);
}

const Trace::Column* Trace::find(std::string_view name) const {
  const auto it = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  return it == columns.end() ? nullptr : &*it;
}

Result<Trace, std::string> parse_trace(std::string_view text) {
  Trace trace;
  bool header = false;
  for (int line_number = 1; !text.empty(); ++line_number) {
    std::string_view line = take_until(text, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    if (!header) {
      if (auto fine = read_header(line, trace); !fine) return Unexpected(fine.error());
      header = true;
      continue;
    }
    const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (fields != trace.columns.size() + 1)
      return Unexpected(
          fmt::format("line {} has {} fields, the header {}.", line_number, fields, trace.columns.size() + 1));
    const auto number = [&](double& value) {
      return parse_number(take_until(line, ','), value) && std::isfinite(value);
    };
    double time = 0;
    bool fine = number(time);
    if (fine && !trace.time_s.empty() && time <= trace.time_s.back())
      return Unexpected(fmt::format("line {} is not later than the one before.", line_number));
    trace.time_s.push_back(time);
    for (Trace::Column& column : trace.columns) fine = number(column.values.emplace_back()) && fine;
    if (!fine) return Unexpected(fmt::format("line {} has a field that is no number.", line_number));
  }
  if (trace.time_s.size() < 2) return Unexpected("has fewer than two rows.");
  return trace;
}

Result<Trace, std::string> load_trace(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Unexpected("is a folder.");
  std::ifstream in(path, std::ios::binary);
  if (!in) return Unexpected(std::string("cannot be read: ") + std::strerror(errno) + ".");
  // One byte too many is enough for a refusal; a device may never end.
  std::string text;
  constexpr std::size_t kPiece = 64 * 1024;
  while (in && text.size() <= kMaxTraceBytes) {
    const std::size_t had = text.size();
    text.resize(had + kPiece);
    in.read(text.data() + had, kPiece);
    text.resize(had + static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) return Unexpected("cannot be read: it is no ordinary file.");
  if (text.size() > kMaxTraceBytes) return Unexpected("is larger than 64 MiB.");
  return parse_trace(text);
}

}  // namespace vinv::rig
