#include "motor_model/drive/detection_outputs.hpp"

#include <gtest/gtest.h>

namespace vinv::drive {
namespace {

TEST(DetectionOutputs, UpToFrequencyIsABandOfTheSetFrequency) {
  DetectionOutputs d;
  DriveSettings s;
  s.up_to_frequency_percent = 10;
  const auto su = [&](double ramp, double set, bool running = true) {
    d.step(0.001, s,
           {.running = running, .ramp_frequency_hz = ramp, .output_frequency_hz = ramp, .set_frequency_hz = set});
    return d.up_to_frequency();
  };
  EXPECT_FALSE(su(44.9, 50));
  EXPECT_TRUE(su(45, 50));
  EXPECT_TRUE(su(55, 50));
  EXPECT_FALSE(su(55.1, 50));
  EXPECT_TRUE(su(-50, -50));
  EXPECT_FALSE(su(50, -50));
  EXPECT_FALSE(su(50, 50, false));
  s.up_to_frequency_percent = 0;
  EXPECT_TRUE(su(50, 50));
  EXPECT_FALSE(su(49.99, 50));
}

TEST(DetectionOutputs, FrequencyDetectionHasALevelPerDirection) {
  DetectionOutputs d;
  DriveSettings s;
  s.detect_forward_hz = 6;
  s.detect_reverse_hz = 20;
  const auto fu = [&](double hz, bool running = true) {
    d.step(0.001, s, {.running = running, .ramp_frequency_hz = hz, .output_frequency_hz = hz, .set_frequency_hz = hz});
    return d.frequency_detected();
  };
  EXPECT_FALSE(fu(5.99));
  EXPECT_TRUE(fu(6));
  EXPECT_FALSE(fu(-19.99));
  EXPECT_TRUE(fu(-20));
  EXPECT_FALSE(fu(30, false));
}

TEST(DetectionOutputs, CurrentDetectionComesAfterItsTimeAndHoldsAShortPeak) {
  DetectionOutputs d;
  DriveSettings s;
  s.rated_current_a_rms = 4;
  s.current_detect_percent = 150;
  s.current_detect_s = 0.05;
  const auto run = [&](int ms, double a) {
    for (int i = 0; i < ms; ++i) d.step(0.001, s, {.running = true, .current_a_rms = a});
    return d.current_detected();
  };
  EXPECT_FALSE(run(50, 6));
  EXPECT_FALSE(run(1, 5.9));
  EXPECT_FALSE(run(50, 6));
  EXPECT_TRUE(run(1, 6));
  EXPECT_TRUE(run(99, 1));
  EXPECT_FALSE(run(1, 1));
}

TEST(DetectionOutputs, ZeroCurrentComesAfterItsTime) {
  DetectionOutputs d;
  DriveSettings s;
  s.rated_current_a_rms = 4;
  s.zero_current_percent = 5;
  s.zero_current_s = 0.5;
  const auto run = [&](int ms, double a) {
    for (int i = 0; i < ms; ++i) d.step(0.001, s, {.running = true, .current_a_rms = a});
    return d.zero_current();
  };
  EXPECT_FALSE(run(500, 0.2));
  EXPECT_TRUE(run(1, 0.2));
  EXPECT_FALSE(run(1, 0.21));
}

TEST(DetectionOutputs, CurrentDetectionNeedsARunningDrive) {
  DetectionOutputs d;
  DriveSettings s;
  s.rated_current_a_rms = 4;
  d.step(0.001, s, {.running = false, .current_a_rms = 8});
  EXPECT_FALSE(d.current_detected());
  d.step(0.001, s, {.running = true, .current_a_rms = 8});
  EXPECT_TRUE(d.current_detected());
}

}  // namespace
}  // namespace vinv::drive
