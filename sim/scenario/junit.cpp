#include "sim/scenario/junit.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace vinv::scenario {

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\n': out += "&#10;"; break;
      default: out += static_cast<unsigned char>(c) < 0x20 && c != '\t' ? '?' : c;
    }
  }
  return out;
}

void write_file(const std::string& path, std::string_view text) {
  const auto fail = [&] { throw std::runtime_error(path + " cannot be written: " + std::strerror(errno) + "."); };
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) fail();
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written) errno = reason;
  if (!written || !closed) fail();
}

void JunitWriter::write(const Scenario*, const RunResult& result) {
  const std::string folder = std::filesystem::path(result.path).parent_path().string();
  Suite& suite = suites_[folder.empty() ? "." : folder];
  ++suite.tests;
  suite.time_s += to_seconds(result.end);
  suite.cases += fmt::format("    <testcase classname=\"{}\" name=\"{}\" file=\"{}\" time=\"{:.3f}\">\n",
                             xml_text(folder.empty() ? "scenario" : folder), xml_text(result.name),
                             xml_text(result.path), to_seconds(result.end));
  if (result.verdict == Verdict::kNotRun) {
    ++suite.errors;
    suite.cases += "      <error message=\"" + xml_text(result.reason.substr(0, result.reason.find('\n'))) + "\">" +
                   xml_text(result.reason) + "</error>\n";
  } else if (result.verdict == Verdict::kFailed) {
    ++suite.failures;
    for (const CheckResult& c : result.checks) {
      if (c.passed) continue;
      suite.cases += "      <failure message=\"" + xml_text(c.what + ": expected " + c.expected + ", seen " + c.seen) +
                     "\">" + xml_text(failure_text(result, c)) + "</failure>\n";
    }
  }
  suite.cases += "      <system-out>" + xml_text(result.title) + "</system-out>\n    </testcase>\n";
}

std::string JunitWriter::text() const {
  std::size_t tests = 0, failures = 0, errors = 0;
  std::string body;
  for (const auto& [name, s] : suites_) {
    tests += s.tests;
    failures += s.failures;
    errors += s.errors;
    body += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"0\" time=\"{:.3f}\">\n{}"
        "  </testsuite>\n",
        xml_text(name), s.tests, s.failures, s.errors, s.time_s, s.cases);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"vinverter\" tests=\"{}\" failures=\"{}\" "
      "errors=\"{}\">\n{}</testsuites>\n",
      tests, failures, errors, body);
}

void JunitWriter::finish() { write_file(path_, text()); }

}  // namespace vinv::scenario
