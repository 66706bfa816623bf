#include "sim/scenario/check_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/node_values.hpp"
#include "sim/scenario/scenario_file.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {

std::optional<Step::What> CheckReader::check(const YAML::Node& value) const {
  Condition all = value.IsMap() ? reader_.mapping(value, "check", {}) : reader_.condition(value, "check");
  if (all.empty()) return {};
  return Check{std::move(all)};
}

std::optional<Step::What> CheckReader::reached(const YAML::Node& value) const {
  const rig::YamlMap map(value, "reached", nullptr, problems_);
  if (!map) return {};
  Reached r;
  const YAML::Node* within = map.find("within");
  const YAML::Node* tolerance = map.find("tolerance");
  if (within == nullptr) {
    if (!map.has("within")) problems_.add(map.at(), "reached lacks \"within\", the time that it may take.");
    return {};
  }
  const auto limit = read_duration(*within, "within", std::chrono::milliseconds(1), problems_);
  if (const YAML::Node* node = map.find("not_before")) {
    r.not_before = read_duration(*node, "not_before", Duration{}, problems_);
    if (!r.not_before) return {};
  }
  bool any = false;
  for (const auto& e : map.entries()) {
    if (e.key == "within" || e.key == "tolerance" || e.key == "not_before") continue;
    if (any) {
      problems_.add(e.at, "reached waits for one thing; \"" + e.key + "\" is the second.");
      return {};
    }
    any = true;
    if (e.empty) return {};
    if (e.key == "terminals" || e.key == "parameters") {
      const Condition all = reader_.mapping(value, "reached", {"within", "not_before"});
      if (all.size() > 1)
        problems_.add(e.at, "reached waits for one thing; there are " + std::to_string(all.size()) + ".");
      if (all.size() != 1) return {};
      r.target = all.front();
      continue;
    }
    const auto what = reader_.observable(e.key, e.at);
    if (!what) return {};
    // A plain value without tolerance: passing through it is enough.
    const std::string& text = e.value.IsScalar() ? e.value.Scalar() : std::string{};
    if (what->kind == Observable::Kind::kSignal && tolerance == nullptr && !text.empty() &&
        (std::isdigit(static_cast<unsigned char>(text[0])) != 0 || text[0] == '-' || text[0] == '.') &&
        text.find("..") == std::string::npos && text.find("+-") == std::string::npos &&
        text.find("\u00b1") == std::string::npos) {
      const auto target = reader_.value(e.value, *what);
      if (!target) return {};
      r.crossing = true;
      r.target.what = *what;
      r.target.low = r.target.high = r.target.target = *target;
      r.target.shown = text;
    } else {
      const auto target = reader_.expectation(e.key, e.at, e.value, tolerance);
      if (!target) return {};
      r.target = *target;
    }
  }
  if (!any) {
    problems_.add(map.at(), "reached names nothing to wait for, as {output_frequency: 50 Hz, within: 5.2 s}.");
    return {};
  }
  if (!limit) return {};
  r.within = *limit;
  return r;
}

std::optional<Step::What> CheckReader::ramp(const YAML::Node& value) const {
  constexpr std::string_view kForm =
      "{signal: output_frequency, from: 0 Hz, to: 50 Hz, time: 5 s, tolerance: 100 ms, linearity: 0.2 Hz}";
  const rig::YamlMap map(value, "ramp", &scenario_keys().at("steps[].ramp"), problems_);
  if (!map) return {};
  for (const char* key : {"signal", "from", "to", "time", "tolerance"})
    if (!map.has(key)) {
      problems_.add(map.at(), "ramp lacks \"" + std::string(key) + "\"; it takes " + std::string(kForm) + ".");
      return {};
    }
  Ramp r;
  const auto name = map.text("signal");
  const auto what = name ? reader_.signal(*name, rig::position_of(*map.find("signal"))) : std::nullopt;
  const auto time = read_duration(*map.find("time"), "time of ramp", std::chrono::milliseconds(1), problems_);
  if (!what || !time) return {};
  r.what = *what;
  r.time = *time;
  const auto from = reader_.value(*map.find("from"), *what);
  const auto to = reader_.value(*map.find("to"), *what);
  std::optional<Duration> tolerance;
  const YAML::Node& t = *map.find("tolerance");
  if (t.IsScalar() && t.Scalar().ends_with('%')) {
    const auto fraction = rig::parse_quantity(t.Scalar(), rig::Dimension::kFraction);
    if (fraction)
      tolerance = seconds_to_duration(to_seconds(*time) * std::abs(*fraction));
    else
      problems_.add(t, "tolerance of ramp: " + fraction.error());
  } else {
    tolerance = read_duration(t, "tolerance of ramp", Duration{}, problems_);
  }
  if (const YAML::Node* linearity = map.find("linearity")) {
    r.linearity = reader_.distance(*linearity, *what, from && to ? *to - *from : 0);
    if (!r.linearity) return {};
  }
  if (!from || !to || !tolerance) return {};
  if (*from == *to) {
    problems_.add(*map.find("to"), "ramp ends where it begins.");
    return {};
  }
  r.from = *from;
  r.to = *to;
  r.tolerance = *tolerance;
  return r;
}

std::optional<Step::What> CheckReader::trip(const YAML::Node& value) const {
  const rig::YamlMap map(value, "trip", nullptr, problems_);
  if (!map) return {};
  const Keys own{"code", "within", "cause"};
  Trip t;
  if (const YAML::Node* code = map.find("code")) {
    const auto text = rig::read_text(*code, "code of trip", problems_);
    if (!text) return {};
    t.code = *text;
    const auto known = trial_.observer(drive_).drive().inverter->injectable_faults();
    if (!contains(known, t.code)) {
      problems_.add(*code, "code of trip is \"" + t.code + "\"; " + rig::allowed_words(t.code, known));
      return {};
    }
  } else if (!map.has("code")) {
    problems_.add(map.at(), "trip lacks \"code\", as {code: E.OV3, within: 2 s}.");
    return {};
  }
  if (!map.has("within")) {
    problems_.add(map.at(), "trip lacks \"within\", the time in which it comes.");
    return {};
  }
  const auto within = read_duration(*map.find("within"), "within", std::chrono::milliseconds(1), problems_);
  if (const YAML::Node* cause = map.find("cause")) {
    if (cause->IsScalar()) t.cause.push_back(cause->Scalar());
    for (const auto& word : *cause)
      if (word.IsScalar()) t.cause.push_back(word.Scalar());
    if (t.cause.empty())
      problems_.add(*cause, "cause of trip is " + rig::kind_of(*cause) + "; allowed: text, or a list of it.");
  }
  const bool more =
      std::any_of(map.entries().begin(), map.entries().end(), [&](const auto& e) { return !contains(own, e.key); });
  if (more) {
    t.with = reader_.mapping(value, "trip", own);
    if (t.with.empty()) return {};
  }
  if (!within) return {};
  t.within = *within;
  return t;
}

std::optional<Step::What> CheckReader::expect_frame(const YAML::Node& value) const {
  const rig::YamlMap map(value, "expect_frame", &scenario_keys().at("steps[].expect_frame"), problems_);
  if (!map) return {};
  constexpr std::string_view kForm = "{bytes: 05 06, mask: FF FF, within: 50 ms}";
  if (!map.has("bytes")) {
    problems_.add(map.at(), "expect_frame lacks \"bytes\", as " + std::string(kForm) + ".");
    return {};
  }
  if (map.has("within") == map.has("absent_for")) {
    problems_.add(map.at(), "expect_frame has either \"within\" or \"absent_for\", as " + std::string(kForm) + ".");
    return {};
  }
  ExpectFrame f;
  f.absent = map.has("absent_for");
  const char* const time = f.absent ? "absent_for" : "within";
  const auto bytes = read_hex(*map.find("bytes"), "bytes", problems_);
  const auto within = read_duration(*map.find(time), time, Duration{}, problems_);
  if (!bytes || !within) return {};
  f.bytes = *bytes;
  f.mask = Bytes(f.bytes.size(), 0xFF);
  if (const YAML::Node* node = map.find("mask")) {
    const auto mask = read_hex(*node, "mask", problems_);
    if (!mask) return {};
    if (mask->size() != f.bytes.size()) {
      problems_.add(*node, "mask has " + std::to_string(mask->size()) + " bytes, the frame has " +
                               std::to_string(f.bytes.size()) + "; allowed: the same number.");
      return {};
    }
    f.mask = *mask;
  }
  f.within = *within;
  return f;
}

}  // namespace vinv::scenario
