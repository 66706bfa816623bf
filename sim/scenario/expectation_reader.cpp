#include "sim/scenario/expectation_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Comparison {
  std::string_view word;
  bool upper;  // the value is an upper bound
  bool open;
};
// Longer spellings first.
constexpr std::array kComparisons{
    Comparison{">=", false, false},    Comparison{"<=", true, false},         Comparison{">", false, true},
    Comparison{"<", true, true},       Comparison{"at least ", false, false}, Comparison{"at most ", true, false},
    Comparison{"above ", false, true}, Comparison{"below ", true, true},
};

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && s.front() == ' ') s.remove_prefix(1);
  while (!s.empty() && s.back() == ' ') s.remove_suffix(1);
  return s;
}

}  // namespace

std::vector<std::string_view> ExpectationReader::names() const {
  std::vector<std::string_view> out;
  for (const auto& n : trial_.observer(drive_).signal_names()) out.push_back(n);
  out.insert(out.end(), state_words().begin(), state_words().end());
  out.insert(out.end(), text_words().begin(), text_words().end());
  return out;
}

std::optional<Observable> ExpectationReader::observable(std::string_view name, rig::Position at) const {
  const Observer& observer = trial_.observer(drive_);
  const auto index_of = [&](const auto& list) -> std::optional<std::size_t> {
    const auto it = std::find(list.begin(), list.end(), name);
    return it == list.end() ? std::nullopt : std::optional(static_cast<std::size_t>(it - list.begin()));
  };
  if (const auto i = index_of(observer.signal_names()))
    return Observable{Observable::Kind::kSignal, std::string(name), observer.signal_units()[*i], *i};
  if (const auto i = index_of(state_words())) return Observable{Observable::Kind::kState, std::string(name), "", *i};
  if (const auto i = index_of(text_words())) return Observable{Observable::Kind::kText, std::string(name), "", *i};
  auto known = names();
  known.insert(known.end(), {"terminals", "parameters"});
  problems_.add(at, "there is nothing called \"" + std::string(name) + "\" to look at in " +
                        observer.drive().spec.name + "." + rig::suggestion(name, known) +
                        " Allowed: " + rig::join(known, known.size()) + ".");
  return {};
}

std::optional<Observable> ExpectationReader::signal(std::string_view name, rig::Position at) const {
  const auto found = observable(name, at);
  if (!found || found->kind == Observable::Kind::kSignal) return found;
  const auto& signals = trial_.observer(drive_).signal_names();
  problems_.add(at, "\"" + std::string(name) + "\" is no number; allowed: " +
                        rig::join(std::vector<std::string_view>(signals.begin(), signals.end()), signals.size()) + ".");
  return {};
}

std::optional<double> ExpectationReader::value(const YAML::Node& node, const Observable& what) const {
  if (!node.IsScalar()) {
    problems_.add(node, what.name + " is " + rig::kind_of(node) + "; allowed: a value with its unit.");
    return {};
  }
  const auto parsed = parse_value(trimmed(node.Scalar()), what.unit);
  if (parsed) return *parsed;
  problems_.add(node, what.name + ": " + parsed.error());
  return {};
}

std::optional<double> ExpectationReader::distance(const YAML::Node& node, const Observable& what, double of) const {
  if (!node.IsScalar()) {
    problems_.add(node,
                  "tolerance of " + what.name + " is " + rig::kind_of(node) + "; allowed: a value with its unit.");
    return {};
  }
  return distance(node.Scalar(), rig::position_of(node), what, of);
}

std::optional<double> ExpectationReader::distance(std::string_view written, rig::Position at, const Observable& what,
                                                  double of) const {
  const std::string_view text = trimmed(written);
  auto parsed = parse_value(text, what.unit);
  if (what.unit != "%" && text.ends_with('%')) {
    parsed = parse_value(text, "%");
    if (parsed) parsed = std::abs(of) * *parsed / 100;
  }
  if (!parsed) {
    problems_.add(at, "tolerance of " + what.name + ": " + parsed.error());
    return {};
  }
  if (*parsed < 0) {
    problems_.add(at, "tolerance of " + what.name + " is \"" + std::string(text) + "\"; allowed: 0 or more.");
    return {};
  }
  return *parsed;
}

bool ExpectationReader::number(Expectation& e, const YAML::Node& node, std::string text,
                               const YAML::Node* tolerance) const {
  const std::string unit = e.what.kind == Observable::Kind::kSignal ? e.what.unit : "-";
  const auto parse = [&](std::string_view piece) -> std::optional<double> {
    const auto parsed = parse_value(trimmed(piece), unit);
    if (parsed) return *parsed;
    problems_.add(node, e.what.name + ": " + parsed.error());
    return {};
  };
  const std::string_view all = trimmed(text);
  for (const Comparison& c : kComparisons) {
    if (!all.starts_with(c.word)) continue;
    const auto bound = parse(all.substr(c.word.size()));
    if (!bound) return false;
    e.target = *bound;
    e.low = c.upper ? -kInfinity : *bound;
    e.high = c.upper ? *bound : kInfinity;
    (c.upper ? e.high_open : e.low_open) = c.open;
    return true;
  }
  if (const std::size_t dots = all.find(".."); dots != std::string_view::npos) {
    const auto low = parse(all.substr(0, dots));
    const auto high = parse(all.substr(dots + 2));
    if (!low || !high) return false;
    if (*low > *high) {
      problems_.add(node, e.what.name + " is \"" + std::string(all) + "\"; allowed: the smaller value first.");
      return false;
    }
    e.low = *low;
    e.high = *high;
    e.target = (*low + *high) / 2;
    return true;
  }
  std::size_t sign = all.find("+-");
  std::size_t sign_length = 2;
  if (sign == std::string_view::npos) sign = all.find("\u00b1");
  const auto target = parse(all.substr(0, sign));
  if (!target) return false;
  e.target = e.low = e.high = *target;
  std::optional<double> more;
  if (sign != std::string_view::npos) {
    more = distance(all.substr(sign + sign_length), rig::position_of(node), e.what, *target);
    if (!more) return false;
  } else if (tolerance != nullptr) {
    more = distance(*tolerance, e.what, *target);
    if (!more) return false;
    e.shown += " +- " + tolerance->Scalar();
  } else if (unit != "-") {
    problems_.add(node,
                  e.what.name + " is \"" + std::string(all) + "\" without a tolerance; write \"" + std::string(all) +
                      " +- ...\", a bound (below, at most, above, at least), a range (a .. b), or \"tolerance:\".");
    return false;
  }
  e.low -= more.value_or(0);
  e.high += more.value_or(0);
  return true;
}

std::optional<Expectation> ExpectationReader::expectation(std::string_view name, rig::Position at,
                                                          const YAML::Node& node, const YAML::Node* tolerance) const {
  Expectation e;
  const auto what = observable(name, at);
  if (!what) return {};
  e.what = *what;
  if (!node.IsScalar()) {
    problems_.add(node.IsNull() ? at : rig::position_of(node),
                  std::string(name) + " is " + rig::kind_of(node) + "; allowed: a value.");
    return {};
  }
  e.shown = node.Scalar();
  switch (e.what.kind) {
    case Observable::Kind::kText: e.text = node.Scalar(); return e;
    case Observable::Kind::kState: {
      const auto on = rig::read_switch(node, name, problems_);
      if (!on) return {};
      e.on = *on;
      return e;
    }
    default: break;
  }
  if (!number(e, node, node.Scalar(), tolerance)) return {};
  return e;
}

Condition ExpectationReader::mapping(const YAML::Node& node, const std::string& where,
                                     const std::vector<std::string_view>& own_keys) const {
  Condition out;
  const rig::YamlMap map(node, where, nullptr, problems_);
  if (!map) return out;
  const YAML::Node* tolerance = map.find("tolerance");
  bool any = false;
  for (const auto& entry : map.entries()) {
    if (entry.key == "tolerance" || std::find(own_keys.begin(), own_keys.end(), entry.key) != own_keys.end()) continue;
    any = true;
    if (entry.empty) continue;
    if (entry.key == "terminals") {
      const auto& known = trial_.observer(drive_).terminal_names();
      const std::vector<std::string_view> names_known(known.begin(), known.end());
      const rig::YamlMap terminals(entry.value, "terminals", &names_known, problems_);
      for (const auto& t : terminals.entries()) {
        if (t.empty) continue;
        const auto on = rig::read_switch(t.value, "terminal " + t.key, problems_);
        if (!on) continue;
        Expectation e;
        e.what = {Observable::Kind::kTerminal, t.key, "",
                  static_cast<std::size_t>(std::find(known.begin(), known.end(), t.key) - known.begin())};
        e.on = *on;
        e.shown = t.value.Scalar();
        out.push_back(std::move(e));
      }
      continue;
    }
    if (entry.key == "parameters") {
      const rig::YamlMap parameters(entry.value, "parameters", nullptr, problems_);
      for (const auto& p : parameters.entries()) {
        if (p.empty) continue;
        if (!trial_.has_parameter(drive_, p.key)) {
          problems_.add(
              p.at, "there is no parameter \"" + p.key + "\" in " + trial_.observer(drive_).drive().spec.name + ".");
          continue;
        }
        Expectation e;
        e.what = {Observable::Kind::kParameter, p.key, "", 0};
        e.shown = p.value.IsScalar() ? p.value.Scalar() : "";
        if (!p.value.IsScalar())
          problems_.add(p.value, p.key + " is " + rig::kind_of(p.value) + "; allowed: a number without unit.");
        else if (number(e, p.value, p.value.Scalar(), nullptr))
          out.push_back(std::move(e));
      }
      continue;
    }
    if (auto e = expectation(entry.key, entry.at, entry.value, tolerance)) out.push_back(std::move(*e));
  }
  if (!any)
    problems_.add(map.at(), where + " names nothing to look at; write what, as output_frequency: 40 Hz +- 1 Hz.");
  return out;
}

Condition ExpectationReader::condition(const YAML::Node& node, const std::string& where) const {
  if (node.IsMap()) return mapping(node, where, {});
  if (!node.IsScalar() || node.Scalar().empty()) {
    problems_.add(node,
                  where + " is " + rig::kind_of(node) +
                      "; allowed: a state (at_reference), a comparison (output_frequency > 30 Hz), or a mapping.");
    return {};
  }
  std::string_view text = trimmed(node.Scalar());
  const std::size_t operation = text.find_first_of("<>");
  if (operation != std::string_view::npos) {
    const auto what = signal(trimmed(text.substr(0, operation)), rig::position_of(node));
    if (!what) return {};
    Expectation e;
    e.what = *what;
    e.shown = trimmed(text.substr(operation));
    if (!number(e, node, e.shown, nullptr)) return {};
    return {e};
  }
  Expectation e;
  e.on = !text.starts_with("not ");
  e.shown = e.on ? "on" : "off";
  if (!e.on) text = trimmed(text.substr(4));
  const auto it = std::find(state_words().begin(), state_words().end(), text);
  if (it == state_words().end()) {
    const std::vector<std::string_view> known(state_words().begin(), state_words().end());
    problems_.add(node, where + " is \"" + std::string(node.Scalar()) +
                            "\", which is neither a comparison (output_frequency > 30 Hz) nor a state; " +
                            rig::allowed_words(text, known));
    return {};
  }
  e.what = {Observable::Kind::kState, std::string(text), "", static_cast<std::size_t>(it - state_words().begin())};
  return {e};
}

}  // namespace vinv::scenario
