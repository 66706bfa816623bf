#include "motor_model/drive/brake_sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace vinv::drive {
namespace {

using Fault = BrakeSequence::Fault;

// A drive that ramps with 10 Hz/s to 20 Hz, and a brake that takes 0.2 s.
class Hoist {
 public:
  BrakeSequenceSettings settings;
  double current_percent = 140;
  bool brake_works = true;
  double hz = 0;

  Fault run(bool start, double seconds) {
    Fault fault = Fault::kNone;
    for (int i = 0; i < static_cast<int>(seconds * 1000 + 0.5); ++i) {
      const auto d = sequence_.step(0.001, settings, {start, hz, current_percent, open_});
      if (d.fault != Fault::kNone && fault == Fault::kNone) fault = d.fault;
      double target = start || d.run ? 20 : 0;
      if (d.most_hz >= 0) target = std::min(target, d.most_hz);
      hz += std::clamp(target - hz, -0.01, 0.01);
      if (sequence_.opening_requested() != open_ && brake_works && ++moved_ >= 200) {
        open_ = !open_;
        moved_ = 0;
      }
    }
    return fault;
  }
  bool asked() const { return sequence_.opening_requested(); }
  void let_fall() { open_ = false; }
  bool open() const { return open_; }

 private:
  BrakeSequence sequence_;
  bool open_ = false;
  int moved_ = 0;
};

TEST(BrakeSequence, TheBrakeOpensUnderTorqueAndTheRampGoesOnAfterwards) {
  Hoist h;
  h.run(true, 0.55);
  EXPECT_FALSE(h.asked());  // 3 Hz at 0.3 s, torque for 0.3 s
  h.run(true, 0.1);
  EXPECT_TRUE(h.asked());
  EXPECT_NEAR(h.hz, 3, 1e-6);
  h.run(true, 0.4);  // opens at 0.8 s, 0.3 s more
  EXPECT_NEAR(h.hz, 3, 1e-6);
  EXPECT_EQ(h.run(true, 3), Fault::kNone);
  EXPECT_NEAR(h.hz, 20, 1e-6);
}

TEST(BrakeSequence, TheBrakeClosesOnTheWayDownBeforeTheOutputEnds) {
  Hoist h;
  h.run(true, 4);
  h.run(false, 1.35);
  EXPECT_TRUE(h.asked());
  h.run(false, 0.1);  // below 6 Hz
  EXPECT_FALSE(h.asked());
  h.run(false, 0.3);
  EXPECT_NEAR(h.hz, 6, 0.05);  // waits for the brake
  EXPECT_FALSE(h.open());
  EXPECT_EQ(h.run(false, 2), Fault::kNone);
  EXPECT_EQ(h.hz, 0);
}

TEST(BrakeSequence, WithoutTorqueItGivesUp) {
  Hoist h;
  h.current_percent = 100;
  EXPECT_EQ(h.run(true, 1.9), Fault::kNone);
  EXPECT_EQ(h.run(true, 0.2), Fault::kNotAsked);
}

TEST(BrakeSequence, ABrakeThatSticksIsAFaultInBothDirections) {
  Hoist h;
  h.brake_works = false;
  EXPECT_EQ(h.run(true, 2.5), Fault::kNone);
  EXPECT_EQ(h.run(true, 0.3), Fault::kNotOpened);
  Hoist down;
  down.run(true, 4);
  down.brake_works = false;
  EXPECT_EQ(down.run(false, 3.2), Fault::kNone);
  EXPECT_EQ(down.run(false, 0.4), Fault::kNotClosed);
}

TEST(BrakeSequence, ABrakeThatFallsInIsAFault) {
  Hoist h;
  h.run(true, 4);
  h.let_fall();
  EXPECT_EQ(h.run(true, 0.01), Fault::kClosed);
}

TEST(BrakeSequence, WithoutItsReportTheTimesAlone) {
  Hoist h;
  h.settings.completion = false;
  h.brake_works = false;
  EXPECT_EQ(h.run(true, 4), Fault::kNone);
  EXPECT_NEAR(h.hz, 20, 1e-6);
  EXPECT_EQ(h.run(false, 4), Fault::kNone);
  EXPECT_EQ(h.hz, 0);
}

}  // namespace
}  // namespace vinv::drive
