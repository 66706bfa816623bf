#include "motor_model/inverter/parameter_table.hpp"

#include <algorithm>
#include <charconv>

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {
namespace {

std::optional<std::int64_t> parse_integer(std::string_view text) {
  std::int64_t v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return v;
}

std::optional<int> decimals_of(std::string_view increment) {
  if (increment == "1") return 0;
  if (increment == "0.1") return 1;
  if (increment == "0.01") return 2;
  if (increment == "0.001") return 3;
  return std::nullopt;
}

// "0-3,14-17" in raw; empty optional: not such a list.
std::optional<std::vector<RawRange>> parse_allowed(std::string_view text, int decimals) {
  std::vector<RawRange> ranges;
  for (std::string_view part : split(text, ',')) {
    const std::size_t dash = part.find('-');
    const auto low = text_to_raw(part.substr(0, dash), decimals);
    const auto high = dash == std::string_view::npos ? low : text_to_raw(part.substr(dash + 1), decimals);
    if (!low || !high || *high < *low) return std::nullopt;
    ranges.push_back({static_cast<std::int32_t>(*low), static_cast<std::int32_t>(*high)});
  }
  return ranges;
}

// Default of one model by rules "rated_current" or "kw<=0.75:6 kw<=7.5:3" or "volt<=200:200 ..."; the first that fits.
// In place of a number a rule may give "rated" (current), "rated*0.85" or "capacity" (kW).
std::optional<std::string> model_default_text(std::string_view rule, const ModelRow& model) {
  for (std::string_view part : split(rule, ' ')) {
    const std::size_t le = part.find("<=");
    const std::size_t colon = part.find(':');
    if (le == std::string_view::npos || colon == std::string_view::npos || colon < le) return std::nullopt;
    const std::string_view what = part.substr(0, le);
    const auto limit = text_to_raw(part.substr(le + 2, colon - le - 2), 3);
    if (!limit || (what != "kw" && what != "volt")) return std::nullopt;
    const double have = what == "kw" ? model.motor_kw : model.voltage_class_v;
    if (have <= static_cast<double>(*limit) * 1e-3 + 1e-9) return std::string(part.substr(colon + 1));
  }
  return std::nullopt;
}

std::int32_t default_for(const ParameterRow& row, const ModelRow& model) {
  if (row.model_default.empty()) return row.raw_default;
  if (row.model_default == "rated_current") {
    double scale = 1;
    for (int i = 0; i < row.decimals; ++i) scale *= 10;
    return static_cast<std::int32_t>(model.rated_current_a_rms * scale + 0.5);
  }
  const auto text = model_default_text(row.model_default, model);
  const auto scaled = [&row](double value) {
    for (int i = 0; i < row.decimals; ++i) value *= 10;
    return static_cast<std::int32_t>(value + 0.5);
  };
  if (text == "rated") return scaled(model.rated_current_a_rms);
  if (text == "rated*0.85") return scaled(model.rated_current_a_rms * 0.85);
  if (text == "capacity") return scaled(model.motor_kw);
  const auto raw = text ? text_to_raw(*text, row.decimals) : std::nullopt;
  return raw ? static_cast<std::int32_t>(*raw) : row.raw_default;
}

}  // namespace

std::string raw_to_text(std::int64_t raw, int decimals) {
  const bool negative = raw < 0;
  std::string digits = std::to_string(negative ? -raw : raw);
  if (decimals > 0) {
    const auto d = static_cast<std::size_t>(decimals);
    if (digits.size() <= d) digits.insert(0, d + 1 - digits.size(), '0');
    digits.insert(digits.size() - d, ".");
  }
  return negative ? "-" + digits : digits;
}

std::optional<std::int64_t> text_to_raw(std::string_view text, int decimals) {
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  std::string_view fraction = dot == std::string_view::npos ? std::string_view{} : text.substr(dot + 1);
  if (whole.empty() || whole.size() > 9 || (dot != std::string_view::npos && fraction.empty())) return std::nullopt;
  if (!std::all_of(whole.begin(), whole.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  if (!std::all_of(fraction.begin(), fraction.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  while (fraction.size() > static_cast<std::size_t>(decimals) && fraction.back() == '0') fraction.remove_suffix(1);
  if (fraction.size() > static_cast<std::size_t>(decimals)) return std::nullopt;
  std::int64_t raw = *parse_integer(whole);
  for (int i = 0; i < decimals; ++i) {
    const auto at = static_cast<std::size_t>(i);
    raw = raw * 10 + (at < fraction.size() ? fraction[at] - '0' : 0);
  }
  return raw;
}

bool ParameterRow::accepts(std::int64_t raw) const {
  if (has_9999 && raw == kRaw9999) return true;
  if (has_8888 && raw == kRaw8888) return true;
  if (raw < raw_minimum || raw > raw_maximum) return false;
  if (allowed.empty()) return true;
  return std::any_of(allowed.begin(), allowed.end(), [raw](RawRange r) { return raw >= r.low && raw <= r.high; });
}

Result<ParameterTable, std::string> ParameterTable::load(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  ParameterTable out;
  for (auto& places : out.places_) places.fill(kNone);
  std::string manufacturer = "manufacturer";
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    ParameterRow row;
    const long number = in.integer("pr");
    const long sub = in.integer("sub");
    if (number < 0 || number >= static_cast<long>(kNumbers)) in.fail("pr", "must be 0 to 999");
    if (sub < 0 || sub > 2) in.fail("sub", "must be 0, 1 or 2");
    if (in.error()) break;
    row.id = {static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)};
    row.label = "Pr." + std::to_string(number) + (sub > 0 ? "." + std::to_string(sub) : "");
    row.name = in.text("name");
    row.unit = in.text("unit");
    row.source = in.text("source");
    row.confidence = in.text("confidence");
    row.notes = in.text("notes");
    row.effect = in.text("effect");
    row.acts = in.yes("acts");
    if (row.name.empty() || row.effect.empty() || row.source.empty())
      in.fail("name", "name, effect or source is empty");
    const std::string& kind = in.text("kind");
    if (kind == "command") {
      row.kind = ParameterKind::kCommand;
    } else if (kind == manufacturer) {
      row.kind = ParameterKind::kManufacturer;
    } else if (kind != "ordinary") {
      in.fail("kind", "'" + kind + "' is none of ordinary, command, manufacturer");
    }
    const std::string& clear = in.text("clear");
    if (clear == "all_only") {
      row.clear = ClearRule::kAllClearOnly;
    } else if (clear == "never") {
      row.clear = ClearRule::kNever;
    } else if (!clear.empty()) {
      in.fail("clear", "'" + clear + "' is none of all_only, never");
    }
    row.write_while_running = in.yes("write_while_running");
    row.write_while_running_free = in.yes("write_while_running_pr77_2");
    row.write_when_locked = in.yes("write_when_locked");
    row.panel_any_mode = in.yes("panel_any_mode");
    if (table->column("alias")) row.alias = in.text("alias");
    if (table->column("network_access")) {
      row.network_read_only = in.text("network_access") == "R";
      if (!row.network_read_only && in.text("network_access") != "RW") in.fail("network_access", "must be R or RW");
      row.communication = in.yes("communication");
      row.ram_only = in.text("storage") == "ram";
      if (!row.ram_only && !in.text("storage").empty()) in.fail("storage", "must be ram or empty");
    }
    row.read_only = in.text("access") == "RO";
    if (!row.read_only && in.text("access") != "RW") in.fail("access", "must be RO or RW");

    if (row.kind != ParameterKind::kManufacturer) {
      const auto decimals = decimals_of(in.text("increment"));
      if (!decimals) in.fail("increment", "must be 1, 0.1, 0.01 or 0.001");
      row.decimals = decimals.value_or(0);
      const auto minimum = text_to_raw(in.text("min"), row.decimals);
      const auto maximum = text_to_raw(in.text("max"), row.decimals);
      if (!minimum || !maximum || *minimum > *maximum || *maximum > INT32_MAX) {
        in.fail("min", "min and max must be multiples of the increment, min below max");
      } else {
        row.raw_minimum = static_cast<std::int32_t>(*minimum);
        row.raw_maximum = static_cast<std::int32_t>(*maximum);
      }
      row.special_text = in.text("special");
      for (std::string_view special : split(row.special_text, '|')) {
        if (special == "8888") {
          row.has_8888 = true;
        } else if (special == "9999") {
          row.has_9999 = true;
        } else {
          in.fail("special", "must be 8888, 9999 or both");
        }
      }
      // A stored raw value must mean one thing only.
      if ((row.has_9999 && row.raw_maximum >= kRaw8888) || (row.has_8888 && row.raw_maximum >= kRaw8888)) {
        in.fail("special", "the range reaches the raw words of 8888 and 9999");
      }
      row.allowed_text = in.text("allowed");
      auto allowed = parse_allowed(row.allowed_text, row.decimals);
      if (!allowed) {
        in.fail("allowed", "'" + row.allowed_text + "' is not a list of values and ranges");
      } else {
        row.allowed = std::move(*allowed);
      }
      const std::string& fallback = in.text("default");
      const auto raw_default = fallback == "9999" && row.has_9999   ? std::optional<std::int64_t>(kRaw9999)
                               : fallback == "8888" && row.has_8888 ? std::optional<std::int64_t>(kRaw8888)
                                                                    : text_to_raw(fallback, row.decimals);
      if (!raw_default || !row.accepts(*raw_default)) {
        in.fail("default", "'" + fallback + "' is not a value of this parameter");
      } else {
        row.raw_default = static_cast<std::int32_t>(*raw_default);
      }
      row.model_default = in.text("model_default");
      if (const std::string& fine = in.text("fine_increment"); !fine.empty()) {
        const std::size_t equals = fine.find('=');
        const std::size_t colon = fine.find(':');
        const auto of = parse_integer(std::string_view(fine).substr(0, equals));
        const bool shaped = equals != std::string::npos && colon != std::string::npos && equals < colon;
        const auto value =
            shaped ? parse_integer(std::string_view(fine).substr(equals + 1, colon - equals - 1)) : std::nullopt;
        const auto fine_decimals = shaped ? decimals_of(std::string_view(fine).substr(colon + 1)) : std::nullopt;
        if (!of || !value || !fine_decimals) {
          in.fail("fine_increment", "must look like 21=1:0.01");
        } else {
          row.fine = FineIncrement{static_cast<std::uint16_t>(*of), static_cast<std::int32_t>(*value), *fine_decimals};
        }
      }
    }
    if (sub <= 1 && out.has_number(row.id.number)) in.fail("pr", row.label + " is there twice");
    if (sub == 2 && (out.rows_.empty() || out.rows_.back().id != port::ParameterId{row.id.number, 1})) {
      in.fail("sub", "sub-index 2 must follow 1");
    }
    out.places_[row.id.number][row.id.sub] = static_cast<std::int16_t>(out.rows_.size());
    out.rows_.push_back(std::move(row));
  }
  if (in.error()) return Unexpected(*in.error());
  for (const ParameterRow& row : out.rows_) {
    if (row.fine && !out.index(port::ParameterId{row.fine->number, 0})) {
      return Unexpected(row.label + ": fine_increment names a parameter that does not exist");
    }
  }
  return out;
}

Result<void, std::string> ParameterTable::take_ranges(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    const long number = in.integer("pr");
    const auto at = index(port::ParameterId{static_cast<std::uint16_t>(number), 0});
    const auto decimals = decimals_of(in.text("increment"));
    if (!at || !rows_[*at].stored()) in.fail("pr", "is not a stored parameter of one word");
    if (!decimals) in.fail("increment", "must be 1, 0.1, 0.01 or 0.001");
    if (in.error()) break;
    ParameterRow& row = rows_[*at];
    const auto minimum = text_to_raw(in.text("min"), *decimals);
    const auto maximum = text_to_raw(in.text("max"), *decimals);
    if (!minimum || !maximum || *minimum > *maximum || *maximum >= kRaw8888) {
      in.fail("min", "min and max must be multiples of the increment, min below max");
      break;
    }
    const bool special = (row.has_9999 && row.raw_default == kRaw9999) || (row.has_8888 && row.raw_default == kRaw8888);
    if (!special) {
      for (int d = row.decimals; d < *decimals; ++d) row.raw_default *= 10;
      for (int d = row.decimals; d > *decimals; --d) row.raw_default /= 10;
    }
    row.decimals = *decimals;
    row.raw_minimum = static_cast<std::int32_t>(*minimum);
    row.raw_maximum = static_cast<std::int32_t>(*maximum);
    row.allowed_text = in.text("allowed");
    auto allowed = parse_allowed(row.allowed_text, row.decimals);
    if (!allowed) {
      in.fail("allowed", "'" + row.allowed_text + "' is not a list of values and ranges");
      break;
    }
    row.allowed = std::move(*allowed);
    if (!row.accepts(row.raw_default)) in.fail("min", "the default is outside");
  }
  if (in.error()) return Unexpected(*in.error());
  return {};
}

std::optional<std::size_t> ParameterTable::index(port::ParameterId id) const {
  if (id.number >= kNumbers || id.sub >= places_[id.number].size() || places_[id.number][id.sub] < 0)
    return std::nullopt;
  return static_cast<std::size_t>(places_[id.number][id.sub]);
}

std::optional<std::size_t> ParameterTable::index(std::string_view label) const {
  for (std::size_t i = 0; i < rows_.size() && label.substr(0, 1) == "C"; ++i) {
    if (rows_[i].alias == label) return i;
  }
  if (label.substr(0, 3) == "Pr.") label.remove_prefix(3);
  const std::size_t dot = label.find('.');
  const auto number = parse_integer(label.substr(0, dot));
  const auto sub =
      dot == std::string_view::npos ? std::optional<std::int64_t>(0) : parse_integer(label.substr(dot + 1));
  if (!number || !sub || *number < 0 || *number >= static_cast<std::int64_t>(kNumbers) || *sub < 0 || *sub > 2) {
    return std::nullopt;
  }
  return index(port::ParameterId{static_cast<std::uint16_t>(*number), static_cast<std::uint8_t>(*sub)});
}

bool ParameterTable::has_number(std::uint32_t number) const {
  return number < kNumbers && (places_[number][0] >= 0 || places_[number][1] >= 0);
}

std::vector<std::int32_t> ParameterTable::defaults(const ModelRow& model) const {
  std::vector<std::int32_t> raw;
  raw.reserve(rows_.size());
  for (const ParameterRow& row : rows_) raw.push_back(default_for(row, model));
  return raw;
}

}  // namespace vinv::inverter
