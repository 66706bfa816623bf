// Every mistake is named with its line and column, what is allowed, and the word that was probably meant.
#include <gtest/gtest.h>

#include <string>

#include "sim/rig/plant_file.hpp"
#include "tests/sim/rig/fakes.hpp"
#include "tests/support/alias_bomb.hpp"

namespace vinv::rig {
namespace {

struct Mistake {
  const char* name;
  const char* text;
  const char* expected;  // the whole message
};

#define CAN_WAYS                                                                                            \
  "virtual, socketcan:INTERFACE, socketcand:ADDRESS:PORT/CHANNEL, slcan:ADDRESS:PORT, slcan:/dev/ttyACM0, " \
  "udp_multicast, udp_multicast:GROUP"

const Mistake kMistakes[] = {
    {"EmptyFile", "", "p.yaml:1:1: the file is empty; a plant needs at least \"drives:\" with one drive."},
    {"OnlyAComment", "# nothing\n",
     "p.yaml:1:1: the file is empty; a plant needs at least \"drives:\" with one drive."},
    {"Tabs", "drives:\n\t- name: a\n", "p.yaml:2:2: this is not YAML: "},
    {"UnclosedBrace", "drives:\n  - { name: a\n", "p.yaml:3:1: this is not YAML: "},
    {"TwoDocuments", "drives: [{}]\n---\ndrives: [{}]\n",
     "p.yaml:3:1: a second document (---) begins here; a plant file is one document."},
    {"AListAtTheTop", "- name: a\n",
     "p.yaml:1:1: the plant file is a list; allowed: a mapping with the keys name, networks, drives."},
    {"MisspeltTopKey", "drivers:\n  - name: a\ndrives: [{}]\n",
     "p.yaml:1:1: unknown key \"drivers\" in the plant file; allowed: name, networks, drives. Did you mean "
     "\"drives\"?"},
    {"NoDrives", "name: a\n", "p.yaml:1:1: \"drives\" is missing; a plant needs a list of at least one drive."},
    {"DrivesWithoutValue", "drives:\n",
     "p.yaml:1:1: \"drives\" in the plant file has no value; write one, or leave the key out."},
    {"DrivesIsAMapping", "drives:\n  name: a\n",
     "p.yaml:2:3: drives is a mapping (key: value); allowed: a list (- name: ...) of 1 to 4096 drives."},
    {"EmptyListOfDrives", "drives: []\n",
     "p.yaml:1:9: drives is a list of 0; allowed: a list (- name: ...) of 1 to 4096 drives."},
    {"DriveIsAWord", "drives:\n  - conveyor\n",
     "p.yaml:2:5: drive 1 is \"conveyor\"; allowed: a mapping with the keys name, inverter, "},
    {"BadPlantName", "name: my plant\ndrives: [{}]\n",
     "p.yaml:1:7: name of the plant is \"my plant\"; allowed: a letter, then letters, digits, _ and -, 64 in all."},
    {"BadDriveName", "drives:\n  - name: ../etc\n",
     "p.yaml:2:11: name of drive 1 is \"../etc\"; allowed: a letter, then letters, digits, _ and -, 64 in all."},
    {"NameTaken", "drives:\n  - name: a\n  - name: a\n",
     "p.yaml:3:11: the name \"a\" is taken by the drive in line 2."},
    {"MisspeltDriveKey", "drives:\n  - name: a\n    invertor: {}\n",
     "p.yaml:3:5: unknown key \"invertor\" in drive 1; allowed: name, inverter, motor, motor_source, voltage_table, "
     "load, mains, losses, "
     "ideal, brake_resistor_ohm, ambient_C, solver, power, board, terminals, analog, parameters. Did you mean "
     "\"inverter\"?"},
    {"KeyTwice", "drives:\n  - name: a\n    name: b\n",
     "p.yaml:3:5: \"name\" stands twice in drive 1; first in line 2."},
    {"UnknownFamily", "drives:\n  - inverter: { family: fr-e50 }\n",
     "p.yaml:2:25: family in inverter of drive_1 is \"fr-e50\"; allowed: fr-e500. Did you mean \"fr-e500\"?"},
    {"UnknownModel", "drives:\n  - inverter: { model: FR-E540-1.5 }\n",
     "p.yaml:2:24: model in inverter of drive_1 is \"FR-E540-1.5\"; allowed: FR-E540-0.4K, FR-E540-0.75K, "
     "FR-E540-1.5K, "
     "FR-E540-2.2K, FR-E520-0.2K. Did you mean \"FR-E540-1.5K\"?"},
    {"UnknownPreset", "drives:\n  - motor: { preset: iec4p_1k5kw_400V }\n", "Did you mean \"iec4p_1k5kW_400V\"?"},
    {"MotorLacksValues", "drives:\n  - motor: { R_s_ohm: 3.6, R_r_ohm: 3.1 }\n",
     "p.yaml:2:12: motor of drive_1 lacks L_ls_H, L_lr_H, L_m_H, inertia_kg_m2, rated_power_W, rated_voltage_V, "
     "rated_current_A, rated_speed_rpm; give a preset, or all values of the equivalent circuit and the name plate."},
    {"MotorFasterThanItsField", "drives:\n  - motor: { preset: iec4p_1k5kW_400V, rated_speed_rpm: 1600 }\n",
     "p.yaml:2:12: motor of drive_1 is refused: "},
    {"NegativeResistance", "drives:\n  - motor: { preset: iec4p_1k5kW_400V, R_s_ohm: -1 }\n",
     "p.yaml:2:49: R_s_ohm in motor of drive_1 is -1; allowed: more than 0, up to 100000."},
    {"NumberWithUnit", "drives:\n  - load: { inertia_kg_m2: 0.02 kg m2 }\n",
     "p.yaml:2:28: inertia_kg_m2 in load of drive_1 is \"0.02 kg m2\"; allowed: a plain number, 0 to 1000000, without "
     "quotes "
     "and without a unit (the unit is part of the key)."},
    {"QuotedNumber", "drives:\n  - load: { inertia_kg_m2: \"0.02\" }\n",
     "p.yaml:2:28: inertia_kg_m2 in load of drive_1 is quoted text; allowed: a plain number, 0 to 1000000, without "
     "quotes "
     "and without a unit (the unit is part of the key)."},
    {"NotANumber", "drives:\n  - ambient_C: .nan\n",
     "p.yaml:2:16: ambient_C in drive 1 is \".nan\"; allowed: a plain number, -40 to 100, "},
    {"CommaForAPoint", "drives:\n  - brake_resistor_ohm: 1,5\n",
     "p.yaml:2:25: brake_resistor_ohm in drive 1 is \"1,5\"; allowed: a plain number, 0 to 1000000, "},
    {"KeyWithoutItsUnit", "drives:\n  - load: { inertia: 0.02 }\n",
     "p.yaml:2:13: unknown key \"inertia\" in load of drive_1; allowed: inertia_kg_m2, torque, friction. "
     "Did you mean \"inertia_kg_m2\"?"},
    {"UnknownTorque", "drives:\n  - load: { torque: { quadratic_Nm: 9 } }\n",
     "Did you mean \"quadratic_Nm_at_rated\"?"},
    {"TorqueIsANumber", "drives:\n  - load: { torque: 9 }\n",
     "p.yaml:2:21: torque of drive_1 is \"9\"; allowed: a mapping with the keys constant_Nm, linear_Nm_at_rated, "
     "quadratic_Nm_at_rated, hoist_Nm, table."},
    {"TableGoesBack",
     "drives:\n  - load:\n      torque:\n        table:\n          - {time_s: 2, torque_Nm: 1}\n          - {time_s: "
     "1, torque_Nm: 2}\n",
     "p.yaml:6:22: time_s in table of drive_1 is 1; allowed: more than that of the point before."},
    {"TablePointLacksTorque", "drives:\n  - load: { torque: { table: [ {time_s: 2} ] } }\n",
     "p.yaml:2:32: a point in table of drive_1 needs both time_s and torque_Nm."},
    {"MainsTooHigh", "drives:\n  - mains: { voltage_V: 4000 }\n",
     "p.yaml:2:25: voltage_V in mains of drive_1 is 4000; allowed: 0 to 1000."},
    {"UnknownSolver", "drives:\n  - solver: rk5\n",
     "p.yaml:2:13: solver in drive 1 is \"rk5\"; allowed: erk, cvode_bdf, rk4. Did you mean \"rk4\"?"},
    {"PowerIsNoSwitch", "drives:\n  - power: maybe\n", "p.yaml:2:12: power in drive 1 is \"maybe\"; allowed: on, off."},
    {"UnknownBoard", "drives:\n  - board: { type: oi-fr-e5nc }\n",
     "p.yaml:2:20: type in board of drive_1 is \"oi-fr-e5nc\"; allowed: oi-fr-e5nco. Did you mean \"oi-fr-e5nco\"?"},
    {"NodeIsNoWholeNumber", "drives:\n  - board: { node: 1.5 }\n",
     "p.yaml:2:20: node in board of drive_1 is \"1.5\"; allowed: a whole number, 1 to 247."},
    {"NodeOutOfRange", "drives:\n  - board: { node: 0 }\n",
     "p.yaml:2:20: node in board of drive_1 is \"0\"; allowed: a whole number, 1 to 247."},
    {"OctalNode", "drives:\n  - board: { node: 010 }\n",
     "p.yaml:2:20: node in board of drive_1 is \"010\"; allowed: a whole number, 1 to 247."},
    {"NodeTakenOnThePort", "drives:\n  - board: { node: 3 }\n  - board: { node: 3 }\n",
     "p.yaml:3:20: node 3 of drive_2 is taken by drive_1 on the same Modbus/TCP port; allowed: another node, or a wire "
     "of its own."},
    {"NodeTakenOnTheLine",
     "networks: { bus: { serial: pty } }\ndrives:\n  - board: { node: 3, modbus_rtu: bus, modbus_tcp: none }\n"
     "  - board: { node: 3, modbus_rtu: bus, modbus_tcp: none }\n",
     "p.yaml:4:20: node 3 of drive_2 is taken by drive_1 on the same serial line; allowed: another node, or a wire of "
     "its own."},
    {"UnknownCanBus", "networks:\n  line: { can: virtal }\ndrives: [{}]\n",
     "p.yaml:2:16: can in network line is \"virtal\"; allowed: " CAN_WAYS ". Did you mean \"virtual\"?"},
    {"SocketcandWithoutChannel", "networks:\n  line: { can: \"socketcand:127.0.0.1:29536\" }\ndrives: [{}]\n",
     "p.yaml:2:16: can in network line is \"socketcand:127.0.0.1:29536\"; allowed: " CAN_WAYS "."},
    {"SlcanWithoutPort", "networks:\n  line: { can: \"slcan:127.0.0.1\" }\ndrives: [{}]\n",
     "p.yaml:2:16: can in network line is \"slcan:127.0.0.1\"; allowed: " CAN_WAYS "."},
    {"InterfaceNameTooLong", "networks:\n  line: { can: \"socketcan:an_interface_of_18\" }\ndrives: [{}]\n",
     "p.yaml:2:16: can in network line is \"socketcan:an_interface_of_18\"; allowed: " CAN_WAYS "."},
    {"BitRateOfNoBus", "networks:\n  line: { can: virtual, bitrate: 800k }\ndrives: [{}]\n",
     "p.yaml:2:34: bitrate in network line is \"800k\"; allowed: 20k, 50k, 62.5k, 100k, 125k, 250k, 500k, 1M."},
    {"BitRateOfASerialLine", "networks:\n  line: { serial: pty, bitrate: 125k }\ndrives: [{}]\n",
     "p.yaml:2:24: bitrate in network line belongs to a can network only."},
    {"SocketcandIsNoAddress", "networks:\n  line: { can: virtual, socketcand: 29536 }\ndrives: [{}]\n",
     "p.yaml:2:37: socketcand in network line is \"29536\"; allowed: address:port, as 127.0.0.1:29536, [::1]:29536 or "
     "0.0.0.0:29536; port 0 to 65535, 0 picks a free one."},
    {"ChannelTooLong", "networks:\n  line_of_sixteen_: { can: virtual }\ndrives: [{}]\n",
     "p.yaml:2:28: channel of network line_of_sixteen_ is \"line_of_sixteen_\"; allowed: a letter, then letters, "
     "digits, "
     "_ and -, 15 in all, as socketcand clients open it."},
    {"ChannelTaken", "networks:\n  a: { can: virtual, channel: x }\n  b: { can: virtual, channel: x }\ndrives: [{}]\n",
     "p.yaml:3:13: network b has the socketcand channel \"x\" of network a at 127.0.0.1:29536; allowed: another "
     "channel, "
     "or another address."},
    {"SlcanTaken",
     "networks:\n  a: { can: virtual, slcan: \"127.0.0.1:3333\" }\n  b: { can: virtual, slcan: \"127.0.0.1:3333\" }\n"
     "drives: [{}]\n",
     "p.yaml:3:29: slcan in network b is \"127.0.0.1:3333\", which network a has; allowed: an address for each bus."},
    {"UnknownCanNetwork", "networks: { hall: { can: virtual } }\ndrives:\n  - board: { network: hal }\n",
     "p.yaml:3:23: network of drive_1 is \"hal\"; allowed: hall, can0, none, or a bus elsewhere, as socketcan:vcan0. "
     "Did "
     "you mean \"hall\"?"},
    {"VirtualBusWithoutAName", "drives:\n  - board: { network: virtual }\n",
     "p.yaml:2:23: network of drive_1 is \"virtual\"; allowed: can0, none, or a bus elsewhere, as socketcan:vcan0."},
    {"SerialLineForCan", "networks: { hall: { serial: pty } }\ndrives:\n  - board: { network: hall }\n",
     "p.yaml:3:23: network of drive_1 is \"hall\", which is a serial network; allowed: none, or a can network."},
    {"NodeTakenOnTheBus",
     "drives:\n  - board: { node: 3, modbus_tcp: none, modbus_rtu: none }\n"
     "  - board: { node: 3, modbus_tcp: none, modbus_rtu: none }\n",
     "p.yaml:3:20: node 3 of drive_2 is taken by drive_1 on the same CAN bus; allowed: another node, or a wire of its "
     "own."},
    {"NodeTakenOnAKernelBus",
     "networks: { line: { can: \"socketcan:vcan0\" } }\ndrives:\n"
     "  - board: { node: 3, modbus_tcp: none, network: line }\n"
     "  - board: { node: 3, modbus_tcp: none, network: \"socketcan:vcan0\" }\n",
     "p.yaml:4:20: node 3 of drive_2 is taken by drive_1 on the same CAN bus; allowed: another node, or a wire of its "
     "own."},
    {"NodeTakenByAParameter",
     "drives:\n  - board: { node: 3 }\n  - board: { node: 4 }\n    parameters: { Pr.345: 3 }\n",
     "p.yaml:4:27: node 3 of drive_2 (Pr.345) is taken by drive_1 on the same Modbus/TCP port; allowed: another node, "
     "or "
     "a wire of its own."},
    {"UnknownSerialLine", "networks: { hall: { serial: pty } }\ndrives:\n  - board: { modbus_rtu: hal }\n",
     "p.yaml:3:26: modbus_rtu of drive_1 is \"hal\"; allowed: a device as /dev/ttyUSB0, hall, pty, none. Did you mean "
     "\"hall\"?"},
    {"SerialLineForTcp", "networks: { hall: { serial: pty } }\ndrives:\n  - board: { modbus_tcp: hall }\n",
     "p.yaml:3:26: modbus_tcp of drive_1 is \"hall\", which is a serial network; allowed: address:port, none, or a "
     "modbus_tcp network."},
    {"PortTooHigh", "drives:\n  - board: { modbus_tcp: 127.0.0.1:70000 }\n",
     "p.yaml:2:26: modbus_tcp of drive_1 is \"127.0.0.1:70000\"; allowed: address:port (127.0.0.1:1502; port 0 to "
     "65535, 0 picks a free one), none."},
    {"HostName", "drives:\n  - board: { modbus_tcp: plc.example:502 }\n",
     "p.yaml:2:26: modbus_tcp of drive_1 is \"plc.example:502\"; allowed: address:port ("},
    {"OctetTooHigh", "drives:\n  - board: { modbus_tcp: 127.0.0.256:502 }\n",
     "p.yaml:2:26: modbus_tcp of drive_1 is \"127.0.0.256:502\"; allowed: "},
    {"NetworkWithoutKind", "networks:\n  hall: {}\ndrives: [{}]\n",
     "p.yaml:2:3: network hall has no kind; allowed: one of serial (pty or a device), modbus_tcp (address:port) and "
     "can (" CAN_WAYS ")."},
    {"NetworkWithBothKinds", "networks:\n  hall: { serial: pty, modbus_tcp: 127.0.0.1:0 }\ndrives: [{}]\n",
     "p.yaml:2:3: network hall has several kinds; allowed: one of serial (pty or a device), modbus_tcp (address:port) "
     "and can (" CAN_WAYS ")."},
    {"NetworkDeviceIsNoDevice", "networks:\n  hall: { serial: COM1 }\ndrives: [{}]\n",
     "p.yaml:2:19: serial in network hall is \"COM1\"; allowed: pty, or a device as /dev/ttyUSB0."},
    {"TerminalIsANumber", "drives:\n  - terminals: { STF: 1 }\n",
     "p.yaml:2:23: terminal STF of drive_1 is \"1\"; allowed: on, off."},
    {"AnalogOutOfRange", "drives:\n  - analog: { terminal_2: 230 }\n",
     "p.yaml:2:27: analog terminal terminal_2 of drive_1 is 230; allowed: -30 to 30."},
    {"ParameterIsText", "drives:\n  - parameters: { Pr.7: fast }\n",
     "p.yaml:2:25: Pr.7 of drive_1 is \"fast\"; allowed: a plain number, "},
    {"ParametersAreAList", "drives:\n  - parameters: [5, 3]\n",
     "p.yaml:2:17: parameters of drive_1 is a list; allowed: a mapping."},
};

class PlantFileMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(PlantFileMistakes, AreNamedWithTheirPlaceAndWhatIsAllowed) {
  test::Journal journal;
  try {
    parse_plant_file(GetParam().text, "p.yaml", test::fake_catalogue(journal));
    FAIL() << "accepted:\n" << GetParam().text;
  } catch (const PlantFileError& e) {
    ASSERT_EQ(e.problems().size(), 1u) << e.what();
    const std::string expected = GetParam().expected;
    if (expected.starts_with("p.yaml"))
      EXPECT_TRUE(std::string(e.what()).starts_with(expected)) << e.what() << "\nexpected\n" << expected;
    else
      EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
    if (expected.ends_with(".") || expected.ends_with("?")) {
      EXPECT_TRUE(std::string(e.what()).ends_with(expected)) << e.what() << "\nexpected\n" << expected;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PlantFileMistakes, testing::ValuesIn(kMistakes),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(PlantFileMistake, AllMistakesOfAFileAreToldAtOnceInTheOrderOfTheirLines) {
  test::Journal journal;
  try {
    parse_plant_file(
        "drives:\n  - name: a\n    colour: red\n    board: { node: 3 }\n  - name: b\n    board: { node: 3, nod: 1 "
        "}\nmaster: plc\n",
        "p.yaml", test::fake_catalogue(journal));
    FAIL();
  } catch (const PlantFileError& e) {
    ASSERT_EQ(e.problems().size(), 4u) << e.what();
    EXPECT_EQ(e.problems()[0].at.line, 3);
    EXPECT_EQ(e.problems()[1].at.line, 6);
    EXPECT_EQ(e.problems()[2].at.line, 6);
    EXPECT_EQ(e.problems()[3].at.line, 7);
  }
}

TEST(PlantFileMistake, AMissingFileIsNamedWithTheReason) {
  test::Journal journal;
  try {
    load_plant_file("/nonexistent/plant.yaml", test::fake_catalogue(journal));
    FAIL();
  } catch (const PlantFileError& e) {
    EXPECT_STREQ(e.what(), "/nonexistent/plant.yaml: cannot be read: No such file or directory.");
  }
}

TEST(PlantFileMistake, AFolderIsNoPlantFile) {
  test::Journal journal;
  try {
    load_plant_file("/tmp", test::fake_catalogue(journal));
    FAIL();
  } catch (const PlantFileError& e) {
    EXPECT_STREQ(e.what(), "/tmp: is a folder; a plant file is a YAML text.");
  }
  EXPECT_THROW(load_plant_file("/dev/zero", test::fake_catalogue(journal)), PlantFileError) << "which never ends";
}

TEST(PlantFileMistake, AHugeFileIsRefusedUnread) {
  test::Journal journal;
  const std::string text(kMaxPlantFileBytes + 1, '#');
  EXPECT_THROW(parse_plant_file(text, "p.yaml", test::fake_catalogue(journal)), PlantFileError);
}

TEST(PlantFileMistake, AliasesThatMakeAFileHugeAreRefusedUnread) {
  test::Journal journal;
  try {
    parse_plant_file(vinv::test::alias_bomb(), "p.yaml", test::fake_catalogue(journal));
    FAIL();
  } catch (const PlantFileError& e) {
    EXPECT_STREQ(e.what(), "p.yaml:1:1: the file is nested too deep, or its aliases make it too large.");
  }
}

}  // namespace
}  // namespace vinv::rig
