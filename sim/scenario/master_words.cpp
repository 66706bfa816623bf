#include "sim/scenario/master_words.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

using masters::Word;
using rig::Json;
using Refusal = Unexpected<std::string>;

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }
std::string shown(const Json& value) { return value.is_null() ? "nothing" : value.dump(); }

Refusal wrong(std::string_view what, const Json& value, std::string_view allowed) {
  return Unexpected(std::string(what) + " is " + shown(value) + "; allowed: " + std::string(allowed));
}

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

// --- EtherNet/IP ---

std::optional<std::uint32_t> parse_number(std::string_view text, std::uint32_t most) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  }
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size() || value > most) return std::nullopt;
  return value;
}

std::optional<Bytes> parse_hex(const std::string& text) {
  std::string digits;
  for (const char c : text)
    if (c != ' ') digits += c;
  Bytes out;
  if (digits.size() % 2 != 0) return std::nullopt;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(digits.data() + i, digits.data() + i + 2, byte, 16);
    if (error != std::errc{} || end != digits.data() + i + 2) return std::nullopt;
    out.push_back(byte);
  }
  return out;
}

constexpr std::string_view kHex = "bytes in hexadecimal, as 61 00 B0 04";

// The keys of a word's mapping, each at most once taken; remembers the first mistake.
class Keys {
 public:
  Keys(std::string_view word, const Json& value, std::vector<std::string_view> allowed) : word_(word), value_(value) {
    if (value_.is_null()) return;
    if (!value_.is_object()) {
      error_ = wrong(word_, value_, "a mapping with " + rig::join(allowed)).error();
      return;
    }
    for (const auto& [key, entry] : value_.items()) {
      if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
      std::string list = rig::allowed_words(key, allowed);
      if (list.ends_with('.')) list.pop_back();
      error_ = "unknown key \"" + key + "\" in " + std::string(word_) + "; " + list;
    }
  }
  bool has(std::string_view key) const { return value_.is_object() && value_.contains(std::string(key)); }
  std::string text(std::string_view key) const { return has(key) ? text_of(value_.at(std::string(key))) : ""; }
  void refuse(std::string_view key, std::string_view allowed) {
    if (error_.empty())
      error_ = wrong(std::string(word_) + "." + std::string(key), value_.at(std::string(key)), allowed).error();
  }
  void number(std::string_view key, std::uint32_t most, auto& into) {
    if (!has(key)) return;
    const auto parsed = parse_number(text(key), most);
    if (!parsed) return refuse(key, "a number up to " + std::to_string(most));
    into = static_cast<std::remove_reference_t<decltype(into)>>(*parsed);
  }
  void bytes(std::string_view key, Bytes& into) {
    if (!has(key)) return;
    const auto parsed = parse_hex(text(key));
    if (!parsed) return refuse(key, kHex);
    into = *parsed;
  }
  void switched(std::string_view key, bool& into) {
    if (has(key) && !rig::parse_switch(text(key), into)) refuse(key, "on, off");
  }
  void time(std::string_view key, Duration least, Duration& into) {
    if (!has(key)) return;
    const auto parsed = rig::parse_quantity(text(key), rig::Dimension::kTime);
    if (!parsed || *parsed < to_seconds(least) || *parsed > 3600)
      return refuse(key, "a time from " + show_duration(least) + " to 3600 s");
    into = seconds_to_duration(*parsed);
  }
  const std::string& error() const { return error_; }

 private:
  std::string_view word_;
  const Json& value_;
  std::string error_;
};

// status, extended, answer, mask.
std::optional<masters::CipExpectation> read_expectation(Keys& keys) {
  if (!keys.has("status") && !keys.has("extended") && !keys.has("answer")) return std::nullopt;
  masters::CipExpectation expected;
  if (keys.has("extended")) {
    constexpr std::uint8_t kConnectionFailure = 0x01;
    expected.general = kConnectionFailure;
    expected.extended.emplace();
    std::string rest = keys.text("extended");
    while (!rest.empty()) {
      const auto space = rest.find(' ');
      const auto word = parse_number(rest.substr(0, space), 0xffff);
      if (!word) {
        keys.refuse("extended", "words, as 0x0106 or \"0x0127 0x000A\"");
        break;
      }
      expected.extended->push_back(static_cast<std::uint16_t>(*word));
      rest.erase(0, space == std::string::npos ? rest.size() : space + 1);
    }
  }
  keys.number("status", 0xff, expected.general);
  if (keys.has("answer")) {
    Bytes data;
    keys.bytes("answer", data);
    expected.data = std::move(data);
  }
  keys.bytes("mask", expected.mask);
  return expected;
}

// "0x2A/1/114", "0x01/1".
std::optional<Bytes> parse_path(const std::string& text, bool needs_attribute) {
  std::uint16_t numbers[3] = {0, 0, 0};
  std::size_t count = 0;
  std::size_t at = 0;
  while (at <= text.size() && count < 3) {
    const std::size_t slash = std::min(text.find('/', at), text.size());
    const auto number = parse_number(std::string_view(text).substr(at, slash - at), 0xffff);
    if (!number) return std::nullopt;
    numbers[count++] = static_cast<std::uint16_t>(*number);
    at = slash + 1;
  }
  if (at <= text.size() || count < (needs_attribute ? 3u : 2u)) return std::nullopt;
  return masters::object_path(numbers[0], numbers[1], numbers[2]);
}

Result<Said, std::string> read_request(const Json& value) {
  Keys keys("request", value,
            {"get", "set", "service", "path", "data", "connected", "status", "extended", "answer", "mask"});
  masters::EipTask task;
  task.kind = masters::EipTask::Kind::kRequest;
  const int forms = int{keys.has("get")} + int{keys.has("set")} + int{keys.has("service")};
  if (keys.error().empty() && forms != 1)
    return Unexpected(std::string("request has one of get, set and service, as {get: 0x2A/1/114}"));
  for (const auto& [key, service] : {std::pair<std::string_view, std::uint8_t>{"get", masters::kGetAttributeSingle},
                                     {"set", masters::kSetAttributeSingle}}) {
    if (!keys.has(key)) continue;
    task.ask.service = service;
    if (const auto path = parse_path(keys.text(key), true))
      task.ask.path = *path;
    else
      keys.refuse(key, "class, instance and attribute, as 0x2A/1/114");
  }
  keys.number("service", 0x7f, task.ask.service);
  if (keys.has("service")) {
    const auto path = parse_path(keys.text("path"), false);
    if (path)
      task.ask.path = *path;
    else if (keys.error().empty())
      return Unexpected(std::string("request.path is ") + (keys.has("path") ? shown(value.at("path")) : "nothing") +
                        "; allowed: class and instance, as 0x01/1, and perhaps an attribute");
  }
  keys.bytes("data", task.ask.data);
  keys.switched("connected", task.ask.connected);
  task.expected = read_expectation(keys);
  if (!keys.error().empty()) return Unexpected(keys.error());
  Said out;
  out.task = std::move(task);
  return out;
}

Result<Said, std::string> read_open(const masters::BoardProfile& profile, const Json& value) {
  Keys keys("open", value,
            {"role", "points", "sizes", "rpi", "multiplier", "multicast", "trigger", "header", "class", "key", "large",
             "status", "extended"});
  masters::EipTask task;
  task.kind = masters::EipTask::Kind::kOpen;
  masters::IoWish& w = task.wish;
  const masters::IoLayout& io = profile.io;
  w.output_point = io.output_point;
  w.input_point = io.input_point;
  w.output_size = io.output_size;
  w.input_size = io.input_size;
  if (keys.has("role")) {
    const std::string role = keys.text("role");
    if (role != "owner" && role != "input_only" && role != "listen_only")
      keys.refuse("role", "owner, input_only, listen_only");
    if (role != "owner") {
      w.output_point = role == "input_only" ? io.input_only_point : io.listen_only_point;
      w.output_size = 0;
      w.run_idle_header = false;
    }
  }
  const auto pair = [&](std::string_view key, std::uint32_t most, auto& first, auto& second) {
    if (!keys.has(key)) return;
    const std::string text = keys.text(key);
    const std::size_t slash = std::min(text.find('/'), text.size());
    const auto a = parse_number(text.substr(0, slash), most);
    const auto b = parse_number(std::string_view(text).substr(std::min(slash + 1, text.size())), most);
    if (!a || !b) return keys.refuse(key, "two numbers, as 21/71");
    first = static_cast<std::remove_reference_t<decltype(first)>>(*a);
    second = static_cast<std::remove_reference_t<decltype(second)>>(*b);
  };
  pair("points", 0xffff, w.output_point, w.input_point);
  pair("sizes", 400, w.output_size, w.input_size);
  keys.time("rpi", std::chrono::microseconds(100), w.output_rpi);
  w.input_rpi = w.output_rpi;
  if (keys.has("multiplier")) {
    std::uint32_t factor = 0;
    keys.number("multiplier", 512, factor);
    std::uint8_t raw = 0;
    while (raw < 7 && (4u << raw) < factor) ++raw;
    if ((4u << raw) != factor) keys.refuse("multiplier", "4, 8, 16, 32, 64, 128, 256, 512");
    w.timeout_multiplier = raw;
  }
  keys.switched("multicast", w.multicast);
  if (keys.has("trigger")) {
    const std::string text = keys.text("trigger");
    if (text != "cyclic" && text != "change_of_state" && text != "application")
      keys.refuse("trigger", "cyclic, change_of_state, application");
    w.trigger = text == "cyclic" ? 0 : text == "change_of_state" ? 1 : 2;
  }
  keys.switched("header", w.run_idle_header);
  keys.number("class", 1, w.transport_class);
  keys.bytes("key", w.key);
  if (w.key.size() % 2 != 0) keys.refuse("key", "an even number of bytes");
  keys.switched("large", w.large);
  task.expected = read_expectation(keys);
  if (!keys.error().empty()) return Unexpected(keys.error());
  Said out;
  out.task = std::move(task);
  return out;
}

Result<Said, std::string> read_scanner_word(const masters::BoardProfile& profile, std::string_view word,
                                            const Json& value) {
  using Kind = masters::EipTask::Kind;
  if (word == "open") return read_open(profile, value);
  if (word == "request") return read_request(value);
  Said out;
  masters::EipTask& task = out.task.emplace();
  if (word == "close") {
    Keys keys(word, value, {"status", "extended"});
    task.kind = Kind::kClose;
    task.expected = read_expectation(keys);
    if (!keys.error().empty()) return Unexpected(keys.error());
  } else if (word == "idle" || word == "producing") {
    task.kind = word == "idle" ? Kind::kIdle : Kind::kProducing;
    if (!value.is_null() && !rig::parse_switch(text_of(value), task.on)) return wrong(word, value, "on, off");
  } else if (word == "drop") {
    task.kind = Kind::kDrop;
    if (!value.is_null()) return wrong(word, value, "nothing");
  } else if (word == "output") {
    task.kind = Kind::kOutput;
    const auto bytes = parse_hex(text_of(value));
    if (!bytes || bytes->empty()) return wrong(word, value, kHex);
    task.bytes = *bytes;
  } else {
    task.kind = Kind::kInput;
    if (value.is_string()) {
      const auto bytes = parse_hex(text_of(value));
      if (!bytes || bytes->empty()) return wrong(word, value, kHex);
      task.bytes = *bytes;
      return out;
    }
    Keys keys(word, value, {"bytes", "mask", "within"});
    keys.bytes("bytes", task.bytes);
    keys.bytes("mask", task.mask);
    keys.time("within", Duration{}, task.within);
    if (!keys.error().empty()) return Unexpected(keys.error());
    if (task.bytes.empty()) return wrong(word, value, "{bytes: 94 00 B0 04, mask: FF 00 FF FF, within: 100 ms}");
    if (!task.mask.empty() && task.mask.size() != task.bytes.size())
      return wrong("input.mask", value.at("mask"), "as many bytes as \"bytes\" has");
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

const std::vector<std::string_view>& scanner_words() {
  static const std::vector<std::string_view> all{"open", "close",  "idle",  "producing",
                                                 "drop", "output", "input", "request"};
  return all;
}

}  // namespace vinv::scenario
