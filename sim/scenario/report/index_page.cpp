#include "sim/scenario/report/index_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sim/scenario/report/text.hpp"
#include "vinv_scenario_report_data.hpp"

namespace vinv::scenario {
namespace {

void append_row(std::string& page, const IndexEntry& e) {
  const std::string_view verdict = verdict_word(e.verdict);
  const std::string_view css_class = e.verdict == Verdict::kNotRun ? "notrun" : verdict;
  const std::string title = html_text(e.title.empty() ? e.name : e.title);
  page += fmt::format("<tr class=\"{}\"><td>{}</td><td>", css_class, verdict);
  page += e.page.empty() ? title : fmt::format("<a href=\"{}\">{}</a>", url_text(e.page), title);
  page += fmt::format("<br><small>{}, seed {}</small></td><td class=\"n\" data-sort=\"{}\">{}</td>",
                      html_text(shown_path(e.path)), e.seed, to_ns(e.end), seconds_text(e.end));
  page += fmt::format("<td class=\"n\" data-sort=\"{}\">{} of {}</td><td>", e.failures, e.failures, e.checks);
  if (!e.first_failure.empty()) {
    if (!e.page.empty() && e.verdict == Verdict::kFailed) {
      const std::string t = seconds_text(e.first_failure_at);
      page += fmt::format("<a href=\"{}#t={}\">{} s</a> ", url_text(e.page), t, t);
    }
    page += html_text(e.first_failure);
  }
  for (const std::string& sentence : e.unwritten) page += "<p class=\"reason\">" + html_text(sentence) + "</p>";
  page += "</td><td>";
  for (std::size_t i = 0; i < e.files.size(); ++i) {
    page += fmt::format("{}<a href=\"{}\">{}</a>", i > 0 ? " · " : "", url_text(e.files[i].name),
                        html_text(e.files[i].label));
  }
  page += "</td></tr>\n";
}

}  // namespace

IndexEntry index_entry(const RunResult& result) {
  IndexEntry e;
  e.verdict = result.verdict;
  e.name = result.name;
  e.title = result.title;
  e.path = result.path;
  e.seed = result.seed;
  e.end = result.end;
  e.checks = result.checks.size();
  e.failures = result.failures();
  e.first_failure = result.reason;
  const auto failed = std::find_if(result.checks.begin(), result.checks.end(), [](const auto& c) { return !c.passed; });
  if (failed != result.checks.end()) {
    e.first_failure_at = failed->at;
    e.first_failure = fmt::format("{}{}{}: expected {}, seen {}", failed->drive, failed->drive.empty() ? "" : " ",
                                  failed->what, failed->expected, failed->seen);
  }
  return e;
}

std::string index_page(const std::vector<IndexEntry>& entries, const std::string& build) {
  const auto count = [&](Verdict v) {
    return std::count_if(entries.begin(), entries.end(), [&](const IndexEntry& e) { return e.verdict == v; });
  };
  const auto failed = count(Verdict::kFailed);
  const auto not_run = count(Verdict::kNotRun);
  const std::string summary =
      fmt::format("{} passed, {} failed, {} could not run", count(Verdict::kPassed), failed, not_run);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'\">\n<title>" +
      summary + "</title>\n<style>\n";
  page += data::REPORT_CSS;
  page += "</style>\n</head>\n<body>\n<header>\n";
  page += fmt::format("<p class=\"verdict {0}\">{0}</p>\n<h1>Scenarios: {1}</h1>\n",
                      failed + not_run > 0 ? "failed" : "passed", summary);
  if (!build.empty()) page += "<p class=\"note\">" + html_text(build) + "</p>\n";
  page +=
      "</header>\n<main>\n<div id=\"tools\" class=\"bar\"></div>\n<div class=\"scroll\"><table id=\"runs\"><thead><tr>"
      "<th>verdict</th><th>scenario</th><th>duration, s</th><th>failed checks</th><th>first failure</th><th>files</th>"
      "</tr></thead><tbody>\n";
  for (const IndexEntry& e : entries) append_row(page, e);
  page += "</tbody></table></div>\n</main>\n<script>\n";
  page += data::INDEX_JS;
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace vinv::scenario
