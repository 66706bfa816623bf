#include "sim/scenario/scanner_words.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "sim/masters/eip_message.hpp"
#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"
#include "sim/scenario/word_values.hpp"

namespace vinv::scenario {
namespace {

using rig::Json;

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

}  // namespace

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

const std::vector<std::string_view>& scanner_words() {
  static const std::vector<std::string_view> all{"open", "close",  "idle",  "producing",
                                                 "drop", "output", "input", "request"};
  return all;
}

}  // namespace vinv::scenario
