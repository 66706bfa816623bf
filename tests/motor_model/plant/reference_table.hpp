// CSV reference data of tests/motor_model/plant/data: '#' lines are comments, the first other line names the columns.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace vinv::plant::test {

class ReferenceTable {
 public:
  // File name below data/; .gz is unpacked. Throws std::runtime_error if it is not there or not a table.
  explicit ReferenceTable(const std::string& file);

  std::size_t rows() const { return cells_.size(); }
  const std::string& text(std::size_t row, const std::string& column) const;
  double number(std::size_t row, const std::string& column) const;
  std::vector<double> numbers(const std::string& column) const;
  const std::string& comments() const { return comments_; }

 private:
  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> cells_;
  std::string comments_;
};

}  // namespace vinv::plant::test
