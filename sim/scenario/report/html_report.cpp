#include "sim/scenario/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_data.hpp"
#include "sim/scenario/report/text.hpp"
#include "vinv_scenario_report_data.hpp"

namespace vinv::scenario {
namespace {

constexpr std::size_t kEventsBeforeCheck = 5;

std::string time_link(Instant at) {
  const std::string t = seconds_text(at);
  return fmt::format("<a class=\"t\" href=\"#t={}\">{}</a>", t, t);
}

std::string count_text(std::size_t n, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

void append_head(std::string& page, const RunResult& result, const std::string& title) {
  page += "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'\">\n";
  page += "<title>" + html_text(std::string(verdict_word(result.verdict)) + ": " + title) + "</title>\n<style>\n";
  page += data::UPLOT_CSS;
  page += '\n';
  page += data::REPORT_CSS;
  page += "</style>\n</head>\n<body>\n";
}

void append_plant(std::string& page, const Scenario& scenario) {
  page +=
      "<details><summary>Plant and "
      "variables</summary>\n<table><thead><tr><th>drive</th><th>inverter</th><th>board</th></tr>"
      "</thead><tbody>\n";
  for (const rig::DriveSpec& d : scenario.plant.drives) {
    page += "<tr><td>" + html_text(d.name) + "</td><td>" + html_text(d.model.value) + "</td><td>";
    if (d.board) page += html_text(fmt::format("{}, node {}", d.board->type.value, d.board->node.value));
    page += "</td></tr>\n";
  }
  page += "</tbody></table>\n";
  if (!scenario.variables.empty()) {
    page += "<table><thead><tr><th>variable</th><th>value</th></tr></thead><tbody>\n";
    for (const auto& [name, value] : scenario.variables)
      page += "<tr><td>" + html_text(name) + "</td><td>" + html_text(value) + "</td></tr>\n";
    page += "</tbody></table>\n";
  }
  page += "</details>\n";
}

void append_summary(std::string& page, const Scenario* scenario, const RunResult& result, const std::string& title,
                    const std::string& build, const std::vector<ReportFile>& files) {
  const std::string_view verdict = verdict_word(result.verdict);
  const std::string_view css_class = result.verdict == Verdict::kNotRun ? "notrun" : verdict;
  page += fmt::format("<header>\n<p class=\"verdict {}\">{}</p>\n<h1>{}</h1>\n<dl class=\"facts\">\n", css_class,
                      verdict, html_text(title));
  const auto fact = [&](std::string_view name, const std::string& text) {
    page += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, text);
  };
  fact("scenario", html_text(shown_path(result.path)));
  fact("duration", html_text(seconds_text(result.end)) + " s of virtual time");
  const std::size_t failures = result.failures();
  fact("checks", failures == 0 ? count_text(result.checks.size(), "check", "checks")
                               : fmt::format("{} of {} failed", failures, result.checks.size()));
  fact("seed", std::to_string(result.seed));
  if (!build.empty()) fact("made by", html_text(build));
  if (!files.empty()) {
    std::string links;
    for (const ReportFile& f : files) {
      links += fmt::format("{}<a href=\"{}\">{}</a>", links.empty() ? "" : " · ", url_text(f.name), html_text(f.label));
    }
    fact("files", links);
  }
  page += "</dl>\n";
  if (!result.reason.empty()) page += "<pre class=\"reason\">" + html_text(result.reason) + "</pre>\n";
  std::size_t trips = 0;
  for (const Event& e : result.events) {
    if (e.kind != Event::Kind::kTrip || ++trips > kMaxEventsWithoutScripts) continue;
    page += fmt::format("{}<li>{} s {} {}</li>\n", trips == 1 ? "<ul class=\"trips\">\n" : "", time_link(e.at),
                        html_text(e.drive), html_text(e.text));
  }
  if (trips > 0) page += "</ul>\n";
  if (scenario != nullptr) append_plant(page, *scenario);
  page += "</header>\n<main>\n";
}

void append_check(std::string& page, const RunResult& result, const CheckResult& c) {
  page += fmt::format(
      "<tr class=\"{}\"><td>{}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td "
      "class=\"n\">{}</td></tr>\n",
      c.passed ? "passed" : "failed", c.passed ? "passed" : "failed", time_link(c.at), html_text(c.drive),
      html_text(c.what), html_text(c.expected), html_text(c.seen),
      c.where.line > 0 ? std::to_string(c.where.line) : "");
  if (c.passed) return;
  const std::size_t end = std::min(c.events_before, result.events.size());
  if (c.cause.empty() && end == 0) return;
  page += "<tr class=\"more\"><td></td><td colspan=\"6\">";
  if (!c.cause.empty()) page += "<p><b>Cause</b> " + html_text(c.cause) + "</p>";
  if (end > 0) {
    page += "<p><b>Last events before it</b></p><ul>";
    for (std::size_t i = end - std::min(end, kEventsBeforeCheck); i < end; ++i) {
      const Event& e = result.events[i];
      page += fmt::format("<li>{} s {} {}</li>", time_link(e.at), html_text(e.drive), html_text(e.text));
    }
    page += "</ul>";
  }
  page += "</td></tr>\n";
}

void append_checks(std::string& page, const RunResult& result) {
  page += "<section id=\"checks\">\n<h2>Checks</h2>\n";
  if (result.checks.empty()) {
    page += "<p>None.</p>\n</section>\n";
    return;
  }
  page +=
      "<div class=\"scroll\"><table><thead><tr><th>result</th><th>time, "
      "s</th><th>drive</th><th>check</th><th>expected</th>"
      "<th>seen</th><th>line</th></tr></thead><tbody>\n";
  std::size_t shown = 0;
  for (const bool passed : {false, true}) {
    for (const CheckResult& c : result.checks) {
      if (c.passed == passed && ++shown <= kMaxChecksShown) append_check(page, result, c);
    }
  }
  page += "</tbody></table></div>\n";
  if (shown > kMaxChecksShown) page += fmt::format("<p>{} more passed or failed.</p>\n", shown - kMaxChecksShown);
  page += "</section>\n";
}

void append_signals(std::string& page, const Recording& r) {
  page += "<section id=\"signals\">\n<h2>Signals</h2>\n";
  if (r.times.empty()) {
    page += "<p>None recorded.</p>\n</section>\n";
    return;
  }
  page += fmt::format("<p class=\"note\">{} of {}, every {:g} ms", count_text(r.times.size(), "sample", "samples"),
                      count_text(r.columns.size(), "signal", "signals"), to_seconds(r.coarsest) * 1e3);
  if (r.windows > 0 && r.finest < r.coarsest) {
    page += fmt::format(", and every {:g} ms in {} around what happened", to_seconds(r.finest) * 1e3,
                        count_text(r.windows, "span", "spans"));
  }
  page += '.';
  if (r.windows_lost > 0)
    page += fmt::format(" {} are only as fine as the rest.", count_text(r.windows_lost, "more span", "more spans"));
  page += "</p>\n<noscript><p class=\"note\">The plots need scripts; the files have the same data.</p></noscript>\n";
  page += "<div id=\"plots\"></div>\n</section>\n";
}

void append_events(std::string& page, const RunResult& result) {
  page += "<section id=\"events\">\n<h2>Events</h2>\n";
  if (result.events_lost > 0) {
    page += fmt::format("<p class=\"note\">{} after the last one are not recorded.</p>\n",
                        count_text(result.events_lost, "event", "events"));
  }
  page +=
      "<div id=\"event-table\"><div class=\"scroll\"><table><thead><tr><th>time, s</th><th>kind</th><th>drive</th>"
      "<th>event</th><th>line</th></tr></thead><tbody>\n";
  const std::size_t shown = std::min(result.events.size(), kMaxEventsWithoutScripts);
  for (std::size_t i = 0; i < shown; ++i) {
    const Event& e = result.events[i];
    page += fmt::format(
        "<tr class=\"{0}\"><td class=\"n\">{1}</td><td>{0}</td><td>{2}</td><td>{3}</td><td class=\"n\">{4}</td></tr>\n",
        kind_word(e.kind), time_link(e.at), html_text(e.drive), html_text(e.text),
        e.line > 0 ? std::to_string(e.line) : "");
  }
  page += "</tbody></table></div>\n";
  if (result.events.size() > shown)
    page += fmt::format("<p>{} more: in the events file.</p>\n", result.events.size() - shown);
  page += "</div>\n</section>\n";
}

void append_wire(std::string& page, const Recording& recording) {
  if (recording.wire.empty()) return;
  page += fmt::format("<section id=\"wires\">\n<h2>Wire log</h2>\n<p class=\"note\">{}.{}</p>\n",
                      count_text(recording.wire.size(), "record", "records"),
                      recording.wire.size() > kMaxWireRecordsInPage
                          ? fmt::format(" The first {} are here, all in the files.", kMaxWireRecordsInPage)
                          : "");
  page += "<noscript><p class=\"note\">The log needs scripts; the files have the same data.</p></noscript>\n";
  page += "<div id=\"wire-table\"></div>\n</section>\n";
}

}  // namespace

std::string_view verdict_word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPassed: return "passed";
    case Verdict::kFailed: return "failed";
    case Verdict::kNotRun: return "not run";
  }
  return "not run";
}

std::string html_report(const Scenario* scenario, const RunResult& result, const std::string& build,
                        const std::vector<ReportFile>& files) {
  const std::string title = result.title.empty() ? result.name : result.title;
  std::string page;
  append_head(page, result, title);
  append_summary(page, scenario, result, title, build, files);
  if (result.verdict != Verdict::kNotRun || !result.checks.empty()) append_checks(page, result);
  append_signals(page, result.recording);
  append_events(page, result);
  append_wire(page, result.recording);
  page += "</main>\n";
  append_data_elements(page, result);
  page += "<!-- uPlot is used under this licence:\n";
  page += data::UPLOT_LICENSE;
  page += "-->\n<script>\n";
  page += data::UPLOT_JS;
  for (const std::string_view script :
       {data::BASE_JS, data::TABLES_JS, data::LANES_JS, data::PANES_JS, data::PAGE_JS}) {
    page += "</script>\n<script>\n";
    page += script;
  }
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace vinv::scenario
