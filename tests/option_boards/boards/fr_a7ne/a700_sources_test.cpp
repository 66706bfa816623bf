// Every row of FR-A7NE manual 4.4 with a real FR-A700: a signal is given by its terminal, or by its bit of class 0x2A,
// attribute 114, and the motor shows which of the two counts. The rows are those of
// tests/motor_model/inverter/data/a700_command_sources_reference.csv.
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "motor_model/inverter/csv.hpp"
#include "tests/option_boards/boards/fr_a7ne/a700_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using test::A700OnEthernetIp;
using test::Settings;
using namespace std::chrono_literals;

inverter::CsvTable reference() {
  std::ifstream in(std::string(VINV_SOURCE_DIR) +
                   "/tests/motor_model/inverter/data/a700_command_sources_reference.csv");
  std::stringstream text;
  text << in.rdbuf();
  return *inverter::parse_csv(text.str());
}

// Sensorless vector control.
const Settings kVector{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.800", 10}};

Settings operator+(Settings a, const Settings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// What makes a signal visible in a run at 25 Hz that begins and ends; by its function number.
const std::map<int, Settings>& visible() {
  static const std::map<int, Settings> kSettings{
      {0, {{"Pr.6", 10}}},
      {1, {{"Pr.5", 30}}},
      {2, {{"Pr.4", 40}}},
      {3, {{"Pr.44", 3}}},
      {4, {}},
      {5, {}},
      {8, {{"Pr.232", 35}}},
      {9, {{"Pr.110", 4}}},
      {12, {{"Pr.79", 7}}},
      {13, {{"Pr.11", 8888}}},
      {14, {{"Pr.128", 20}, {"Pr.133", 80}}},
      {15, kVector + Settings{{"Pr.292", 7}, {"Pr.279", 10}, {"Pr.280", 0.1}, {"Pr.281", 0.1}}},
      {16, {}},
      {17, {{"Pr.14", 5}}},
      {18, kVector},
      {20, {{"Pr.29", 4}, {"Pr.382", 50}}},
      {24, {}},
      {25, {}},
      {26, kVector + Settings{{"Pr.800", 12}, {"Pr.804", 1}, {"Pr.806", 1010}, {"Pr.9", 3.25}}},
      {27, kVector + Settings{{"Pr.815", 20}}},
      {37, {{"Pr.592", 2}, {"Pr.593", 20}, {"Pr.594", 0}, {"Pr.595", 0}, {"Pr.596", 1}, {"Pr.597", 1}}},
      {44, kVector},
      {60, {}},
      {61, {}},
      {62, {{"Pr.540", 0x800}}},
      {64, {{"Pr.128", 20}, {"Pr.133", 80}, {"Pr.185", 14}}},
      {65, {}},
      {66, {}},
      {67, {}},
  };
  return kSettings;
}
// Nothing of these is modelled; CS, OH and PTC take a power failure, a relay and a thermistor to be seen, and X19 acts
// in external operation only.
constexpr int kUnseen[] = {6, 7, 10, 11, 19, 22, 23, 28, 42, 43, 50, 63, 68, 69, 70, 71};

enum class By { kNobody, kTerminal, kNetwork };

struct Case {
  int function = 0, pr338 = 0, pr339 = 0;
  bool interlock = false;  // MRS with Pr.79 = 7
};

constexpr unsigned kStfBit = 1 << 1, kStrBit = 1 << 2, kJogBit = 1 << 6, kRtBit = 1 << 7, kMrsBit = 1 << 10;

// What is seen of the run, tick by tick.
std::string run(const Case& c, By by) {
  const bool start_signal = c.function == 60 || c.function == 61;
  const std::string terminal = c.function == 60 ? "STF" : c.function == 61 ? "STR" : c.interlock ? "MRS" : "RT";
  const unsigned bit = c.function == 60 ? kStfBit : c.function == 61 ? kStrBit : c.interlock ? kMrsBit : kRtBit;
  Settings settings{{"Pr.340", 1}, {"Pr.338", c.pr338}, {"Pr.339", c.pr339}};
  if (!start_signal && !c.interlock) settings.emplace_back("Pr.183", c.function);
  if (c.interlock) settings.emplace_back("Pr.79", 7);
  A700OnEthernetIp b(settings + visible().at(c.function));
  const auto until = [&, begin = b.now](Duration at) {
    EXPECT_LT(b.now, begin + at);
    b.run(begin + at - b.now);
  };
  const auto command = [&](unsigned bits) {
    char text[40];
    std::snprintf(text, sizeof text, "10 03 20 2A 24 01 30 72 %02X %02X", bits & 0xFF, bits >> 8);
    b.ask(text);
  };
  const bool both = c.function == 64;  // X14, which X64 needs
  const unsigned held = (by == By::kNetwork ? bit : 0) | (both ? kJogBit : 0);
  EXPECT_TRUE(b.inverter->set_analog("2", 2));
  EXPECT_TRUE(b.inverter->set_analog("4", 8));
  EXPECT_TRUE(b.inverter->set_terminal(terminal, by == By::kTerminal));
  EXPECT_TRUE(b.inverter->set_terminal("JOG", both));
  until(100ms);
  b.mode("14");
  until(300ms);
  b.ask("10 03 20 2A 24 01 30 70 C4 09");
  until(500ms);
  command(held);
  until(700ms);
  // A start that is not the signal in question.
  const bool starts = !start_signal;
  if (c.pr338 == 1 && starts) {
    EXPECT_TRUE(b.inverter->set_terminal("STF", true));
  }
  command(held | (c.pr338 == 0 && starts ? kStfBit : 0));
  std::ostringstream seen;
  const auto watch = [&](Duration time) {
    for (const Instant end = b.now + time; b.now < end; b.run(10ms)) {
      seen << b.hz() << ' ' << b.signal("output_current") << ' '
           << static_cast<int>(b.inverter->port().operation_mode()) << b.alarm() << b.inverter->port().ready() << '\n';
    }
  };
  until(800ms);
  watch(700ms);
  if (c.pr338 == 1 && starts) {
    EXPECT_TRUE(b.inverter->set_terminal("STF", false));
  }
  command(held);
  until(1600ms);
  watch(700ms);
  return seen.str();
}

TEST(FrA7neSources, EveryRowCountsByItsTerminalOrItsBit) {
  const inverter::CsvTable table = reference();
  inverter::CsvReader in(table);
  unsigned rows = 0, unseen = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    if (in.text("terminal_function_no").empty()) continue;
    Case c;
    c.function = static_cast<int>(in.integer("terminal_function_no"));
    c.interlock = in.text("remark").substr(0, 7) == "Pr.79=7";
    if (visible().count(c.function) == 0) {
      EXPECT_NE(std::find(std::begin(kUnseen), std::end(kUnseen), c.function), std::end(kUnseen)) << c.function;
      ++unseen;
      continue;
    }
    ++rows;
    for (c.pr338 = 0; c.pr338 <= 1; ++c.pr338) {
      for (c.pr339 = 0; c.pr339 <= 2; ++c.pr339) {
        const std::string column = "pr338_" + std::to_string(c.pr338) + "_pr339_" + std::to_string(c.pr339);
        const std::string& word = in.text(column);
        SCOPED_TRACE(in.text("signal") + " " + column + " " + word);
        // Without X67 both sources are external: nothing to see where they are so anyway.
        const bool nothing_to_see = c.function == 67 && c.pr338 == 1 && c.pr339 == 1;
        const std::string without = run(c, By::kNobody);
        EXPECT_EQ(run(c, By::kTerminal) != without, (word == "External" || word == "Combined") && !nothing_to_see);
        EXPECT_EQ(run(c, By::kNetwork) != without, word == "NET" || word == "Combined");
      }
    }
  }
  EXPECT_EQ(rows, 30u);
  EXPECT_EQ(unseen, std::size(kUnseen));
}

// The fixed functions: the frequency of the network and the three analog inputs.
TEST(FrA7neSources, FrequencyComesFromWhereTheTableSays) {
  const inverter::CsvTable table = reference();
  inverter::CsvReader in(table);
  const auto hz = [](const Settings& settings, double network, double v2, double ma4, double v1) {
    A700OnEthernetIp b(settings);
    EXPECT_TRUE(b.inverter->set_analog("2", v2));
    EXPECT_TRUE(b.inverter->set_analog("4", ma4));
    EXPECT_TRUE(b.inverter->set_analog("1", v1));
    EXPECT_TRUE(b.inverter->set_terminal("STF", true));
    EXPECT_TRUE(b.inverter->set_terminal("AU", ma4 > 0));
    char text[40];
    const unsigned raw = static_cast<unsigned>(std::lround(network * 100));
    std::snprintf(text, sizeof text, "10 03 20 2A 24 01 30 70 %02X %02X", raw & 0xFF, raw >> 8);
    b.ask(text);
    b.run(100ms);
    b.ask(settings[1].second == 0 ? "10 03 20 2A 24 01 30 72 02 00" : "10 03 20 2A 24 01 30 72 00 00");
    b.run(1500ms);
    return b.hz();
  };
  for (std::size_t i = 0; i < 4; ++i) {
    in.select(i);
    const std::string& name = in.text("signal");
    for (int pr338 : {0, 1}) {
      for (int pr339 : {0, 1, 2}) {
        const std::string column = "pr338_" + std::to_string(pr338) + "_pr339_" + std::to_string(pr339);
        const std::string& word = in.text(column);
        SCOPED_TRACE(name + " " + column + " " + word);
        Settings s{{"Pr.340", 1}, {"Pr.338", pr338}, {"Pr.339", pr339}, {"Pr.28", 0}};
        if (name.empty()) {
          EXPECT_NEAR(hz(s, 20, 0, 0, 0), word == "NET" ? 20 : 0, 0.1);
        } else if (name == "2") {
          EXPECT_NEAR(hz(s, 0, 2.5, 0, 0), word == "External" ? 30 : 0, 0.1);
        } else if (name == "4") {
          EXPECT_NEAR(hz(s, 0, 0, 12, 0), word == "External" ? 30 : 0, 0.1);
        } else {
          // On top of a speed of the network or of terminal 2; with Pr.28 only where the network sets it.
          EXPECT_EQ(word, "Compensation");
          s[3].second = 1;
          EXPECT_NEAR(hz(s, 20, 2.5, 0, 1) - hz(s, 20, 2.5, 0, 0), 6, 0.1);
          s[3].second = 0;
          if (pr339 != 1) {
            EXPECT_NEAR(hz(s, 20, 2.5, 0, 1) - hz(s, 20, 2.5, 0, 0), 0, 0.1);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
