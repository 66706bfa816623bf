#include "tests/motor_model/plant/reference_table.hpp"

#include <zlib.h>

#include <memory>
#include <stdexcept>

namespace vinv::plant::test {

namespace {

// gzread passes uncompressed files through unchanged.
std::string read_file(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) throw std::runtime_error("cannot open " + path);
  std::string text;
  char block[65536];
  int got = 0;
  while ((got = gzread(file.get(), block, sizeof block)) > 0) text.append(block, static_cast<std::size_t>(got));
  if (got < 0) throw std::runtime_error("cannot unpack " + path);
  return text;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back().push_back(c);
    }
  }
  return cells;
}

}  // namespace

ReferenceTable::ReferenceTable(const std::string& file) {
  const std::string text = read_file(std::string(VINV_SOURCE_DIR) + "/tests/motor_model/plant/data/" + file);
  std::size_t at = 0;
  while (at < text.size()) {
    auto end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    std::string line = text.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    if (line.front() == '#') {
      comments_ += line + '\n';
      continue;
    }
    auto cells = split(line);
    if (columns_.empty()) {
      for (std::size_t n = 0; n < cells.size(); ++n) columns_[cells[n]] = n;
    } else {
      if (cells.size() != columns_.size())
        throw std::runtime_error(std::string(file).append(": wrong number of cells: ").append(line));
      cells_.push_back(std::move(cells));
    }
  }
  if (cells_.empty()) throw std::runtime_error(file + ": no rows");
}

const std::string& ReferenceTable::text(std::size_t row, const std::string& column) const {
  return cells_.at(row).at(columns_.at(column));
}

double ReferenceTable::number(std::size_t row, const std::string& column) const { return std::stod(text(row, column)); }

std::vector<double> ReferenceTable::numbers(const std::string& column) const {
  std::vector<double> out;
  out.reserve(rows());
  for (std::size_t row = 0; row < rows(); ++row) out.push_back(number(row, column));
  return out;
}

}  // namespace vinv::plant::test
