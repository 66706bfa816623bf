// Comma-separated tables of the tree (motor_model/families): a header line, then rows; fields with commas or quotes are
// quoted, a quote inside is doubled. No line breaks inside fields.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"

namespace vinv::inverter {

struct CsvTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // each as wide as the header
  std::vector<int> lines;                      // line number of each row, from 1

  // Position of a column; empty if there is none.
  std::optional<std::size_t> column(std::string_view name) const;
};

// Error: "line 7: 3 fields, the header has 5".
Result<CsvTable, std::string> parse_csv(std::string_view text);

// Reads rows by column name and gathers the first mistake, so that a table loader reads like its table.
class CsvReader {
 public:
  explicit CsvReader(const CsvTable& table) : table_(table) {}

  std::size_t size() const { return table_.rows.size(); }
  void select(std::size_t row) { row_ = row; }
  const std::string& text(std::string_view column);
  double number(std::string_view column);  // a missing or wrong number is an error
  long integer(std::string_view column, int base = 10);
  bool yes(std::string_view column);  // "yes"; "no" and "unknown" are false; anything else is an error
  void fail(std::string_view column, const std::string& why);
  const std::optional<std::string>& error() const { return error_; }

 private:
  const CsvTable& table_;
  std::size_t row_ = 0;
  std::optional<std::string> error_;
};

std::vector<std::string_view> split(std::string_view text, char separator);  // empty text: no parts

}  // namespace vinv::inverter
