// The page over a campaign: histograms as SVG, so that it needs no scripts; they only sort and filter the table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sim/campaign/merge.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/report/text.hpp"
#include "vinv_campaign_data.hpp"

namespace vinv::campaign {
namespace {

using scenario::html_text;

constexpr std::size_t kMaxBars = 24;
constexpr std::size_t kParts = 20;  // of numbers that are more than that
constexpr std::size_t kMaxMapSide = 60;
constexpr std::array<const char*, 3> kClasses{"passed", "failed", "other"};

int class_of(const CaseResult* r) {
  if (r == nullptr || r->verdict == CaseVerdict::kNotRun || r->verdict == CaseVerdict::kCrashed) return 2;
  return r->verdict == CaseVerdict::kPassed ? 0 : 1;
}

bool split_number(const std::string& text, double& number, std::string& unit) {
  const std::size_t end = std::min(text.find_first_not_of("+-.0123456789"), text.size());
  unit = text.substr(end);
  return rig::parse_number(text.substr(0, end), number);
}

std::string chart(const std::string& title, const std::vector<Bar>& bars) {
  constexpr double kWidth = 360, kHeight = 120, kFoot = 46;
  std::uint64_t most = 1;
  for (const Bar& b : bars) most = std::max(most, b.counts[0] + b.counts[1] + b.counts[2]);
  const double step = kWidth / static_cast<double>(std::max<std::size_t>(bars.size(), 1));
  std::string out = fmt::format(
      "<figure><figcaption>{}</figcaption><svg width=\"{:.0f}\" height=\"{:.0f}\" role=\"img\" aria-label=\"{}\">",
      html_text(title), kWidth + 40, kHeight + kFoot + 14, html_text(title));
  out += fmt::format(
      "<text x=\"0\" y=\"10\">{}</text><line class=\"axis\" x1=\"0\" x2=\"{:.0f}\" y1=\"{:.0f}\" y2=\"{:.0f}\"/>", most,
      kWidth, kHeight + 14, kHeight + 14);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const Bar& b = bars[i];
    const double x = step * static_cast<double>(i);
    double y = kHeight + 14;
    out += fmt::format("<g><title>{}: {} passed, {} failed, {} neither</title>", html_text(b.label), b.counts[0],
                       b.counts[1], b.counts[2]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double h = kHeight * static_cast<double>(b.counts[c]) / static_cast<double>(most);
      y -= h;
      if (b.counts[c] > 0)
        out += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                           kClasses[c], x + 1, y, std::max(step - 2, 1.0), h);
    }
    out += "</g>";
    if (bars.size() <= 12 || i % ((bars.size() + 9) / 10) == 0)
      out += fmt::format("<text transform=\"translate({:.1f},{:.0f}) rotate(35)\">{}</text>", x + 2, kHeight + 24,
                         html_text(b.label));
  }
  return out + "</svg></figure>\n";
}

// Over the two things that a grid varies, in the cases from first to before end: which pairs of values fail.
std::string map_of(const Campaign& campaign, const std::vector<Axis>& grid, std::uint64_t first, std::uint64_t end,
                   const std::vector<int>& classes) {
  std::vector<std::array<std::string, 2>> values;
  for (std::uint64_t k = first; k < end; ++k) {
    std::array<std::string, 2>& pair = values.emplace_back();
    for (const auto& [name, value] : campaign.assignment(k))
      for (std::size_t i = 0; i < 2; ++i)
        if (name == grid[i].name) pair[i] = value;
  }
  const auto ordered = [&](std::size_t which) {
    std::vector<std::string> out;
    std::set<std::string> seen;
    for (const auto& v : values)
      if (seen.insert(v[which]).second) out.push_back(v[which]);
    std::stable_sort(out.begin(), out.end(), [](const std::string& a, const std::string& b) {
      double x = 0, y = 0;
      std::string u, v;
      return split_number(a, x, u) && split_number(b, y, v) && u == v && x < y;
    });
    return out;
  };
  const auto columns = ordered(0);
  const auto rows = ordered(1);
  if (columns.size() < 2 || rows.size() < 2 || columns.size() > kMaxMapSide || rows.size() > kMaxMapSide) return {};
  std::map<std::array<std::string, 2>, std::array<std::uint64_t, 3>> cells;
  for (std::size_t i = 0; i < values.size(); ++i) ++cells[values[i]][static_cast<std::size_t>(classes[first - 1 + i])];
  std::string out = fmt::format(
      "<figure><figcaption>{} across, {} down: how many failed</figcaption><div class=\"scroll\"><table "
      "class=\"map\"><tr><th></th>",
      html_text(grid[0].name), html_text(grid[1].name));
  for (const auto& c : columns) out += "<th>" + html_text(c) + "</th>";
  out += "</tr>\n";
  for (const auto& r : rows) {
    out += "<tr><th>" + html_text(r) + "</th>";
    for (const auto& c : columns) {
      const auto cell = cells.find({c, r});
      if (cell == cells.end()) {
        out += "<td></td>";
        continue;
      }
      const auto& n = cell->second;
      out += fmt::format("<td class=\"{}\">{}</td>", n[1] > 0 ? "failed" : n[2] > 0 ? "other" : "passed", n[1]);
    }
    out += "</tr>\n";
  }
  return out + "</table></div></figure>\n";
}

}  // namespace

std::vector<Bar> bars_of(const std::vector<std::pair<std::string, int>>& points) {
  std::map<std::string, Bar> by_text;
  std::vector<std::string> order;
  bool numbers = true;
  std::string unit;
  for (const auto& [text, c] : points) {
    const auto [it, added] = by_text.emplace(text, Bar{text, {}});
    ++it->second.counts[static_cast<std::size_t>(c)];
    if (!added) continue;
    double number = 0;
    std::string own;
    numbers = split_number(text, number, own) && numbers && (order.empty() || own == unit);
    unit = own;
    order.push_back(text);
  }
  const auto value = [](const std::string& text) {
    double number = 0;
    std::string rest;
    split_number(text, number, rest);
    return number;
  };
  std::vector<Bar> out;
  if (numbers && order.size() > kMaxBars) {
    double low = value(order.front()), high = low;
    for (const auto& text : order) {
      low = std::min(low, value(text));
      high = std::max(high, value(text));
    }
    const double width = (high - low) / static_cast<double>(kParts);
    for (std::size_t i = 0; i < kParts; ++i)
      out.push_back({fmt::format("{:.4g} to {:.4g}{}", low + width * static_cast<double>(i),
                                 low + width * static_cast<double>(i + 1), unit),
                     {}});
    for (const auto& [text, bar] : by_text) {
      const auto part = std::min(static_cast<std::size_t>((value(text) - low) / width), kParts - 1);
      for (std::size_t c = 0; c < 3; ++c) out[part].counts[c] += bar.counts[c];
    }
    return out;
  }
  if (numbers) {
    std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) { return value(a) < value(b); });
  } else if (order.size() > kMaxBars) {
    std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
      const auto sum = [&](const std::string& t) {
        return by_text[t].counts[0] + by_text[t].counts[1] + by_text[t].counts[2];
      };
      return sum(a) > sum(b);
    });
  }
  for (const auto& text : order) {
    if (out.size() < kMaxBars) {
      out.push_back(by_text[text]);
      continue;
    }
    out.back().label = "others";
    for (std::size_t c = 0; c < 3; ++c) out.back().counts[c] += by_text[text].counts[c];
  }
  return out;
}

std::string merged_page(const Campaign& campaign, const Results& results, const std::string& build) {
  const Counts counts = count_results(campaign, results);
  const std::string summary = counts_text(counts);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'\">\n<title>" +
      html_text(campaign.title) + "</title>\n<style>\n";
  page += data::REPORT_CSS;
  page += data::CAMPAIGN_CSS;
  page += "</style>\n</head>\n<body>\n<header>\n";
  page += fmt::format("<p class=\"verdict {0}\">{0}</p>\n<h1>{1}</h1>\n<p>{2}, {3}</p>\n",
                      counts.all_passed() ? "passed" : "failed", html_text(campaign.title), html_text(campaign.name),
                      summary);
  if (!build.empty()) page += "<p class=\"note\">" + html_text(build) + "</p>\n";
  page += "</header>\n<main>\n<h2>What varies</h2>\n<div class=\"charts\">\n";

  std::map<std::string, std::vector<std::pair<std::string, int>>> by_axis;
  std::vector<std::pair<std::string, int>> alarms, failures;
  std::vector<std::vector<std::pair<std::string, int>>> measured(campaign.measures.size());
  std::vector<int> classes;
  for (std::uint64_t k = 1; k <= campaign.cases(); ++k) {
    const auto it = results.cases.find(k);
    const CaseResult* r = it == results.cases.end() ? nullptr : &it->second;
    const int c = class_of(r);
    classes.push_back(c);
    for (const auto& [name, value] : campaign.assignment(k)) by_axis[name].emplace_back(value, c);
    if (r == nullptr) continue;
    alarms.emplace_back(r->alarm.empty() ? "none" : r->alarm, c);
    if (!r->failures.empty()) {
      const Failure& f = r->failures.front();
      failures.emplace_back(f.drive + (f.drive.empty() ? "" : " ") + f.what, c);
    }
    for (std::size_t i = 0; i < measured.size(); ++i)
      if (r->measured[i]) measured[i].emplace_back(fmt::format("{:.6f}", *r->measured[i]), c);
  }
  for (const std::string& axis : campaign.axes()) page += chart(axis, bars_of(by_axis[axis]));
  std::uint64_t first = 1;
  for (const Block& block : campaign.blocks) {
    const std::uint64_t end = first + block.cases(kMaxCases).value();
    if (block.grid.size() == 2) page += map_of(campaign, block.grid, first, end, classes);
    first = end;
  }
  page += "</div>\n<h2>What came of it</h2>\n<div class=\"charts\">\n" + chart("first alarm", bars_of(alarms));
  if (!failures.empty()) page += chart("first check that failed", bars_of(failures));
  for (std::size_t i = 0; i < measured.size(); ++i) {
    std::vector<Bar> bars = bars_of(measured[i]);
    if (!bars.empty()) page += chart(fmt::format("{}, {}", campaign.measures[i].name, campaign.measures[i].unit), bars);
  }
  page += "</div>\n<h2>Cases</h2>\n";

  std::vector<std::uint64_t> shown;
  for (const bool passed : {false, true})
    for (std::uint64_t k = 1; k <= campaign.cases() && shown.size() < kMaxRows; ++k)
      if ((classes[k - 1] == 0) == passed) shown.push_back(k);
  if (shown.size() < campaign.cases())
    page += fmt::format("<p class=\"note\">{} of {} cases, those that did not pass first; the CSV file has all.</p>\n",
                        shown.size(), campaign.cases());
  std::sort(shown.begin(), shown.end());
  page +=
      "<div id=\"tools\" class=\"bar\"></div>\n<div class=\"scroll\"><table "
      "id=\"runs\"><thead><tr><th>verdict</th><th>case</th><th>alarm</th><th>duration, s</th>";
  for (const std::string& a : campaign.axes()) page += "<th>" + html_text(a) + "</th>";
  for (const Measure& m : campaign.measures) page += "<th>" + html_text(m.name + ", " + m.unit) + "</th>";
  page += "<th>first failure</th></tr></thead><tbody>\n";
  for (const std::uint64_t k : shown) {
    const auto it = results.cases.find(k);
    const CaseResult* r = it == results.cases.end() ? nullptr : &it->second;
    const std::string_view word = r == nullptr ? "missing" : verdict_word(r->verdict);
    page += fmt::format("<tr class=\"{}\"><td>{}</td><td class=\"n\" data-sort=\"{}\">{}</td><td>{}</td>",
                        word == "not run" ? "notrun" : word, word, k, k, r == nullptr ? "" : html_text(r->alarm));
    page += r == nullptr ? "<td data-sort=\"0\"></td>"
                         : fmt::format("<td class=\"n\" data-sort=\"{}\">{}</td>", r->end_ns,
                                       scenario::seconds_text(Instant{Duration{r->end_ns}}));
    const Assignment values = campaign.assignment(k);
    for (const std::string& a : campaign.axes()) {
      page += "<td>";
      for (const auto& [name, value] : values)
        if (name == a) page += html_text(value);
      page += "</td>";
    }
    for (std::size_t i = 0; i < campaign.measures.size(); ++i)
      page +=
          r != nullptr && r->measured[i] ? fmt::format("<td class=\"n\">{:.5g}</td>", *r->measured[i]) : "<td></td>";
    page += "<td>" + html_text(word == "passed" ? "" : first_failure(r)) + "</td></tr>\n";
  }
  page += "</tbody></table></div>\n</main>\n<script>\n";
  page += data::INDEX_JS;
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace vinv::campaign
