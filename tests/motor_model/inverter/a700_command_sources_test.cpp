// Every row of the command source table of FR-A7NE manual 4.4 (data/a700_command_sources_reference.csv).
#include <gtest/gtest.h>

#include "motor_model/inverter/a700/command_sources.hpp"
#include "motor_model/inverter/a700/tables.hpp"
#include "motor_model/inverter/csv.hpp"
#include "tests/motor_model/inverter/reference_rows.hpp"

namespace vinv::inverter::a700 {
namespace {

Source source_of(const std::string& word) {
  if (word == "NET") return Source::kNetwork;
  if (word == "External") return Source::kExternal;
  if (word == "Combined") return Source::kCombined;
  if (word == "Compensation") return Source::kCompensation;
  EXPECT_EQ(word, "none");
  return Source::kNone;
}

TEST(CommandSources, EveryRowActsAsPrinted) {
  const CsvTable table = reference("a700_command_sources_reference.csv");
  CsvReader in(table);
  ASSERT_EQ(in.size(), 50u);
  int signals = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    for (int pr338 : {0, 1}) {
      for (int pr339 : {0, 1, 2}) {
        const std::string column = "pr338_" + std::to_string(pr338) + "_pr339_" + std::to_string(pr339);
        const Source expected = source_of(in.text(column));
        const CommandSources& sources = command_sources();
        SCOPED_TRACE(in.text("signal") + " " + column);
        if (in.text("terminal_function_no").empty()) {
          const std::string& name = in.text("signal");
          EXPECT_EQ(name.empty()  ? sources.network_frequency(pr338, pr339)
                    : name == "2" ? sources.terminal_2(pr338, pr339)
                    : name == "4" ? sources.terminal_4(pr338, pr339)
                                  : sources.terminal_1(pr338, pr339),
                    expected);
          continue;
        }
        const auto signal = family_data().signals.input(static_cast<int>(in.integer("terminal_function_no")));
        ASSERT_TRUE(signal.has_value());
        const bool interlock = in.text("remark").substr(0, 7) == "Pr.79=7";
        EXPECT_EQ(sources.signal(*signal, pr338, pr339, interlock), expected);
        // What comes through of the terminal alone and of the network alone.
        InputSignals only;
        only.set(*signal, true);
        EXPECT_EQ(sources.effective(only, {}, pr338, pr339, interlock).has(*signal),
                  expected == Source::kExternal || expected == Source::kCombined);
        EXPECT_EQ(sources.effective({}, only, pr338, pr339, interlock).has(*signal),
                  expected == Source::kNetwork || expected == Source::kCombined);
        ++signals;
      }
    }
  }
  EXPECT_EQ(signals, 46 * 6);
  EXPECT_FALSE(in.error().has_value());
}

TEST(CommandSources, LoaderRefusesUnknownWordsAndFunctions) {
  const std::string header =
      "terminal_function_no,signal,pr338_0_pr339_0,pr338_0_pr339_1,pr338_0_pr339_2,pr338_1_pr339_0,pr338_1_pr339_1,"
      "pr338_1_pr339_2,remark\n";
  EXPECT_TRUE(CommandSources::load(header + "0,RL,NET,NET,NET,NET,NET,NET,\n").has_value());
  EXPECT_FALSE(CommandSources::load(header + "0,RL,NET,NET,PU,NET,NET,NET,\n").has_value());
  EXPECT_FALSE(CommandSources::load(header + "21,XX,NET,NET,NET,NET,NET,NET,\n").has_value());
  EXPECT_FALSE(CommandSources::load(header + ",3,NET,NET,NET,NET,NET,NET,\n").has_value());
}

}  // namespace
}  // namespace vinv::inverter::a700
