#include "sim/campaign/merge.hpp"

#include <fmt/format.h>

#include "sim/scenario/junit.hpp"
#include "sim/scenario/report/text.hpp"

namespace vinv::campaign {
namespace {

using scenario::csv_field;
using scenario::xml_text;

const CaseResult* result_of(const Results& results, std::uint64_t number) {
  const auto it = results.cases.find(number);
  return it == results.cases.end() ? nullptr : &it->second;
}

std::string seconds(std::int64_t ns) { return scenario::seconds_text(Instant{Duration{ns}}); }

std::string failure_lines(const Failure& f) {
  std::string out = fmt::format("at {} s{}{}: {}\n  expected  {}\n  seen      {}\n", seconds(f.at_ns),
                                f.drive.empty() ? "" : " ", f.drive, f.what, f.expected, f.seen);
  if (!f.cause.empty()) out += "  alarm     " + f.cause + "\n";
  return out;
}

}  // namespace

Counts count_results(const Campaign& campaign, const Results& results) {
  Counts c;
  for (const auto& [number, r] : results.cases) {
    switch (r.verdict) {
      case CaseVerdict::kPassed: ++c.passed; break;
      case CaseVerdict::kFailed: ++c.failed; break;
      case CaseVerdict::kNotRun: ++c.not_run; break;
      case CaseVerdict::kCrashed: ++c.crashed; break;
    }
  }
  c.missing = campaign.cases() - results.cases.size();
  return c;
}

std::string counts_text(const Counts& c) {
  return fmt::format("{} cases: {} passed, {} failed, {} could not run, {} crashed, {} without result",
                     c.passed + c.failed + c.not_run + c.crashed + c.missing, c.passed, c.failed, c.not_run, c.crashed,
                     c.missing);
}

std::string first_failure(const CaseResult* r) {
  if (r == nullptr) return "has no result";
  if (!r->reason.empty()) return r->reason.substr(0, r->reason.find('\n'));
  if (r->failures.empty()) return {};
  const Failure& f = r->failures.front();
  return fmt::format("{}{}{}: expected {}, seen {}", f.drive, f.drive.empty() ? "" : " ", f.what, f.expected, f.seen);
}

std::string merged_junit(const Campaign& campaign, const Results& results) {
  const Counts counts = count_results(campaign, results);
  std::string body;
  double time_s = 0;
  for (std::uint64_t k = 1; k <= campaign.cases(); ++k) {
    const CaseResult* r = result_of(results, k);
    const double end_s = r == nullptr ? 0 : static_cast<double>(r->end_ns) * 1e-9;
    time_s += end_s;
    body += fmt::format("    <testcase classname=\"{}\" name=\"case {}: {}\" time=\"{:.3f}\"", xml_text(campaign.name),
                        k, xml_text(campaign.shown_values(k)), end_s);
    if (r != nullptr && r->verdict == CaseVerdict::kPassed) {
      body += "/>\n";
      continue;
    }
    body += ">\n";
    if (r != nullptr && r->verdict == CaseVerdict::kFailed) {
      for (const Failure& f : r->failures)
        body += "      <failure message=\"" + xml_text(f.what + ": expected " + f.expected + ", seen " + f.seen) +
                "\">" + xml_text(failure_lines(f)) + "</failure>\n";
      if (r->failed_checks > r->failures.size())
        body += fmt::format("      <system-out>{} more checks failed.</system-out>\n",
                            r->failed_checks - r->failures.size());
    } else {
      body += "      <error message=\"" + xml_text(first_failure(r)) + "\">" + xml_text(r == nullptr ? "" : r->reason) +
              "</error>\n";
    }
    body += "    </testcase>\n";
  }
  const std::uint64_t errors = counts.not_run + counts.crashed + counts.missing;
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"vinverter\" tests=\"{0}\" failures=\"{1}\" "
      "errors=\"{2}\">\n"
      "  <testsuite name=\"{3}\" tests=\"{0}\" failures=\"{1}\" errors=\"{2}\" skipped=\"0\" time=\"{4:.3f}\">\n{5}"
      "  </testsuite>\n</testsuites>\n",
      campaign.cases(), counts.failed, errors, xml_text(campaign.name), time_s, body);
}

std::string merged_csv(const Campaign& campaign, const Results& results) {
  std::string out = "case,verdict,alarm,end_s,checks,failed_checks";
  for (const std::string& a : campaign.axes()) out += "," + csv_field(a);
  for (const Measure& m : campaign.measures) out += "," + csv_field(m.name + " [" + m.unit + "]");
  out += ",first_failure\r\n";
  for (std::uint64_t k = 1; k <= campaign.cases(); ++k) {
    const CaseResult* r = result_of(results, k);
    out += fmt::format("{},{},", k, r == nullptr ? "missing" : verdict_word(r->verdict));
    if (r != nullptr)
      out += fmt::format("{},{},{},{}", csv_field(r->alarm), seconds(r->end_ns), r->checks, r->failed_checks);
    else
      out += ",,,";
    const Assignment values = campaign.assignment(k);
    for (const std::string& a : campaign.axes()) {
      out += ",";
      for (const auto& [name, value] : values)
        if (name == a) out += csv_field(value);
    }
    for (std::size_t i = 0; i < campaign.measures.size(); ++i)
      out += r != nullptr && r->measured[i] ? fmt::format(",{:.7g}", *r->measured[i]) : ",";
    out += "," + csv_field(first_failure(r)) + "\r\n";
  }
  return out;
}

}  // namespace vinv::campaign
