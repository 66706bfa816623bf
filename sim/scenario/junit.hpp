// JUnit XML of a batch: a test suite per folder, a test case per scenario. Times are virtual.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/scenario/report_writer.hpp"

namespace vinv::scenario {

class JunitWriter : public ReportWriter {
 public:
  explicit JunitWriter(std::string path) : path_(std::move(path)) {}
  void write(const Scenario* scenario, const RunResult& result) override;
  void finish() override;  // writes the file
  std::string text() const;

 private:
  struct Suite {
    std::string cases;
    std::size_t tests = 0, failures = 0, errors = 0;
    double time_s = 0;
  };
  std::string path_;
  std::map<std::string, Suite> suites_;
};

// Text of an XML document: markup escaped, bytes that XML cannot hold replaced.
std::string xml_text(std::string_view text);

// Writes a file as a whole. Throws std::runtime_error with a sentence.
void write_file(const std::string& path, std::string_view text);

}  // namespace vinv::scenario
