// The board on CANopen in front of a real FR-E500 model: run by PDO and by the velocity mode, trip, reset, fail to
// store, change modes. OI-FR-E5NCO manual, 4.2, 6, 7.
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_drive_bench.hpp"

namespace vinv::test {
namespace {

using port::OperationMode;

class OiFrE5ncoCanopenDrive : public CanopenDriveBench {};

TEST_F(OiFrE5ncoCanopenDrive, RunsByPdoUpTheRampAndStops) {
  tell("205#0200881300000000");
  run(500ms);
  EXPECT_TRUE(running());
  EXPECT_NEAR(hz(), 25, 1.5);
  run(1s);
  EXPECT_NEAR(hz(), 50, 0.01);
  EXPECT_EQ(tell("185#R8").substr(0, 12), "185#4B808813");  // RUN, forward, SU, FU, ready
  tell("205#0100000000000000");
  run(1500ms);
  EXPECT_FALSE(running());
  EXPECT_EQ(taken(), "");
}

TEST_F(OiFrE5ncoCanopenDrive, TripIsReportedReadResetAndOver) {
  tell("205#02008813");
  run(1200ms);
  ASSERT_TRUE(inverter_->inject_fault("E.OV3", true));
  run(60ms);
  EXPECT_EQ(taken(), "085#1032050022050000");
  EXPECT_EQ(tell("605#4000340000000000"), "585#4B00340022000000");
  EXPECT_EQ(write("605#2B07210000000000"), "085#0000000000050000 585#6007210000000000");
  run(1100ms);
  tell("205#02008813");  // Pr.340 = 1: network mode again
  run(1500ms);
  EXPECT_NEAR(hz(), 50, 0.01);
  EXPECT_EQ(taken(), "");
}

TEST_F(OiFrE5ncoCanopenDrive, VelocityModeRunsReversesAndStopsQuickly) {
  EXPECT_EQ(write("605#2B426000E8030000"), "585#6042600000000000");  // 1000 rpm
  EXPECT_EQ(write("605#2B40600006000000"), "585#6040600000000000");
  EXPECT_EQ(write("605#2B40600007000000"), "585#6040600000000000");
  EXPECT_EQ(write("605#2B4060000F000000"), "585#6040600000000000");
  run(1s);
  EXPECT_NEAR(hz(), 33.33, 0.01);
  EXPECT_EQ(tell("605#4043600000000000"), "585#4B436000E7030000");   // 999 rpm, rounded down
  EXPECT_EQ(write("605#2B42600018FC0000"), "585#6042600000000000");  // -1000 rpm
  run(2s);
  EXPECT_NEAR(hz(), 33.33, 0.01);
  EXPECT_TRUE(inverter_->port().status().reverse);
  EXPECT_EQ(tell("605#4041600000000000"), "585#4B41600037060000");  // operation enabled, target reached, remote
  EXPECT_EQ(write("605#2B40600002000000"), "585#6040600000000000");
  run(80ms);
  EXPECT_EQ(tell("605#4041600000000000").substr(12, 2), "17");  // quick stop active
  EXPECT_LT(hz(), 25);                                          // the ramp of Pr.45 = 0.2 s, not of Pr.8 = 1 s
  run(1s);
  EXPECT_FALSE(running());
  EXPECT_EQ(tell("605#4041600000000000").substr(12, 2), "50");  // switch on disabled
}

TEST_F(OiFrE5ncoCanopenDrive, ValueThatCannotBeStoredIsAHardwareErrorAndAnEmergency) {
  ASSERT_TRUE(inverter_->inject_fault("eeprom_write", true));
  EXPECT_EQ(write("605#2B07300032000000"), "585#8007300000000606");
  run(60ms);
  EXPECT_EQ(taken(), "085#3055013EB0050000");
}

TEST_F(OiFrE5ncoCanopenDrive, StartSignalOfTheTerminalsIsTheReasonByItsName) {
  tell("000#8005");
  run(5ms);
  ASSERT_EQ(inverter_->port().operation_mode(), port::OperationMode::kExternal);
  ASSERT_TRUE(inverter_->set_terminal("MRS", true));
  ASSERT_TRUE(inverter_->set_terminal("STF", true));
  run(5ms);
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(taken(), "085#0010001522050000");
  ASSERT_TRUE(inverter_->set_terminal("STF", false));
  ASSERT_TRUE(inverter_->set_terminal("STR", true));
  run(5ms);
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(taken(), "085#0010001523050000");
  ASSERT_TRUE(inverter_->set_terminal("STR", false));
  run(5ms);
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(taken(), "");
  EXPECT_EQ(inverter_->port().operation_mode(), port::OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenDrive, OperationalWhileTheTerminalsRunTheMotorIsRefused) {
  tell("000#8005");
  run(5ms);
  ASSERT_TRUE(inverter_->set_terminal("STF", true));
  ASSERT_TRUE(inverter_->set_analog("2", 5));
  run(1500ms);
  ASSERT_TRUE(running());
  EXPECT_NEAR(hz(), 25, 0.5);
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(taken(), "085#0010001524050000");
  tell("205#0100000000000000");  // not ours to stop
  run(500ms);
  EXPECT_EQ(taken(), "085#0010001512050000 085#0010001512050000");
  EXPECT_EQ(mode(), OperationMode::kExternal);
  EXPECT_NEAR(hz(), 25, 0.5);
  ASSERT_TRUE(inverter_->set_terminal("STF", false));
  run(1500ms);
  ASSERT_FALSE(running());
  EXPECT_EQ(mode(), OperationMode::kExternal);
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(mode(), OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenDrive, LeavingOperationalOfARunningMotorWaitsForItsStandstill) {
  tell("205#02008813");
  run(1200ms);
  tell("000#8005");
  run(500ms);
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  EXPECT_NEAR(hz(), 50, 0.01);  // 6007H = 0
  EXPECT_EQ(write("605#2B00400001000000"), "585#6000400000000000");
  run(500ms);
  EXPECT_TRUE(running());
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  run(1s);
  EXPECT_FALSE(running());
  EXPECT_EQ(mode(), OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenDrive, BootedNodeInNetworkModeByPr340IsCommandedBySdo) {
  inverter_->set_power(false);
  run(5s);
  inverter_->set_power(true);
  run(1s);
  EXPECT_EQ(taken(), "705#00");
  EXPECT_EQ(tell("705#R1"), "705#7F");
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  download(0x4001, 0, 3000, 2);
  download(0x4000, 0, 2, 2);
  run(1s);
  EXPECT_NEAR(hz(), 30, 0.01);
}

TEST_F(OiFrE5ncoCanopenDrive, ModbusAndNmtTakeTheModeFromEachOtherAtStandstill) {
  modbus::Unit& unit = *board_->modbus_unit();
  const auto modbus = [&](std::uint8_t value) {
    const Bytes pdu{6, 0x65, 0x90, 0, value};  // 26000
    unit.handle_request(now_, 1, modbus::Addressing::kUnit, pdu);
    run(5ms);
    return unit.poll_answer(now_, 1) == std::optional<Bytes>(pdu);
  };
  EXPECT_TRUE(modbus(0));
  EXPECT_EQ(mode(), OperationMode::kExternal);
  EXPECT_EQ(tell("705#R1"), "705#05");
  tell("000#0105");
  run(5ms);
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  tell("205#02008813");
  run(1200ms);
  EXPECT_FALSE(modbus(0));  // not while it runs
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  tell("205#01000000");
  run(1500ms);
  EXPECT_TRUE(modbus(0));
  EXPECT_EQ(mode(), OperationMode::kExternal);
  EXPECT_TRUE(modbus(1));
  EXPECT_EQ(mode(), OperationMode::kNetwork);
  tell("000#8005");
  run(5ms);
  EXPECT_EQ(mode(), OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenDrive, CommandRightOfTheTerminalsIsLocalControl) {
  download(0x3000 + 338, 0, 1, 2);  // operation by the terminals
  EXPECT_EQ(write("605#2B00400002000000"), "585#8000400021000008");
  EXPECT_EQ(write("605#2B00400000000000"), "585#6000400000000000");  // releasing is everybody's right
  download(0x3000 + 338, 0, 0, 2);
  download(0x3000 + 339, 0, 1, 2);  // speed by the terminals: the board's converter is one
  EXPECT_EQ(write("605#2B01400088130000"), "585#8001400021000008");
  EXPECT_EQ(write("605#2B014001DC050000"), "585#8001400121000008");
  tell("205#00008813");
  run(5ms);
  EXPECT_EQ(taken(), "085#0010001512050000");  // the frequency; the command word was accepted
}

TEST_F(OiFrE5ncoCanopenDrive, AnalogSpeedSetsTheFrequencyThroughTheConverter) {
  EXPECT_EQ(write("605#2B014002FF000000"), "585#8001400221000008");  // needs Pr.339 = 1
  download(0x3000 + 339, 0, 1, 2);
  download(0x4001, 2, 255, 2);
  download(0x4000, 0, 2, 2);
  run(1500ms);
  const double full_scale = hz();
  EXPECT_NEAR(full_scale, 50, 0.3);
  download(0x4001, 2, 102, 2);
  run(1500ms);
  EXPECT_NEAR(hz(), full_scale * 102 / 255, 0.3);
  download(0x4001, 2, 0, 2);
  run(1500ms);
  EXPECT_NEAR(hz(), 0, 0.3);
}

TEST_F(OiFrE5ncoCanopenDrive, AlarmsBufferShiftsAndIsCleared) {
  for (const char* alarm : {"E.OC1", "E.OV3", "E.THM"}) {
    ASSERT_TRUE(inverter_->inject_fault(alarm, true));
    run(60ms);
    write("605#2B07210000000000");
    run(1200ms);
  }
  taken();
  EXPECT_EQ(tell("605#4000340000000000"), "585#4B00340031220000");
  EXPECT_EQ(tell("605#4001340000000000"), "585#4B01340010000000");
  EXPECT_EQ(write("605#2B06210000000000"), "585#6006210000000000");
  run(5ms);
  EXPECT_EQ(tell("605#4000340000000000"), "585#4B00340000000000");
  EXPECT_EQ(tell("605#4001340000000000"), "585#4B01340000000000");
}

TEST_F(OiFrE5ncoCanopenDrive, ControlwordResetsATripAndRunsAgain) {
  enable(1000);
  run(1s);
  ASSERT_TRUE(inverter_->inject_fault("E.OC1", true));
  run(60ms);
  EXPECT_EQ(taken(), "085#1322030010050000");
  EXPECT_EQ(tell("605#4041600000000000").substr(12, 2), "18");  // fault
  EXPECT_EQ(write("605#2B40600080000000"), "085#0000000000050000 585#6040600000000000");
  run(1100ms);
  EXPECT_EQ(tell("605#4041600000000000").substr(12, 2), "50");  // switch on disabled
  enable(1000);
  run(1s);
  EXPECT_NEAR(hz(), 33.33, 0.01);
}

TEST_F(OiFrE5ncoCanopenDrive, RestoreAndEveryParameterOfTheFamily) {
  EXPECT_EQ(write("605#2B0730004D000000"), "585#6007300000000000");
  EXPECT_EQ(tell("605#4007300000000000"), "585#4B0730004D000000");
  EXPECT_EQ(write("605#231110006C6F6164"), "585#6011100000000000");
  run(5ms);
  EXPECT_EQ(tell("605#4007300000000000"), "585#4B07300032000000");
  unsigned there = 0;
  for (unsigned n = 0; n < 1000; ++n) {
    if (n >= 902 && n <= 905) continue;
    char request[24];
    std::snprintf(request, sizeof request, "605#40%02X%02X0000000000", (0x3000 + n) & 0xff, (0x3000 + n) >> 8);
    const std::string answer = tell(request);
    const auto value = inverter_->port().read_parameter({static_cast<std::uint16_t>(n), 0});
    if (!value) {
      EXPECT_EQ(answer.substr(12), "00000206") << n;
    } else {
      ++there;
      EXPECT_EQ(answer.substr(4, 2), "4B") << n;
    }
  }
  EXPECT_GT(there, 100u);
}

}  // namespace
}  // namespace vinv::test
