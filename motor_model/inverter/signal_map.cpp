#include "motor_model/inverter/signal_map.hpp"

#include <utility>

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {
namespace {

constexpr std::array<std::pair<std::string_view, InputSignal>, 12> kInputs{{
    {"RL", InputSignal::kRl},
    {"RM", InputSignal::kRm},
    {"RH", InputSignal::kRh},
    {"RT", InputSignal::kRt},
    {"AU", InputSignal::kAu},
    {"JOG", InputSignal::kJog},
    {"STOP", InputSignal::kStop},
    {"MRS", InputSignal::kMrs},
    {"OH", InputSignal::kOh},
    {"REX", InputSignal::kRex},
    {"X16", InputSignal::kX16},
    {"X18", InputSignal::kX18},
}};
constexpr std::array<std::pair<std::string_view, OutputSignal>, 12> kOutputs{{
    {"RUN", OutputSignal::kRun},
    {"SU", OutputSignal::kSu},
    {"OL", OutputSignal::kOl},
    {"FU", OutputSignal::kFu},
    {"RY", OutputSignal::kRy},
    {"Y12", OutputSignal::kY12},
    {"Y13", OutputSignal::kY13},
    {"FDN", OutputSignal::kFdn},
    {"FUP", OutputSignal::kFup},
    {"RL", OutputSignal::kPidForward},
    {"LF", OutputSignal::kLf},
    {"ABC", OutputSignal::kAbc},
}};

template <class Table>
int find_signal(const Table& table, std::string_view name) {
  for (const auto& [known, signal] : table) {
    if (known == name) return static_cast<int>(signal);
  }
  return -1;
}

}  // namespace

Result<SignalMap, std::string> SignalMap::load(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  SignalMap out;
  out.input_.fill(-1);
  out.output_.fill(-1);
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    const long number = in.integer("number");
    const std::string& name = in.text("signal");
    const bool is_input = in.text("direction") == "input";
    const int signal = is_input ? find_signal(kInputs, name) : find_signal(kOutputs, name);
    if (number < 0 || number >= kNumbers) in.fail("number", "must be 0 to 127");
    if (!is_input && in.text("direction") != "output") in.fail("direction", "must be input or output");
    if (signal < 0) in.fail("signal", "'" + name + "' is not a known signal");
    if (in.error()) break;
    std::int8_t& slot = (is_input ? out.input_ : out.output_)[static_cast<std::size_t>(number)];
    if (slot >= 0) in.fail("number", "is there twice");
    slot = static_cast<std::int8_t>(signal);
    (is_input ? out.inputs_ : out.outputs_)
        .push_back({static_cast<int>(number), name, in.text("meaning"), in.text("source"), in.text("confidence")});
  }
  if (in.error()) return Unexpected(*in.error());
  return out;
}

std::optional<InputSignal> SignalMap::input(int number) const {
  if (number < 0 || number >= kNumbers || input_[static_cast<std::size_t>(number)] < 0) return std::nullopt;
  return static_cast<InputSignal>(input_[static_cast<std::size_t>(number)]);
}

std::optional<OutputSignal> SignalMap::output(int number) const {
  if (number < 0 || number >= kNumbers || output_[static_cast<std::size_t>(number)] < 0) return std::nullopt;
  return static_cast<OutputSignal>(output_[static_cast<std::size_t>(number)]);
}

}  // namespace vinv::inverter
