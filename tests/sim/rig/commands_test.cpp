#include "sim/rig/commands.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/sim/rig/fakes.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;

class CommandsTest : public testing::Test {
 protected:
  CommandsTest()
      : catalogue_(test::fake_catalogue(journal_)),
        plant_(
            parse_plant_file("drives:\n  - name: a\n    mains: { voltage_V: 400 }\n  - name: bare\n    board: none\n",
                             "p.yaml", catalogue_),
            scheduler_,
            PlantOptions{.catalogue = catalogue_,
                         .stored_eeprom = {},
                         .damaged_eeprom = {},
                         .stored_flash = {},
                         .damaged_flash = {},
                         .clock = {}}) {
    plant_.start();
    run_ms(5);
    journal_.clear();
  }
  void run_ms(int ms) { scheduler_.run_until(scheduler_.now() + milliseconds(ms)); }
  test::FakeInverter& inverter() { return dynamic_cast<test::FakeInverter&>(*plant_.drives()[0]->inverter); }
  CommandResult words(const std::string& command, const std::vector<std::string>& w, const std::string& drive = "a") {
    return execute_words(plant_, command, drive, w);
  }
  Json good(const std::string& command, const Json& value) {
    const auto r = execute(plant_, command, "a", value);
    EXPECT_TRUE(r) << command << ": " << r.error().message;
    return r ? *r : Json();
  }
  // "code message"
  std::string bad(const std::string& command, const Json& value, const std::string& drive = "a") {
    const auto r = execute(plant_, command, drive, value);
    return r ? "accepted" : std::to_string(static_cast<int>(r.error().code)) + " " + r.error().message;
  }

  test::Journal journal_;
  kernel::Scheduler scheduler_;
  Catalogue catalogue_;
  Plant plant_;
};

TEST_F(CommandsTest, TerminalsAndAnalogInputsAreSetWithTheirUnits) {
  good("terminal", {{"STF", true}, {"RH", "on"}});
  good("analog", {{"terminal_2", "5 V"}, {"4", "12 mA"}});
  EXPECT_EQ(inverter().analog, (std::map<std::string, double>{{"2", 5}, {"4", 12}}));
  for (const auto& [name, on] : inverter().terminals()) EXPECT_EQ(on, name == "STF" || name == "RH") << name;
}

TEST_F(CommandsTest, WrongUnitsWordsAndTypesAreToldWithWhatIsAllowed) {
  EXPECT_EQ(
      bad("analog", {{"terminal_2", "5 Hz"}}),
      "-32602 analog terminal 2: \"5 Hz\" has the wrong unit; write a number and one of these units: V, mV, kV, for "
      "example \"5 V\".");
  EXPECT_EQ(bad("analog", {{"terminal_4", "5 V"}}),
            "-32602 analog terminal 4: \"5 V\" has the wrong unit; write a number and one of these units: mA, A, for "
            "example \"5 mA\".");
  EXPECT_EQ(bad("analog", {{"terminal_9", "5 V"}}),
            "-32602 there is no analog terminal \"terminal_9\"; allowed: 2, 4.");
  EXPECT_EQ(bad("terminal", {{"STF", 1}}), "-32602 terminal STF is 1; allowed: on, off.");
  EXPECT_EQ(bad("terminal", {{"STG", "on"}}), "-32000 there is no terminal STG. Did you mean \"STF\"?");
  EXPECT_EQ(bad("terminal", "on"), "-32602 terminal is \"on\"; it takes {STF: on}.");
  EXPECT_EQ(bad("power", "of"), "-32602 power is \"of\"; allowed: on, off, cycle. Did you mean \"off\"?");
  EXPECT_EQ(bad("frequency", 40),
            "-32602 frequency is 40; write text with a number and one of these units: Hz, kHz, for example \"5 Hz\".");
  EXPECT_EQ(bad("frequency", "400 Hz"), "-32000 the set frequency is above Pr.1; allowed: 0 to 120 Hz.");
  EXPECT_EQ(bad("mains", {{"dip", "40 %"}}), "-32602 mains: dip and for belong together, as {dip: 40 %, for: 200 ms}.");
  EXPECT_EQ(bad("mains", {{"dip", "140 %"}, {"for", "1 s"}}),
            "-32602 dip is \"140 %\"; allowed: 0 to 100 % (by how much the voltage falls).");
  EXPECT_EQ(bad("mains", {{"volt", "40 V"}}),
            "-32602 unknown word \"volt\" in mains; allowed: voltage, dip, for. Did you mean \"voltage\"?");
  EXPECT_EQ(bad("load", {{"torque", "-1 Nm"}}), "-32602 torque is \"-1 Nm\"; allowed: 0 to 1000 kNm.");
  EXPECT_EQ(bad("phase_loss", "L4"), "-32602 phase_loss is \"L4\"; allowed: L1, L2, L3, none.");
  EXPECT_EQ(bad("ambient", "400 C"), "-32602 ambient is \"400 C\"; allowed: -40 to 100 C.");
  EXPECT_EQ(bad("shaft", "blocked"), "-32602 shaft is \"blocked\"; allowed: locked, free. Did you mean \"locked\"?");
  EXPECT_EQ(bad("motor", "main"),
            "-32602 motor is \"main\"; allowed: inverter, mains, open, table. Did you mean \"mains\"?");
  EXPECT_EQ(bad("motor", "table"), "-32602 motor is \"table\"; the plant file has no voltage_table for this drive.");
  EXPECT_EQ(bad("fault", "E.PX"),
            "-32602 unknown word \"E.PX\" in fault; allowed: E.PE, earth_fault. Did you mean \"E.PE\"?");
  EXPECT_EQ(bad("switch", {{"SW9", 1}}), "-32000 there is no switch SW9; allowed: SW1.");
  EXPECT_EQ(bad("switch", {{"SW1", -1}}), "-32602 switch SW1 is -1; allowed: a whole number from 0.");
  EXPECT_EQ(bad("switch", {{"SW1", 1}}, "bare"), "-32000 the drive has no option board.");
  EXPECT_EQ(bad("parameter", {{"Pr.7", "fast"}}), "-32602 Pr.7 is \"fast\"; allowed: a number.");
  EXPECT_EQ(bad("parameter", {{"Pr.7", 9999}}), "-32000 Pr.7 allows 0 to 3600.");
  EXPECT_EQ(bad("status", {}, "b"), "-32602 there is no drive \"b\"; allowed: a, bare. Did you mean \"bare\"?");
  EXPECT_EQ(bad("status", {}, ""), "-32602 the drive is missing; allowed: a, bare.");
  EXPECT_EQ(bad("stauts", {}).substr(0, 35), "-32601 unknown command \"stauts\"; al");
  EXPECT_EQ(bad("stop", "now"), "-32602 stop takes no value.");
  EXPECT_EQ(bad("status", "all"), "-32602 status takes no value.");
  EXPECT_EQ(bad("names", "all"), "-32602 names takes no value.");
}

TEST_F(CommandsTest, ARefusedTerminalLeavesTheOthersAsTheyWere) {
  good("terminal", {{"RH", "on"}});
  bad("terminal", {{"RH", "off"}, {"STF", "on"}, {"XX", "on"}});
  bad("terminal", {{"RH", "off"}, {"STF", "on"}, {"STR", "maybe"}});
  const Json terminals = good("status", {})["terminals"];
  EXPECT_EQ(terminals["RH"], true);
  EXPECT_EQ(terminals["STF"], false);
}

TEST_F(CommandsTest, RunAndStopGoTheWayOfTheOperationMode) {
  const auto on = [&] {
    std::string out;
    for (const auto& [name, is_on] : inverter().terminals())
      if (is_on) out += std::string(name) + " ";
    return out;
  };
  good("run", "forward");
  EXPECT_EQ(on(), "STF ");
  good("run", "reverse");
  EXPECT_EQ(on(), "STR ") << "never both";
  good("stop", {});
  EXPECT_EQ(on(), "");
  EXPECT_TRUE(journal_.empty());
  good("mode", "PU");
  good("mode", "PU");
  good("run", "reverse");
  good("stop", {});
  using inverter::PanelKey;
  EXPECT_EQ(journal_, (test::Journal{"key " + std::to_string(static_cast<int>(PanelKey::kPuExt)),
                                     "key " + std::to_string(static_cast<int>(PanelKey::kRev)),
                                     "key " + std::to_string(static_cast<int>(PanelKey::kStopReset))}));
  inverter().port_.mode = port::OperationMode::kNetwork;
  EXPECT_EQ(bad("run", "forward").substr(0, 35), "-32000 the drive is in NET mode: it");
  EXPECT_EQ(bad("mode", "NET").substr(0, 31), "-32602 mode NET is set by the n");
}

TEST_F(CommandsTest, APowerCycleIsTwoSecondsOffAndALaterCommandTakesItsPlace) {
  EXPECT_EQ(good("power", "cycle"), "off for 2 s");
  run_ms(1999);
  EXPECT_FALSE(inverter().powered());
  run_ms(2);
  EXPECT_TRUE(inverter().powered());
  good("power", "cycle");
  good("power", "off");
  run_ms(5000);
  EXPECT_FALSE(inverter().powered());
  good("power", "on");
  EXPECT_TRUE(inverter().powered());
}

TEST_F(CommandsTest, ADipEndsByItselfAndLeavesOtherMainsSettings) {
  EXPECT_EQ(good("mains", {{"dip", "40 %"}, {"for", "200 ms"}})["voltage_V"], 240.0);
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 240);
  good("phase_loss", "L2");
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 240);
  run_ms(199);
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 240);
  run_ms(1);
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 400);
  EXPECT_EQ(inverter().mains_now.phase_present, (std::array{true, false, true}));
  good("phase_loss", "none");
  good("mains", {{"voltage", "380 V"}});
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 380);
  EXPECT_EQ(inverter().mains_now.phase_present, (std::array{true, true, true}));
}

TEST_F(CommandsTest, LoadChangesWhatIsNamedOnly) {
  const double before = plant_.drives()[0]->spec.load.value.inertia_kg_m2;
  good("load", {{"torque", "12 Nm"}, {"quadratic", "9 Nm"}});
  EXPECT_DOUBLE_EQ(inverter().load_now.constant_nm, 12);
  EXPECT_DOUBLE_EQ(inverter().load_now.inertia_kg_m2, before);
  const double rated = plant_.drives()[0]->spec.motor.value.rated_speed_rpm * std::numbers::pi / 30;
  EXPECT_NEAR(inverter().load_now.quadratic_nm_s2 * rated * rated, 9, 1e-9);
}

TEST_F(CommandsTest, ResetIsAPulseOnItsTerminal) {
  const auto res = [&] { return inverter().terminals()[0].second; };
  ASSERT_EQ(inverter().terminals()[0].first, "RES");
  good("reset", {});
  EXPECT_TRUE(res());
  run_ms(99);
  EXPECT_TRUE(res());
  run_ms(1);
  EXPECT_FALSE(res());
}

TEST_F(CommandsTest, SurroundingsFaultsAndSwitchesReachTheDrive) {
  good("ambient", "45 C");
  good("shaft", "locked");
  good("fault", "E.PE");
  good("fault", {{"earth_fault", "off"}});
  good("switch", {{"SW1", "4"}});
  EXPECT_EQ(good("status", {})["motor_source"], "inverter");
  good("motor", "mains");
  good("key", "UP");
  good("frequency", "42.5 Hz");
  EXPECT_DOUBLE_EQ(inverter().ambient_c, 45);
  EXPECT_TRUE(inverter().shaft_locked);
  EXPECT_EQ(inverter().faults, (std::map<std::string, bool>{{"E.PE", true}, {"earth_fault", false}}));
  EXPECT_EQ(dynamic_cast<test::FakeBoard&>(*plant_.drives()[0]->board).sw1, 4u);
  EXPECT_DOUBLE_EQ(inverter().panel_hz, 42.5);
  EXPECT_EQ(inverter().plant().motor_source(), plant::MotorSource::kMains);
  EXPECT_EQ(good("status", {})["motor_source"], "mains");
}

TEST_F(CommandsTest, ParametersAreReadAndWritten) {
  EXPECT_EQ(good("parameter", "Pr.7"), (Json{{"Pr.7", 5.0}}));
  EXPECT_EQ(good("parameter", {{"Pr.7", 2}}), (Json{{"Pr.7", 2.0}}));
  EXPECT_EQ(good("parameter", Json::array({"Pr.7", "Pr.345"})), (Json{{"Pr.7", 2.0}, {"Pr.345", 1.0}}));
  EXPECT_EQ(good("parameters", "accel")[0]["value"], 2.0);
  EXPECT_TRUE(good("parameters", "brake").empty());
}

TEST_F(CommandsTest, StatusListAndHelpTellWhatThereIs) {
  plant_.drives()[0]->tcp = TcpEndpoint{"127.0.0.1", 1502};
  plant_.drives()[0]->serial = SerialEndpoint{"/dev/pts/9"};
  const Json status = good("status", {});
  EXPECT_EQ(status["signals"]["output_frequency"]["value"], 12.5);
  EXPECT_EQ(status["alarm_history"], (Json{0xA3, 0x10}));
  EXPECT_EQ(status["mode"], "EXT");
  EXPECT_EQ(
      status["endpoints"].dump(),
      R"([{"protocol":"modbus-tcp","host":"127.0.0.1","port":1502,"unit":1},{"protocol":"modbus-rtu","path":"/dev/pts/9","unit":1}])");
  const Json list = *execute(plant_, "list", "", {});
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[1]["board"], Json());
  const Json help = *execute(plant_, "commands", "", {});
  EXPECT_EQ(help.size(), commands().size());
  EXPECT_EQ(good("names", {})["faults"], (Json{"E.PE", "earth_fault"}));
}

TEST_F(CommandsTest, WordsOfACommandLineMeanTheSameAsValues) {
  ASSERT_TRUE(words("terminal", {"STF=on", "RH=on"}));
  ASSERT_TRUE(words("terminal", {"RH", "off"}));
  for (const auto& [name, on] : inverter().terminals()) EXPECT_EQ(on, name == "STF") << name;
  ASSERT_TRUE(words("analog", {"terminal_2=5", "V"}));
  ASSERT_TRUE(words("analog", {"terminal_4", "12mA"}));
  EXPECT_DOUBLE_EQ(inverter().analog["2"], 5);
  EXPECT_DOUBLE_EQ(inverter().analog["4"], 12);
  ASSERT_TRUE(words("mains", {"dip", "100", "%", "for", "200", "ms"}));
  EXPECT_DOUBLE_EQ(inverter().mains_now.voltage_v_rms, 0);
  ASSERT_TRUE(words("load", {"torque", "12", "Nm", "inertia=0.5", "kg", "m2"}));
  EXPECT_DOUBLE_EQ(inverter().load_now.inertia_kg_m2, 0.5);
  EXPECT_EQ(*words("parameter", {"Pr.7", "3"}), (Json{{"Pr.7", 3.0}}));
  EXPECT_EQ(*words("parameter", {"Pr.7=4"}), (Json{{"Pr.7", 4.0}}));
  EXPECT_EQ(*words("parameter", {"Pr.7", "Pr.345"}), (Json{{"Pr.7", 4.0}, {"Pr.345", 1.0}}));
  ASSERT_TRUE(words("frequency", {"40", "Hz"}));
  // As a scenario writes them, with and without braces.
  EXPECT_EQ(*words("parameter", {"Pr.7:", "5"}), (Json{{"Pr.7", 5.0}}));
  EXPECT_EQ(*words("terminal", {"STF:", "on,", "RH:", "off"}), (Json{{"STF", "on"}, {"RH", "off"}}));
  EXPECT_EQ(*words("terminal", {"{STF: off, RH: on}"}), (Json{{"STF", "off"}, {"RH", "on"}}));
  EXPECT_EQ((*words("load", {"torque:", "9", "Nm,", "over:", "2", "s"}))["torque_Nm"], 9.0);
  ASSERT_TRUE(words("load", {"{table:", "[{at: 0 s, torque: 2 Nm}, {at: 1 s, torque: 3 Nm}]}"}));
  EXPECT_EQ(words("load", {"{torque: 12 Nm"}).error().code, CommandCode::kInvalidValue);
  EXPECT_EQ(words("load", {"{a: &x 1, b: *x}"}).error().message.substr(0, 17), "a value in braces");
  ASSERT_TRUE(words("fault", {"E.PE"}));
  EXPECT_EQ(words("load", {"12", "Nm"}).error().message.substr(0, 23), "\"12\" belongs to nothing");
}

TEST_F(CommandsTest, EveryExampleOfTheHelpIsUnderstood) {
  for (const CommandInfo& info : commands()) {
    std::istringstream in{std::string(info.example)};
    std::vector<std::string> w{std::istream_iterator<std::string>(in), {}};
    if (info.for_drive) w.erase(w.begin());
    ASSERT_EQ(w.at(0), info.name);
    w.erase(w.begin());
    const auto done = execute_words(plant_, info.name, info.for_drive ? "a" : "", w);
    if (info.name == "link")
      EXPECT_EQ(done.error().message, "the drive has no option board on Ethernet.");
    else
      EXPECT_TRUE(done) << info.example;
  }
}

}  // namespace
}  // namespace vinv::rig
