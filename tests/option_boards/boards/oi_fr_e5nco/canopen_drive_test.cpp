// The board on CANopen in front of a real FR-E500 model, without any wire: run by PDO and by the velocity mode, trip,
// reset, lose the master, fail to store.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/make_board.hpp"
#include "sim/base/check.hpp"
#include "tests/option_boards/canopen/can_text.hpp"

namespace vinv::test {
namespace {

using namespace std::chrono_literals;

class OiFrE5ncoCanopenDrive : public ::testing::Test {
 protected:
  OiFrE5ncoCanopenDrive() {
    inverter::InverterConfig config;
    config.model = "FR-E540-1.5K";
    config.motor = *plant::find_machine("iec4p_1k5kW_400V");
    inverter_ = std::move(inverter::make_inverter("fr-e500", config)).value();
    preset("Pr.7", 1.0);
    preset("Pr.8", 1.0);
    preset("Pr.345", 5);
    preset("Pr.340", 1);
    preset("Pr.180", 3);
    preset("Pr.45", 0.2);
    board_ = std::move(boards::make_board({"oi-fr-e5nco", 5}, inverter_->port())).value();
    inverter_->set_power(true);
    run(1s);
    EXPECT_EQ(taken(), "705#00");
    tell("000#0105");
    run(5ms);
  }
  void preset(const std::string& name, double value) { ASSERT_TRUE(inverter_->preset_parameter(name, value)); }
  boards::CanChannel& bus() {
    boards::CanChannel* channel = board_->can_channel();
    VINV_CHECK(channel != nullptr);
    return *channel;
  }
  void drain() {
    while (const auto frame = bus().poll_transmit(now_)) sent_ += (sent_.empty() ? "" : " ") + text_of(*frame);
  }
  // Ticks of 1 ms; the board's deadlines in between.
  void run(Duration time) {
    const Instant end = now_ + time;
    while (now_ < end) {
      if (const auto at = board_->next_deadline(); at && *at <= now_) {
        board_->handle_timeout(now_);
        drain();
      }
      inverter_->tick(now_);
      if (inverter_->powered() != powered_) {
        powered_ = inverter_->powered();
        board_->handle_power(now_, powered_);
      }
      board_->handle_drive_tick(now_);
      drain();
      now_ += inverter::Inverter::kControlPeriod;
    }
  }
  std::string tell(std::string_view text) {
    bus().handle_frame(now_, can(text));
    drain();
    return taken();
  }
  std::string taken() { return std::exchange(sent_, {}); }
  std::string write(std::string_view request) {
    sent_ = tell(request);
    run(5ms);
    return taken();
  }
  double hz() { return inverter_->port().read_monitor(1).value_or(std::uint16_t{0}) / 100.0; }
  bool running() { return inverter_->port().status().running; }

  std::unique_ptr<inverter::Inverter> inverter_;
  std::unique_ptr<boards::OptionBoard> board_;
  Instant now_ = instant_from_ns(2'000'000'000);
  bool powered_ = false;
  std::string sent_;
};

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

TEST_F(OiFrE5ncoCanopenDrive, LossOfTheMasterCoastsAsSet) {
  EXPECT_EQ(write("605#2B07600002000000"), "585#6007600000000000");
  EXPECT_EQ(write("605#2B0C100064000000"), "585#600C100000000000");
  EXPECT_EQ(write("605#2F0D100002000000"), "585#600D100000000000");
  tell("205#02008813");
  EXPECT_EQ(tell("705#R1"), "705#05");
  run(150ms);
  EXPECT_TRUE(running());
  run(100ms);
  EXPECT_EQ(taken(), "085#3081111F00050000");
  EXPECT_FALSE(running());
  EXPECT_TRUE(inverter_->alarm_name().empty());
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

TEST_F(OiFrE5ncoCanopenDrive, RestoreAndEveryParameterOfTheFamily) {
  EXPECT_EQ(write("605#2B07300032000000"), "585#6007300000000000");
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
