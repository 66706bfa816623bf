// Terminal functions (families/*/terminals.csv): which signal a terminal carries, by the number that its assignment
// parameter holds. Signals are sets of bits, so that two terminals may carry one function.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter {

enum class InputSignal : std::uint8_t {
  kRl,
  kRm,
  kRh,
  kRt,
  kAu,
  kJog,
  kStop,
  kMrs,
  kOh,
  kRex,
  kX16,
  kX18,
  kStf,
  kStr,
  kRes,
  kCs,
  kX9,
  kX10,
  kX11,
  kX12,
  kX13,
  kX14,
  kBri,
  kX17,
  kX19,
  kX20,
  kX22,
  kLx,
  kMc,
  kTl,
  kX28,
  kX37,
  kX42,
  kX43,
  kX44,
  kSq,
  kPtc,
  kX64,
  kX65,
  kX66,
  kX67,
  kNp,
  kClr,
  kX70,
  kX71,
};
enum class OutputSignal : std::uint8_t {
  kRun,
  kSu,
  kOl,
  kFu,
  kRy,
  kY12,
  kY13,
  kFdn,
  kFup,
  kPidForward,
  kLf,
  kAbc,
  kIpf,
  kFu2,
  kFu3,
  kRbp,
  kThp,
  kPu,
  kMc1,
  kMc2,
  kMc3,
  kBof,
  kFan,
  kFin,
  kOra,
  kOrm,
  kY30,
  kY31,
  kY32,
  kRy2,
  kLs,
  kTu,
  kY36,
  kY39,
  kFb,
  kFb2,
  kFb3,
  kRun2,
  kRun3,
  kY46,
  kPid,
  kY64,
  kSleep,
  kRdy,
  kY85,
  kY90,
  kY91,
  kY92,
  kY93,
  kAlm2,
  kY95,
  kRem,
  kEr,
};

template <class Signal>
struct SignalSet {
  std::uint64_t bits = 0;
  constexpr bool has(Signal s) const { return (bits >> static_cast<unsigned>(s) & 1u) != 0; }
  constexpr void set(Signal s, bool on) {
    const std::uint64_t mask = std::uint64_t{1} << static_cast<unsigned>(s);
    bits = on ? bits | mask : bits & ~mask;
  }
  constexpr SignalSet only(SignalSet mask) const { return {bits & mask.bits}; }
  friend constexpr SignalSet operator|(SignalSet a, SignalSet b) { return {a.bits | b.bits}; }
  friend constexpr bool operator==(SignalSet, SignalSet) = default;
  VINV_ARCHIVE(SignalSet, bits);
};
using InputSignals = SignalSet<InputSignal>;
using OutputSignals = SignalSet<OutputSignal>;

// A function of an output terminal; families with negative logic have a second number for it.
struct OutputFunction {
  OutputSignal signal{};
  bool inverted = false;
};

struct TerminalFunction {
  int number = 0;
  std::string signal;
  std::string meaning;
  std::string source;
  std::string confidence;
};

class SignalMap {
 public:
  static Result<SignalMap, std::string> load(std::string_view csv);
  std::optional<InputSignal> input(int number) const;
  std::optional<OutputFunction> output(int number) const;
  const std::vector<TerminalFunction>& inputs() const { return inputs_; }
  const std::vector<TerminalFunction>& outputs() const { return outputs_; }

 private:
  static constexpr int kNumbers = 200;
  std::array<std::int8_t, kNumbers> input_{};
  std::array<std::int8_t, kNumbers> output_{};
  std::array<bool, kNumbers> inverted_{};
  std::vector<TerminalFunction> inputs_;
  std::vector<TerminalFunction> outputs_;
};

}  // namespace vinv::inverter
