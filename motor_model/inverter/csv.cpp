#include "motor_model/inverter/csv.hpp"

#include <cstdlib>

namespace vinv::inverter {
namespace {

// One line into fields. False if a quote is not closed or something follows a closing quote.
bool split_line(std::string_view line, std::vector<std::string>& fields) {
  fields.clear();
  std::size_t i = 0;
  while (true) {
    std::string field;
    if (i < line.size() && line[i] == '"') {
      ++i;
      while (true) {
        if (i >= line.size()) return false;
        if (line[i] == '"') {
          if (i + 1 >= line.size() || line[i + 1] != '"') break;
          ++i;
        }
        field += line[i++];
      }
      ++i;
      if (i < line.size() && line[i] != ',') return false;
    } else {
      while (i < line.size() && line[i] != ',') field += line[i++];
    }
    fields.push_back(std::move(field));
    if (i >= line.size()) return true;
    ++i;
  }
}

const std::string kEmpty;

}  // namespace

std::optional<std::size_t> CsvTable::column(std::string_view name) const {
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i] == name) return i;
  }
  return std::nullopt;
}

Result<CsvTable, std::string> parse_csv(std::string_view text) {
  CsvTable table;
  std::vector<std::string> fields;
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    const std::string place = "line " + std::to_string(line_number) + ": ";
    if (!split_line(line, fields)) return Unexpected(place + "quotes do not match");
    if (table.header.empty()) {
      table.header = fields;
      continue;
    }
    if (fields.size() != table.header.size()) {
      return Unexpected(place + std::to_string(fields.size()) + " fields, the header has " +
                        std::to_string(table.header.size()));
    }
    table.rows.push_back(fields);
    table.lines.push_back(line_number);
  }
  if (table.header.empty()) return Unexpected(std::string("no header line"));
  return table;
}

void CsvReader::fail(std::string_view column, const std::string& why) {
  if (error_) return;
  error_ = "line " + std::to_string(table_.lines[row_]) + ", " + std::string(column) + ": " + why;
}

const std::string& CsvReader::text(std::string_view column) {
  const auto c = table_.column(column);
  if (!c) {
    fail(column, "no such column");
    return kEmpty;
  }
  return table_.rows[row_][*c];
}

double CsvReader::number(std::string_view column) {
  const std::string& t = text(column);
  char* end = nullptr;
  const double v = std::strtod(t.c_str(), &end);
  if (t.empty() || *end != '\0') fail(column, "'" + t + "' is not a number");
  return v;
}

long CsvReader::integer(std::string_view column, int base) {
  const std::string& t = text(column);
  char* end = nullptr;
  const long v = std::strtol(t.c_str(), &end, base);
  if (t.empty() || *end != '\0') fail(column, "'" + t + "' is not a whole number");
  return v;
}

bool CsvReader::yes(std::string_view column) {
  const std::string& t = text(column);
  if (t != "yes" && t != "no" && t != "unknown") fail(column, "'" + t + "' is neither yes nor no");
  return t == "yes";
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  }
  return parts;
}

}  // namespace vinv::inverter
