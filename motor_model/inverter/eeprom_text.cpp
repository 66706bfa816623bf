#include "motor_model/inverter/eeprom_text.hpp"

#include <charconv>
#include <optional>

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {
namespace {

constexpr std::string_view kTitle = "vinverter eeprom, version ";
constexpr std::int64_t kOperatingSecondsMax = 3'600'000'000;
constexpr std::int64_t kCounterMax = 1'000'000'000'000'000;

std::string hex(std::uint32_t value, int digits) {
  std::string text(static_cast<std::size_t>(digits), '0');
  for (std::size_t i = text.size(); i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 0xF];
  return text;
}

std::string group_text(const UserGroup& group) {
  std::string text;
  for (std::size_t i = 0; i < group.count; ++i) text += (i > 0 ? " " : "") + std::to_string(group.numbers[i]);
  return text.empty() ? "none" : text;
}

std::optional<std::int64_t> whole(std::string_view text) {
  std::int64_t v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return v;
}

// Lines one by one, with the place for messages.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  // The next line without its end; empty optional at the end or for a line without end.
  std::optional<std::string_view> next() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++number_;
    return line;
  }
  std::string_view rest() const { return rest_; }
  int number() const { return number_; }

 private:
  std::string_view rest_;
  int number_ = 0;
};

struct Failure {
  int line;
  std::string why;
};

class Parser {
 public:
  Parser(std::string_view text, const EepromIdentity& identity, const ParameterStore& store, const AlarmTable& alarms)
      : text_(text), lines_(text), identity_(identity), store_(store), alarms_(alarms) {}

  Result<EepromContents, std::string> run() {
    // A failed line names itself; a file whose lines all read well is still checked against its sum.
    if (!header() || !parameters() || !record() || !checksum()) {
      return Unexpected("line " + std::to_string(failure_.line) + ": " + failure_.why);
    }
    return contents_;
  }

 private:
  bool fail(std::string why) { return fail_at(lines_.number(), std::move(why)); }
  bool fail_at(int line, std::string why) {
    failure_ = {line, std::move(why)};
    return false;
  }

  // Value of the line "name = value"; empty optional after fail().
  std::optional<std::string_view> field(std::string_view name) {
    const auto line = lines_.next();
    if (!line) {
      fail_at(lines_.number() + 1, "the file ends before " + std::string(name));
      return std::nullopt;
    }
    if (line->substr(0, name.size()) != name || line->substr(name.size(), 3) != " = ") {
      fail("expected '" + std::string(name) + " = ...'");
      return std::nullopt;
    }
    std::string_view value = line->substr(name.size() + 3);
    return value.substr(0, value.find("  # "));
  }

  bool integer(std::string_view name, std::int64_t low, std::int64_t high, std::int64_t& out) {
    const auto value = field(name);
    if (!value) return false;
    const auto v = whole(*value);
    if (!v || *v < low || *v > high) {
      return fail(std::string(name) + " takes " + std::to_string(low) + " to " + std::to_string(high));
    }
    out = *v;
    return true;
  }

  bool header() {
    const auto title = lines_.next();
    const std::string expected = std::string(kTitle) + std::to_string(kEepromVersion);
    if (!title || *title != expected) return fail_at(1, "not '" + expected + "'");
    const auto family = field("family");
    if (!family) return false;
    if (*family != identity_.family) {
      return fail("this is the EEPROM of family " + std::string(*family) + ", not " + std::string(identity_.family));
    }
    const auto model = field("model");
    if (!model) return false;
    if (*model != identity_.model) {
      return fail("this is the EEPROM of a " + std::string(*model) + ", not " + std::string(identity_.model));
    }
    return true;
  }

  bool parameters() {
    const auto& rows = store_.table().rows();
    contents_.parameters.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) contents_.parameters[i] = store_.factory_raw(i);
    struct Pending {
      std::size_t row;
      std::string_view value;
      int line;
    };
    std::vector<Pending> fine;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!rows[i].stored()) continue;
      const auto value = field(rows[i].label);
      if (!value) return false;
      if (rows[i].fine) {
        // Its increment depends on a parameter that may follow.
        fine.push_back({i, *value, lines_.number()});
      } else if (!parameter(i, *value, lines_.number())) {
        return false;
      }
    }
    for (const Pending& p : fine) {
      if (!parameter(p.row, p.value, p.line)) return false;
    }
    return true;
  }

  bool parameter(std::size_t row, std::string_view text, int line) {
    const ParameterRow& r = store_.table().rows()[row];
    std::optional<std::int64_t> raw;
    if (r.has_9999 && text == "9999") {
      raw = kRaw9999;
    } else if (r.has_8888 && text == "8888") {
      raw = kRaw8888;
    } else {
      raw = text_to_raw(text, store_.eeprom_decimals(row, contents_.parameters));
      if (raw && *raw > r.raw_maximum) raw.reset();
    }
    if (!raw || !r.accepts(*raw)) {
      return fail_at(line, r.label + " = " + std::string(text) + ": takes " + store_.allowed_text(row));
    }
    contents_.parameters[row] = static_cast<std::int32_t>(*raw);
    return true;
  }

  bool record() {
    EepromRecord& r = contents_.record;
    std::int64_t panel = 0;
    std::int64_t remote = 0;
    std::int64_t retries = 0;
    if (!integer("panel_frequency_0.01Hz", 0, 40000, panel) || !integer("remote_frequency_0.01Hz", 0, 40000, remote) ||
        !integer("operating_seconds", 0, kOperatingSecondsMax, r.operating_seconds) ||
        !integer("retry_count", 0, 65535, retries)) {
      return false;
    }
    r.panel_frequency = static_cast<std::int32_t>(panel);
    r.remote_frequency = static_cast<std::int32_t>(remote);
    r.retry_count = static_cast<std::int32_t>(retries);
    return group("user_group_1", r.groups[0]) && group("user_group_2", r.groups[1]) && counters() &&
           history();
  }

  bool counters() {
    for (std::size_t i = 0; i < identity_.counters.size(); ++i) {
      if (!integer(identity_.counters[i], 0, kCounterMax, contents_.record.counters[i])) return false;
    }
    return true;
  }

  bool group(std::string_view name, UserGroup& group) {
    const auto value = field(name);
    if (!value) return false;
    if (*value == "none") return true;
    for (std::string_view part : split(*value, ' ')) {
      const auto number = whole(part);
      if (!number || *number < 0 || !store_.table().has_number(static_cast<std::uint32_t>(*number)) ||
          !group.add(static_cast<std::uint16_t>(*number))) {
        return fail(std::string(name) + " takes up to " + std::to_string(UserGroup::kCapacity) + " parameter numbers");
      }
    }
    return true;
  }

  bool history() {
    for (std::size_t i = 0; i < contents_.record.alarms.size(); ++i) {
      const std::string name = "alarm_" + std::to_string(i + 1);
      const auto value = field(name);
      if (!value) return false;
      if (*value == "none") continue;
      const auto row = alarms_.by_name(*value);
      if (!row) return fail(name + ": '" + std::string(*value) + "' is not an alarm of this family");
      contents_.record.alarms[i] = alarms_.rows()[*row].code;
    }
    return true;
  }

  bool checksum() {
    const std::size_t covered = text_.size() - lines_.rest().size();
    const auto value = field("checksum");
    if (!value) return false;
    const std::string expected = hex(crc32(text_.substr(0, covered)), 8);
    if (*value != expected) {
      return fail("checksum " + std::string(*value) + " does not match the contents, which give " + expected);
    }
    if (!lines_.rest().empty()) return fail_at(lines_.number() + 1, "something follows the checksum");
    return true;
  }

  std::string_view text_;
  Lines lines_;
  const EepromIdentity& identity_;
  const ParameterStore& store_;
  const AlarmTable& alarms_;
  EepromContents contents_;
  Failure failure_{0, ""};
};

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

std::string emit_eeprom(const EepromIdentity& identity, const ParameterStore& store, const AlarmTable& alarms,
                        const EepromRecord& record) {
  std::string out = std::string(kTitle) + std::to_string(kEepromVersion) + "\n";
  out += "family = " + std::string(identity.family) + "\nmodel = " + std::string(identity.model) + "\n";
  const auto& rows = store.table().rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& r = rows[i];
    if (!r.stored()) continue;
    const std::int32_t raw = store.eeprom_raw(i);
    const bool special = (r.has_9999 && raw == kRaw9999) || (r.has_8888 && raw == kRaw8888);
    out += r.label + " = ";
    out += special ? (raw == kRaw9999 ? "9999" : "8888") : raw_to_text(raw, store.eeprom_decimals(i, store.eeprom()));
    out += "  # " + r.name + (r.unit == "-" ? "" : ", " + r.unit) + "\n";
  }
  out += "panel_frequency_0.01Hz = " + std::to_string(record.panel_frequency) + "\n";
  out += "remote_frequency_0.01Hz = " + std::to_string(record.remote_frequency) + "\n";
  out += "operating_seconds = " + std::to_string(record.operating_seconds) + "\n";
  out += "retry_count = " + std::to_string(record.retry_count) + "\n";
  out += "user_group_1 = " + group_text(record.groups[0]) + "\n";
  out += "user_group_2 = " + group_text(record.groups[1]) + "\n";
  for (std::size_t i = 0; i < identity.counters.size(); ++i) {
    out += std::string(identity.counters[i]) + " = " + std::to_string(record.counters[i]) + "\n";
  }
  for (std::size_t i = 0; i < record.alarms.size(); ++i) {
    const auto row = alarms.by_code(record.alarms[i]);
    out += "alarm_" + std::to_string(i + 1) + " = " + (row ? alarms.rows()[*row].name : "none") + "\n";
  }
  out += "checksum = " + hex(crc32(out), 8) + "\n";
  return out;
}

Result<EepromContents, std::string> parse_eeprom(std::string_view text, const EepromIdentity& identity,
                                                 const ParameterStore& store, const AlarmTable& alarms) {
  return Parser(text, identity, store, alarms).run();
}

}  // namespace vinv::inverter
