#include "motor_model/inverter/a700/command_sources.hpp"

#include <optional>

#include "motor_model/inverter/a700/tables.hpp"
#include "motor_model/inverter/csv.hpp"
#include "sim/base/check.hpp"
#include "vinv_inverter_data.hpp"

namespace vinv::inverter::a700 {
namespace {

constexpr std::array<std::string_view, 6> kColumnNames{"pr338_0_pr339_0", "pr338_0_pr339_1", "pr338_0_pr339_2",
                                                       "pr338_1_pr339_0", "pr338_1_pr339_1", "pr338_1_pr339_2"};

std::optional<Source> parse_source(std::string_view text) {
  if (text == "none") return Source::kNone;
  if (text == "NET") return Source::kNetwork;
  if (text == "External") return Source::kExternal;
  if (text == "Combined") return Source::kCombined;
  if (text == "Compensation") return Source::kCompensation;
  return std::nullopt;
}

}  // namespace

Result<CommandSources, std::string> CommandSources::load(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  CommandSources out;
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    std::array<Source, kColumns> row{};
    for (std::size_t c = 0; c < kColumns; ++c) {
      const auto source = parse_source(in.text(kColumnNames[c]));
      if (!source) in.fail(kColumnNames[c], "is none of NET, External, Combined, Compensation, none");
      row[c] = source.value_or(Source::kNone);
    }
    const std::string& number = in.text("terminal_function_no");
    const std::string& name = in.text("signal");
    if (number.empty()) {
      const std::size_t at = name.empty() ? 0 : name == "2" ? 1 : name == "4" ? 2 : name == "1" ? 3 : 4;
      if (at == 4) {
        in.fail("signal", "'" + name + "' is not an analog terminal");
        break;
      }
      out.fixed_[at] = row;
      continue;
    }
    const auto signal = family_data().signals.input(static_cast<int>(in.integer("terminal_function_no")));
    if (!signal) {
      in.fail("terminal_function_no", "is not a function of an input terminal");
      break;
    }
    if (in.text("remark").substr(0, 7) == "Pr.79=7") {
      out.interlock_ = row;
      continue;
    }
    out.signals_[static_cast<std::size_t>(*signal)] = row;
    for (std::size_t c = 0; c < kColumns; ++c) {
      out.from_network_[c].set(*signal, row[c] == Source::kNetwork || row[c] == Source::kCombined);
      out.from_terminals_[c].set(*signal, row[c] == Source::kExternal || row[c] == Source::kCombined);
    }
  }
  if (in.error()) return Unexpected(*in.error());
  return out;
}

Source CommandSources::signal(InputSignal signal, int pr338, int pr339, bool interlock) const {
  const std::size_t c = column(pr338, pr339);
  if (interlock && signal == InputSignal::kMrs) return interlock_[c];
  return signals_[static_cast<std::size_t>(signal)][c];
}

InputSignals CommandSources::effective(InputSignals wired, InputSignals network, int pr338, int pr339,
                                       bool interlock) const {
  const std::size_t c = column(pr338, pr339);
  InputSignals out = wired.only(from_terminals_[c]) | network.only(from_network_[c]);
  if (interlock) {
    const Source mrs = interlock_[c];
    out.set(InputSignal::kMrs,
            (wired.has(InputSignal::kMrs) && (mrs == Source::kExternal || mrs == Source::kCombined)) ||
                (network.has(InputSignal::kMrs) && (mrs == Source::kNetwork || mrs == Source::kCombined)));
  }
  return out;
}

const CommandSources& command_sources() {
  static const CommandSources sources = [] {
    auto loaded = CommandSources::load(data::mitsubishi_a700_command_sources);
    VINV_CHECK(loaded.has_value());
    return *loaded;
  }();
  return sources;
}

}  // namespace vinv::inverter::a700
