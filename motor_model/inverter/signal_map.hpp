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
};

template <class Signal>
struct SignalSet {
  std::uint32_t bits = 0;
  constexpr bool has(Signal s) const { return (bits >> static_cast<unsigned>(s) & 1u) != 0; }
  constexpr void set(Signal s, bool on) {
    const std::uint32_t mask = 1u << static_cast<unsigned>(s);
    bits = on ? bits | mask : bits & ~mask;
  }
  constexpr SignalSet only(SignalSet mask) const { return {bits & mask.bits}; }
  friend constexpr SignalSet operator|(SignalSet a, SignalSet b) { return {a.bits | b.bits}; }
  friend constexpr bool operator==(SignalSet, SignalSet) = default;
  VINV_ARCHIVE(SignalSet, bits);
};
using InputSignals = SignalSet<InputSignal>;
using OutputSignals = SignalSet<OutputSignal>;

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
  std::optional<OutputSignal> output(int number) const;
  const std::vector<TerminalFunction>& inputs() const { return inputs_; }
  const std::vector<TerminalFunction>& outputs() const { return outputs_; }

 private:
  static constexpr int kNumbers = 128;
  std::array<std::int8_t, kNumbers> input_{};
  std::array<std::int8_t, kNumbers> output_{};
  std::vector<TerminalFunction> inputs_;
  std::vector<TerminalFunction> outputs_;
};

}  // namespace vinv::inverter
