#include "motor_model/inverter/signal_map.hpp"

#include <utility>

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {
namespace {

constexpr std::array<std::pair<std::string_view, InputSignal>, 45> kInputs{{
    {"RL", InputSignal::kRl},   {"RM", InputSignal::kRm},   {"RH", InputSignal::kRh},     {"RT", InputSignal::kRt},
    {"AU", InputSignal::kAu},   {"JOG", InputSignal::kJog}, {"STOP", InputSignal::kStop}, {"MRS", InputSignal::kMrs},
    {"OH", InputSignal::kOh},   {"REX", InputSignal::kRex}, {"X16", InputSignal::kX16},   {"X18", InputSignal::kX18},
    {"STF", InputSignal::kStf}, {"STR", InputSignal::kStr}, {"RES", InputSignal::kRes},   {"CS", InputSignal::kCs},
    {"X9", InputSignal::kX9},   {"X10", InputSignal::kX10}, {"X11", InputSignal::kX11},   {"X12", InputSignal::kX12},
    {"X13", InputSignal::kX13}, {"X14", InputSignal::kX14}, {"BRI", InputSignal::kBri},   {"X17", InputSignal::kX17},
    {"X19", InputSignal::kX19}, {"X20", InputSignal::kX20}, {"X22", InputSignal::kX22},   {"LX", InputSignal::kLx},
    {"MC", InputSignal::kMc},   {"TL", InputSignal::kTl},   {"X28", InputSignal::kX28},   {"X37", InputSignal::kX37},
    {"X42", InputSignal::kX42}, {"X43", InputSignal::kX43}, {"X44", InputSignal::kX44},   {"SQ", InputSignal::kSq},
    {"PTC", InputSignal::kPtc}, {"X64", InputSignal::kX64}, {"X65", InputSignal::kX65},   {"X66", InputSignal::kX66},
    {"X67", InputSignal::kX67}, {"NP", InputSignal::kNp},   {"CLR", InputSignal::kClr},   {"X70", InputSignal::kX70},
    {"X71", InputSignal::kX71},
}};
constexpr std::array<std::pair<std::string_view, OutputSignal>, 54> kOutputs{{
    {"RUN", OutputSignal::kRun},       {"SU", OutputSignal::kSu},       {"OL", OutputSignal::kOl},
    {"FU", OutputSignal::kFu},         {"RY", OutputSignal::kRy},       {"Y12", OutputSignal::kY12},
    {"Y13", OutputSignal::kY13},       {"FDN", OutputSignal::kFdn},     {"FUP", OutputSignal::kFup},
    {"RL", OutputSignal::kPidForward}, {"LF", OutputSignal::kLf},       {"ABC", OutputSignal::kAbc},
    {"ALM", OutputSignal::kAbc},       {"IPF", OutputSignal::kIpf},     {"FU2", OutputSignal::kFu2},
    {"FU3", OutputSignal::kFu3},       {"RBP", OutputSignal::kRbp},     {"THP", OutputSignal::kThp},
    {"PU", OutputSignal::kPu},         {"MC1", OutputSignal::kMc1},     {"MC2", OutputSignal::kMc2},
    {"MC3", OutputSignal::kMc3},       {"BOF", OutputSignal::kBof},     {"FAN", OutputSignal::kFan},
    {"FIN", OutputSignal::kFin},       {"ORA", OutputSignal::kOra},     {"ORM", OutputSignal::kOrm},
    {"Y30", OutputSignal::kY30},       {"Y31", OutputSignal::kY31},     {"Y32", OutputSignal::kY32},
    {"RY2", OutputSignal::kRy2},       {"LS", OutputSignal::kLs},       {"TU", OutputSignal::kTu},
    {"Y36", OutputSignal::kY36},       {"Y39", OutputSignal::kY39},     {"FB", OutputSignal::kFb},
    {"FB2", OutputSignal::kFb2},       {"FB3", OutputSignal::kFb3},     {"RUN2", OutputSignal::kRun2},
    {"RUN3", OutputSignal::kRun3},     {"Y46", OutputSignal::kY46},     {"PID", OutputSignal::kPid},
    {"Y64", OutputSignal::kY64},       {"SLEEP", OutputSignal::kSleep}, {"RDY", OutputSignal::kRdy},
    {"Y85", OutputSignal::kY85},       {"Y90", OutputSignal::kY90},     {"Y91", OutputSignal::kY91},
    {"Y92", OutputSignal::kY92},       {"Y93", OutputSignal::kY93},     {"ALM2", OutputSignal::kAlm2},
    {"Y95", OutputSignal::kY95},       {"REM", OutputSignal::kRem},     {"ER", OutputSignal::kEr},
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
  const bool negative_column = table->column("number_negative_logic").has_value();
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    const long number = in.integer("number");
    const std::string& name = in.text("signal");
    const bool is_input = in.text("direction") == "input";
    const int signal = is_input ? find_signal(kInputs, name) : find_signal(kOutputs, name);
    if (number < 0 || number >= kNumbers) in.fail("number", "must be 0 to 199");
    if (!is_input && in.text("direction") != "output") in.fail("direction", "must be input or output");
    if (signal < 0) in.fail("signal", "'" + name + "' is not a known signal");
    if (in.error()) break;
    std::int8_t& slot = (is_input ? out.input_ : out.output_)[static_cast<std::size_t>(number)];
    if (slot >= 0) in.fail("number", "is there twice");
    slot = static_cast<std::int8_t>(signal);
    if (negative_column && !is_input && !in.text("number_negative_logic").empty()) {
      const long negative = in.integer("number_negative_logic");
      if (negative < 0 || negative >= kNumbers || out.output_[static_cast<std::size_t>(negative)] >= 0) {
        in.fail("number_negative_logic", "must be 0 to 199 and no other function's number");
        break;
      }
      out.output_[static_cast<std::size_t>(negative)] = static_cast<std::int8_t>(signal);
      out.inverted_[static_cast<std::size_t>(negative)] = true;
    }
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

std::optional<OutputFunction> SignalMap::output(int number) const {
  if (number < 0 || number >= kNumbers || output_[static_cast<std::size_t>(number)] < 0) return std::nullopt;
  const auto at = static_cast<std::size_t>(number);
  return OutputFunction{static_cast<OutputSignal>(output_[at]), inverted_[at]};
}

}  // namespace vinv::inverter
