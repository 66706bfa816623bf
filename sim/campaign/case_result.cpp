#include "sim/campaign/case_result.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sim/scenario/report/text.hpp"
#include "sim/scenario/virtual_run.hpp"

namespace vinv::campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kVerdicts{"passed", "failed", "not run", "crashed"};

std::optional<double> measured(const scenario::Recording& recording, const Measure& m) {
  const auto* column = recording.find(m.drive, m.signal);
  std::optional<double> out;
  if (column == nullptr) return out;
  for (const double v : column->values) {
    if (!std::isfinite(v)) continue;
    if (!out || m.kind == Measure::Kind::kLast || (m.kind == Measure::Kind::kMaximum ? v > *out : v < *out)) out = v;
  }
  return out;
}

}  // namespace

std::string_view verdict_word(CaseVerdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)]; }

std::string to_line(const CaseResult& r) {
  Json j;
  j["case"] = r.number;
  j["verdict"] = verdict_word(r.verdict);
  if (!r.alarm.empty()) j["alarm"] = r.alarm;
  if (!r.reason.empty()) j["reason"] = scenario::clean_utf8(r.reason);
  j["end_ns"] = r.end_ns;
  j["checks"] = r.checks;
  j["failed_checks"] = r.failed_checks;
  if (!r.failures.empty()) j["failures"] = Json::array();
  for (const Failure& f : r.failures) {
    Json o;
    o["at_ns"] = f.at_ns;
    o["line"] = f.line;
    for (const auto& [key, text] :
         {std::pair("drive", &f.drive), std::pair("what", &f.what), std::pair("expected", &f.expected),
          std::pair("seen", &f.seen), std::pair("cause", &f.cause)})
      o[key] = scenario::clean_utf8(*text);
    j["failures"].push_back(std::move(o));
  }
  if (!r.measured.empty()) j["measured"] = Json::array();
  for (const auto& m : r.measured) j["measured"].push_back(m ? Json(*m) : Json());
  j["digest"] = r.digest;
  j["build"] = r.build;
  return j.dump();
}

std::optional<CaseResult> from_line(std::string_view line) {
  const Json j = Json::parse(line, nullptr, false);
  if (!j.is_object()) return {};
  CaseResult r;
  try {
    r.number = j.at("case").get<std::uint64_t>();
    const auto word = std::find(kVerdicts.begin(), kVerdicts.end(), j.at("verdict").get<std::string>());
    if (word == kVerdicts.end()) return {};
    r.verdict = static_cast<CaseVerdict>(word - kVerdicts.begin());
    r.alarm = j.value("alarm", "");
    r.reason = j.value("reason", "");
    r.end_ns = j.at("end_ns").get<std::int64_t>();
    r.checks = j.at("checks").get<std::size_t>();
    r.failed_checks = j.at("failed_checks").get<std::size_t>();
    for (const Json& o : j.value("failures", Json::array())) {
      r.failures.push_back({o.at("drive").get<std::string>(), o.at("what").get<std::string>(),
                            o.at("expected").get<std::string>(), o.at("seen").get<std::string>(),
                            o.at("cause").get<std::string>(), o.at("at_ns").get<std::int64_t>(),
                            o.at("line").get<int>()});
    }
    for (const Json& m : j.value("measured", Json::array()))
      r.measured.push_back(m.is_null() ? std::nullopt : std::optional(m.get<double>()));
    r.digest = j.at("digest").get<std::string>();
    r.build = j.at("build").get<std::string>();
  } catch (const Json::exception&) {
    return {};
  }
  return r;
}

CaseResult summary(const scenario::RunResult& run, const std::vector<Measure>& measures) {
  CaseResult out;
  out.verdict = run.verdict == scenario::Verdict::kPassed   ? CaseVerdict::kPassed
                : run.verdict == scenario::Verdict::kFailed ? CaseVerdict::kFailed
                                                            : CaseVerdict::kNotRun;
  out.reason = run.reason;
  out.end_ns = to_ns(run.end);
  out.checks = run.checks.size();
  out.failed_checks = run.failures();
  for (const scenario::CheckResult& c : run.checks)
    if (!c.passed && out.failures.size() < kMaxFailures)
      out.failures.push_back({c.drive, c.what, c.expected, c.seen, c.cause, to_ns(c.at), c.where.line});
  Instant first{};
  for (const scenario::StateTrace& s : run.recording.states) {
    if (s.name != scenario::text_words()[static_cast<std::size_t>(scenario::Text::kAlarm)]) continue;
    for (const auto& c : s.changes) {
      if (c.value == scenario::kNoAlarm) continue;
      if (out.alarm.empty() || c.at < first) {
        out.alarm = c.value;
        first = c.at;
      }
      break;
    }
  }
  for (const Measure& m : measures) out.measured.push_back(measured(run.recording, m));
  return out;
}

scenario::RunResult run_text(const std::string& text, const std::string& path, const scenario::LoadOptions& load,
                             const scenario::RunOptions& run) {
  try {
    return scenario::run_virtual(scenario::parse_scenario(text, path, load), load.catalogue, run);
  } catch (const std::exception& e) {
    scenario::RunResult out;
    out.path = path;
    out.name = std::filesystem::path(path).stem().string();
    out.reason = e.what();
    return out;
  }
}

}  // namespace vinv::campaign
