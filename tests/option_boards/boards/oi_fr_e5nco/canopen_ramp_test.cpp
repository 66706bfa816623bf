// The motor's ramps as velocity mode and 6007H set them, on a real FR-E500 model. OI-FR-E5NCO manual, 7.4, 7.9 to 7.12.
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_drive_bench.hpp"

namespace vinv::test {
namespace {

class OiFrE5ncoCanopenRamp : public CanopenDriveBench {
 protected:
  // A master that is gone 200 ms after its last request.
  void lose_master(std::uint32_t option) {
    download(0x6007, 0, option, 2);
    download(0x100c, 0, 100, 2);
    download(0x100d, 0, 2, 1);
    tell("205#02008813");
    for (int i = 0; i < 15; ++i) {
      tell("705#R1");
      run(100ms);
    }
    EXPECT_NEAR(hz(), 50, 0.01);
    run(95ms);
    EXPECT_EQ(taken(), "");
    run(10ms);
    EXPECT_EQ(taken(), "085#3081111F00050000");
  }
};

TEST_F(OiFrE5ncoCanopenRamp, DeltaSpeedByDeltaTimeIsTheSlope) {
  download(0x6048, 1, 1500, 4);
  download(0x6048, 2, 2, 2);
  download(0x6049, 2, 3, 2);
  download(0x604a, 2, 1, 2);
  enable(1500);
  EXPECT_NEAR(seconds_to(25, 5), 1, 0.05);
  EXPECT_NEAR(seconds_to(49.99, 5), 1, 0.05);
  run(500ms);
  EXPECT_NEAR(shaft_rpm(), 1500, 30);
  download(0x6042, 0, 0, 2);
  EXPECT_NEAR(seconds_to(25, 5), 1.5, 0.05);
  EXPECT_NEAR(shaft_rpm(), 750, 40);
  EXPECT_NEAR(seconds_to(10, 5), 0.9, 0.05);
  download(0x6042, 0, 1500, 2);
  seconds_to(49.99, 5);
  download(0x6040, 0, 0x02, 2);  // quick stop
  EXPECT_NEAR(seconds_to(25, 5), 0.5, 0.05);
  EXPECT_NEAR(seconds_to(10, 5), 0.3, 0.05);
}

TEST_F(OiFrE5ncoCanopenRamp, DeltaSpeedOfOneRampIsThatOfAll) {
  download(0x6048, 2, 2, 2);
  download(0x6049, 2, 2, 2);
  download(0x604a, 1, 3000, 4);  // of the quick stop: 100 Hz
  enable(1500);
  EXPECT_NEAR(seconds_to(49.99, 5), 1, 0.05);  // twice as steep
  download(0x6042, 0, 0, 2);
  EXPECT_NEAR(seconds_to(25, 5), 0.5, 0.05);
}

TEST_F(OiFrE5ncoCanopenRamp, QuickStopWithoutTheSecondFunctionIsTheNormalRamp) {
  download(0x3000 + 180, 0, 0, 2);
  download(0x6049, 2, 2, 2);
  download(0x604a, 2, 1, 2);
  enable(1500);
  seconds_to(49.99, 5);
  download(0x6040, 0, 0x02, 2);
  EXPECT_NEAR(seconds_to(25, 5), 1, 0.05);
}

TEST_F(OiFrE5ncoCanopenRamp, MinimumAndMaximumBoundTheVelocity) {
  download(0x6046, 1, 300, 4);
  download(0x6046, 2, 900, 4);
  enable(1500);
  run(1500ms);
  EXPECT_NEAR(hz(), 30, 0.01);
  download(0x6042, 0, 0, 2);
  run(1500ms);
  EXPECT_NEAR(hz(), 10, 0.01);
}

TEST_F(OiFrE5ncoCanopenRamp, LossOfTheMasterWithOption0LetsTheMotorRun) {
  lose_master(0);
  run(2s);
  EXPECT_NEAR(hz(), 50, 0.01);
}

TEST_F(OiFrE5ncoCanopenRamp, LossOfTheMasterWithOption2LetsTheMotorCoast) {
  lose_master(2);
  EXPECT_FALSE(running());
  EXPECT_EQ(hz(), 0);
  EXPECT_GT(shaft_rpm(), 1000);
  EXPECT_TRUE(inverter_->alarm_name().empty());
}

TEST_F(OiFrE5ncoCanopenRamp, LossOfTheMasterWithOption3StopsTheMotorQuickly) {
  download(0x604a, 2, 1, 2);
  download(0x6049, 2, 4, 2);
  lose_master(3);
  EXPECT_NEAR(seconds_to(25, 5), 0.5, 0.05);
  run(1s);
  EXPECT_FALSE(running());
  EXPECT_EQ(mode(), port::OperationMode::kNetwork);
}

}  // namespace
}  // namespace vinv::test
