// Every word of the control socket in a scenario, with the effect that it has.
#include <algorithm>
#include <set>

#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

using testing::failures;
using testing::kHead;
using testing::kRunning;
using testing::read;
using testing::run_steps;

// Steps after which a check sees the effect of the word.
const std::vector<std::pair<const char*, const char*>> kStories{
    {"run", "  - run: reverse\n  - reached: { reverse: on, within: 2 s }\n"},
    {"stop", "  - stop\n  - reached: { stopped: on, within: 1 s }\n"},
    {"reference", "  - reference: 450 rpm\n  - reached: { output_frequency: 15 Hz, within: 1 s }\n"},
    {"reset",
     "  - stop\n  - fault: E.OHT\n  - trip: { code: E.OHT, within: 1 s }\n  - reset\n"
     "  - reached: { alarm: none, within: 2 s }\n"},
    {"terminal", "  - terminal: { STF: off }\n  - reached: { stopped: on, within: 1 s }\n"},
    {"analog", "  - analog: { terminal_2: 1 V }\n  - reached: { output_frequency: 10 Hz +- 0.1 Hz, within: 1 s }\n"},
    {"key", "  - stop\n  - when: stopped\n  - key: PU/EXT\n  - reached: { mode: PU, within: 100 ms }\n"},
    {"mode", "  - stop\n  - when: stopped\n  - mode: PU\n  - reached: { mode: PU, within: 100 ms }\n"},
    {"frequency",
     "  - stop\n  - when: stopped\n  - mode: PU\n  - frequency: 33 Hz\n"
     "  - reached: { set_frequency: 33 Hz, within: 100 ms }\n"},
    {"parameter",
     "  - stop\n  - when: stopped\n  - mode: PU\n  - parameter: { Pr.7: 2.0, Pr.8: 3.5 }\n"
     "  - check: { parameters: { Pr.7: 2.0, Pr.8: 3.5 } }\n"},
    {"load", "  - load: { torque: 3 Nm }\n  - reached: { load_torque: above 2.9 Nm, within: 100 ms }\n"},
    {"shaft",
     "  - stop\n  - when: stopped\n  - shaft: locked\n  - run: forward\n  - never: { speed: above 1 rpm }\n"
     "    during: 300 ms\n"},
    {"motor",
     "  - motor: mains\n  - reached: { motor_current: above 1 A, within: 100 ms }\n"
     "  - check: { output_current: 0 A +- 0 A, motor_voltage: 400 V +- 0.1 V }\n"},
    {"mains", "  - mains: { voltage: 340 V }\n  - reached: { dc_link: below 490 V, within: 1 s }\n"},
    {"phase_loss", "  - phase_loss: L2\n  - check: { powered: on }\n"},
    {"ambient", "  - ambient: 50 C\n  - reached: { heat_sink: above 26 C, within: 15 s }\n"},
    {"power", "  - power: off\n  - reached: { powered: off, within: 5 s }\n"},
    {"fault", "  - fault: { option: on }\n  - trip: { code: E.OPT, within: 100 ms }\n"},
    {"wire", "  - wire: { drop: 10 %, id: 185 }\n  - wire: bus_off\n  - wire: none\n  - check: running\n"},
    {"link", "  - { link: down, refused: yes }\n  - check: running\n"},  // the board has none; see below
    {"switch", "  - switch: { SW1: 2 }\n  - check: running\n"},
};

TEST(Words, EachActsAsAtTheControlSocket) {
  std::set<std::string_view> told;
  for (const auto& [word, story] : kStories) {
    const RunResult r = run_steps(story);
    EXPECT_EQ(r.verdict, Verdict::kPassed) << word << "\n" << failures(r);
    EXPECT_FALSE(r.checks.empty()) << word;
    told.insert(word);
  }
  // Only a master can be told these.
  for (const std::string_view word : {"clear_alarms", "close", "drop", "fault_reset", "idle", "input", "monitor",
                                      "open", "output", "producing", "quick_stop", "request", "silence"}) {
    EXPECT_THROW(read(std::string(kHead) + kRunning + "  - " + std::string(word) + ": on\n"), ScenarioFileError)
        << word;
    told.insert(word);
  }
  EXPECT_EQ(told, std::set<std::string_view>(action_words().begin(), action_words().end()));
}

TEST(Words, ThePulledCableOfABoardOnEthernetIsALineErrorInNetworkOperation) {
  const RunResult r = testing::run(
      "# A.\nplant: { drives: [ { inverter: { family: fr-a700, model: FR-A740-1.5K }, parameters: { Pr.340: 10 } } ] "
      "}\n"
      "limit: 20 s\n"
      "steps:\n"
      "  - when: ready\n"
      "  - { after: 200 ms, check: { mode: NET, led: green flashing } }\n"
      "  - link: down\n"
      "  - trip: { code: E.OP3, within: 100 ms }\n"
      "  - link: up\n"
      "  - reset\n"
      "  - reached: { alarm: none, within: 3 s }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Words, ALoadCanRampAndFollowATable) {
  const RunResult ramp = run_steps(
      "  - load: { torque: 2.5 Nm, over: 1 s }\n"
      "  - after: 500 ms\n"
      "    check: { load_torque: 1.5 Nm +- 0.05 Nm }\n"
      "  - after: 600 ms\n"
      "    check: { load_torque: 2.5 Nm +- 0.05 Nm }\n"
      "  - load: { torque: 0.5 Nm, over: 400 ms }\n"
      "  - after: 200 ms\n"
      "    check: { load_torque: 1.5 Nm +- 0.05 Nm }\n"
      "  - after: 1 s\n"
      "    check: { load_torque: 0.5 Nm +- 0.05 Nm }\n");
  EXPECT_EQ(ramp.verdict, Verdict::kPassed) << failures(ramp);
  const RunResult table = run_steps(
      "  - load: { table: [ { at: 0 s, torque: 0 Nm }, { at: 1 s, torque: 2 Nm }, { at: 2 s, torque: 1 Nm } ] }\n"
      "  - after: 1 s\n"
      "    check: { load_torque: 2.5 Nm +- 0.05 Nm }\n"
      "  - after: 500 ms\n"
      "    check: { load_torque: 2 Nm +- 0.05 Nm }\n"
      "  - after: 2 s\n"
      "    check: { load_torque: 1.5 Nm +- 0.05 Nm }\n");
  EXPECT_EQ(table.verdict, Verdict::kPassed) << failures(table);
}

// They are no parameters, and at the time of reading the drive is in the wrong mode for them.
TEST(Words, ParametersAreClearedInPuOperation) {
  const RunResult r = run_steps(
      "  - stop\n  - when: stopped\n  - parameter: { Pr.CL: 1 }\n    refused: yes\n  - mode: PU\n"
      "  - parameter: { Pr.340: 1 }\n  - parameter: { Pr.CL: 1 }\n"
      "  - check: { parameters: { Pr.7: 5, Pr.340: 1 } }\n  - parameter: { ALLC: 1 }\n"
      "  - check: { parameters: { Pr.340: 0 } }\n  - parameter: { Er.CL: 1 }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
  EXPECT_EQ(r.checks.size(), 4u);
  try {
    read(std::string(kHead) + kRunning + "  - parameter: { Pr.CL: 2 }\n  - parameter: { ALC: 1 }\n");
    FAIL();
  } catch (const ScenarioFileError& e) {
    const std::string told = e.what();
    EXPECT_NE(told.find("Pr.CL takes 1"), std::string::npos) << told;
    EXPECT_NE(told.find("there is no parameter ALC"), std::string::npos) << told;
  }
}

TEST(Words, AReferenceBeyondTheAnalogInputIsRefused) {
  const RunResult r = run_steps("  - { reference: 80 Hz, refused: yes }\n  - check: running\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Words, AnEepromThatCannotBeWrittenIsItsAlarm) {
  const RunResult r = run_steps(
      "  - stop\n  - when: stopped\n  - mode: PU\n  - fault: { eeprom_write: on }\n  - parameter: { Pr.7: 3.0 }\n"
      "  - trip: { code: E.PE, within: 1 s, display: E.PE }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

}  // namespace
}  // namespace vinv::scenario
