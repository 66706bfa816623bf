#include "motor_model/inverter/a700/tables.hpp"

#include <algorithm>

#include "motor_model/inverter/csv.hpp"
#include "sim/base/check.hpp"
#include "vinv_inverter_data.hpp"

namespace vinv::inverter::a700 {

const FamilyData& family_data(bool large) {
  static const FamilyData data = load_family({data::mitsubishi_a700_parameters, data::mitsubishi_a700_alarms,
                                              data::mitsubishi_a700_terminals, data::mitsubishi_a700_models});
  static const FamilyData large_data =
      load_family({data::mitsubishi_a700_parameters, data::mitsubishi_a700_alarms, data::mitsubishi_a700_terminals,
                   data::mitsubishi_a700_models, data::mitsubishi_a700_large_models});
  return large ? large_data : data;
}

Result<std::vector<MonitorRow>, std::string> load_monitors(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  std::vector<MonitorRow> out;
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    MonitorRow row;
    const long code = in.integer("code");
    if (code < 1 || code > 255) in.fail("code", "must be 1 to 255");
    row.code = static_cast<unsigned>(code);
    if (std::any_of(out.begin(), out.end(), [&](const MonitorRow& r) { return r.code == row.code; })) {
      in.fail("code", "is there twice");
    }
    row.name = in.text("name");
    row.unit = in.text("unit");
    const std::string& increment = in.text("increment");
    if (increment == "0.01") {
      row.decimals = 2;
    } else if (increment == "0.1") {
      row.decimals = 1;
    } else if (increment != "1") {
      in.fail("increment", "must be 1, 0.1 or 0.01");
    }
    out.push_back(std::move(row));
  }
  if (in.error()) return Unexpected(*in.error());
  return out;
}

const std::vector<MonitorRow>& monitors() {
  static const std::vector<MonitorRow> rows = [] {
    auto loaded = load_monitors(data::mitsubishi_a700_monitors);
    VINV_CHECK(loaded.has_value());
    return std::move(loaded).value();
  }();
  return rows;
}

}  // namespace vinv::inverter::a700
