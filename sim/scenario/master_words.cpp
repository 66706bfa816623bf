#include "sim/scenario/master_words.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/scanner_words.hpp"
#include "sim/scenario/units.hpp"
#include "sim/scenario/word_values.hpp"

namespace vinv::scenario {
namespace {

using masters::Word;
using rig::Json;

SaidOrder order(Word word, double value = 0) {
  SaidOrder said;
  said.order.word = word;
  said.order.value = value;
  return said;
}
Said one(SaidOrder said) {
  Said out;
  out.orders.push_back(std::move(said));
  return out;
}

// "Pr.7", "Pr.902.1"; false if it is no parameter.
bool parse_parameter(std::string_view name, masters::Order& order) {
  if (!name.starts_with("Pr.")) return false;
  const char* const end = name.data() + name.size();
  auto [at, error] = std::from_chars(name.data() + 3, end, order.parameter);
  if (error != std::errc{}) return false;
  if (at == end) return true;
  if (*at != '.') return false;
  const auto sub = std::from_chars(at + 1, end, order.sub);
  return sub.ec == std::errc{} && sub.ptr == end;
}

Result<Said, std::string> read_parameters(const Json& value) {
  constexpr std::string_view kForm = "parameter takes Pr.7, [Pr.7, Pr.8] or {Pr.7: 2.5}";
  const Json names = value.is_string() ? Json::array({value}) : value;
  if (!names.is_array() && !names.is_object()) return Unexpected(std::string(kForm));
  Said out;
  for (const auto& [key, entry] : names.items()) {
    if (names.is_array() && !entry.is_string()) return Unexpected(std::string(kForm));
    SaidOrder said = order(names.is_array() ? Word::kReadParameter : Word::kWriteParameter);
    said.name = names.is_array() ? entry.get<std::string>() : key;
    if (!parse_parameter(said.name, said.order))
      return Unexpected("\"" + said.name + "\" is no parameter; allowed: names as Pr.7");
    if (names.is_object() && entry.is_number())
      said.order.value = entry.get<double>();
    else if (names.is_object() && !rig::parse_number(text_of(entry), said.order.value))
      return wrong(said.name, entry, "a number");
    out.orders.push_back(std::move(said));
  }
  return out;
}

// "40 Hz +- 0.1 Hz", "1190 rpm .. 1200 rpm", "5" of what has no unit.
Result<SaidRange, std::string> read_range(std::string_view name, const std::string& text, std::string_view unit) {
  SaidRange range;
  range.text = text;
  const auto number = [&](std::string_view piece) {
    while (!piece.empty() && piece.front() == ' ') piece.remove_prefix(1);
    while (!piece.empty() && piece.back() == ' ') piece.remove_suffix(1);
    return parse_value(piece, unit);
  };
  const auto refuse = [&](const std::string& why) { return Unexpected("monitor " + std::string(name) + ": " + why); };
  if (const auto dots = text.find(".."); dots != std::string::npos) {
    const auto low = number(std::string_view(text).substr(0, dots));
    const auto high = number(std::string_view(text).substr(dots + 2));
    if (!low || !high) return refuse(!low ? low.error() : high.error());
    range.low = *low;
    range.high = *high;
    return range;
  }
  const auto sign = text.find("+-");
  const auto middle = number(std::string_view(text).substr(0, sign));
  if (!middle) return refuse(middle.error());
  double distance = 0;
  if (sign != std::string::npos) {
    const auto more = number(std::string_view(text).substr(sign + 2));
    if (!more) return refuse(more.error());
    distance = *more;
  }
  range.low = *middle - distance;
  range.high = *middle + distance;
  return range;
}

Result<Said, std::string> read_monitors(const masters::BoardProfile& profile, const Json& value) {
  const Json names = value.is_string() ? Json{{value.get<std::string>(), nullptr}} : value;
  if (!names.is_object() || names.empty())
    return wrong("monitor", value,
                 "the name of a monitor, as output_frequency, or {output_frequency: 40 Hz +- 0.1 Hz}");
  Said out;
  for (const auto& [name, entry] : names.items()) {
    const masters::MonitorRow* row = profile.monitor(name);
    if (row == nullptr) {
      std::vector<std::string_view> known;
      for (const masters::MonitorRow& m : profile.monitors) known.push_back(m.name);
      std::string allowed = rig::allowed_words(name, known);
      if (allowed.ends_with('.')) allowed.pop_back();
      return Unexpected("there is no monitor \"" + name + "\"; " + allowed);
    }
    SaidOrder said = order(Word::kMonitor);
    said.name = said.order.monitor = name;
    if (!entry.is_null()) {
      auto range = read_range(name, text_of(entry), row->unit.empty() ? "-" : row->unit);
      if (!range) return Unexpected(range.error());
      said.range = *std::move(range);
    }
    out.orders.push_back(std::move(said));
  }
  return out;
}

}  // namespace

Result<Said, std::string> read_master_word(const masters::BoardProfile& profile, std::string_view word,
                                           const Json& value) {
  const std::string text = text_of(value);
  if (const auto& own = scanner_words(); std::find(own.begin(), own.end(), word) != own.end())
    return read_scanner_word(profile, word, value);
  if (word == "silence") {
    Said out;
    out.silence = true;
    if (value.is_boolean())
      out.silence = value.get<bool>();
    else if (!value.is_null() && !rig::parse_switch(text, *out.silence))
      return wrong(word, value, "on, off");
    return out;
  }
  if (word == "run") {
    if (text != "forward" && text != "reverse") return wrong(word, value, "forward, reverse");
    return one(order(text == "forward" ? Word::kRunForward : Word::kRunReverse));
  }
  if (word == "mode") {
    if (text != "NET" && text != "EXT") return wrong(word, value, "NET, EXT");
    return one(order(text == "NET" ? Word::kEnterNetwork : Word::kLeaveNetwork));
  }
  if (word == "reference") {
    const auto hz = rig::parse_quantity(text, rig::Dimension::kFrequency);
    const auto rpm = rig::parse_quantity(text, rig::Dimension::kSpeed);
    if (!hz && !rpm) return wrong(word, value, "a frequency or a speed, as 40 Hz or 1200 rpm");
    if ((hz ? *hz : *rpm) < 0) return wrong(word, value, "0 or more; run: reverse gives the direction");
    return one(hz ? order(Word::kReferenceHz, *hz) : order(Word::kReferenceRpm, *rpm));
  }
  if (word == "monitor") return read_monitors(profile, value);
  if (word == "parameter") return read_parameters(value);
  if (word == "stop") return one(order(Word::kStop));
  if (word == "quick_stop") return one(order(Word::kQuickStop));
  if (word == "reset") return one(order(Word::kReset));
  if (word == "fault_reset") return one(order(Word::kFaultReset));
  return one(order(Word::kClearAlarms));
}

const std::vector<std::string_view>& common_master_words() {
  static const std::vector<std::string_view> all{"mode",      "run",          "stop",        "quick_stop",
                                                 "reference", "reset",        "fault_reset", "parameter",
                                                 "monitor",   "clear_alarms", "silence"};
  return all;
}

}  // namespace vinv::scenario
