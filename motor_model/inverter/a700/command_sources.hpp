// Who may give which signal in network operation: FR-A7NE manual 4.4, by Pr.338 and Pr.339
// (motor_model/families/mitsubishi_a700/command_sources.csv).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "motor_model/inverter/signal_map.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter::a700 {

enum class Source : std::uint8_t {
  kNone,          // neither
  kNetwork,       // the network's bit only
  kExternal,      // the terminal only
  kCombined,      // either
  kCompensation,  // the terminal, only while Pr.28 = 1
};

class CommandSources {
 public:
  static Result<CommandSources, std::string> load(std::string_view csv);

  // pr338 0-1, pr339 0-2. With interlock MRS is the PU operation interlock (Pr.79 = 7 without X12).
  Source signal(InputSignal signal, int pr338, int pr339, bool interlock = false) const;
  Source network_frequency(int pr338, int pr339) const { return fixed_[0][column(pr338, pr339)]; }
  Source terminal_2(int pr338, int pr339) const { return fixed_[1][column(pr338, pr339)]; }
  Source terminal_4(int pr338, int pr339) const { return fixed_[2][column(pr338, pr339)]; }
  Source terminal_1(int pr338, int pr339) const { return fixed_[3][column(pr338, pr339)]; }

  // The signals that count, of those that the terminals and the network give.
  InputSignals effective(InputSignals wired, InputSignals network, int pr338, int pr339, bool interlock = false) const;

 private:
  static constexpr std::size_t kColumns = 6;
  static constexpr std::size_t kSignals = 64;
  static std::size_t column(int pr338, int pr339) { return static_cast<std::size_t>(pr338 * 3 + pr339); }

  std::array<std::array<Source, kColumns>, 4> fixed_{};
  std::array<std::array<Source, kColumns>, kSignals> signals_{};
  std::array<Source, kColumns> interlock_{};
  // The signals that each kind of source lets through, for effective().
  std::array<InputSignals, kColumns> from_network_{};
  std::array<InputSignals, kColumns> from_terminals_{};
};

const CommandSources& command_sources();

}  // namespace vinv::inverter::a700
