// The three tables of FR-A7NE manual 4.5.1: at the occurrence, after Pr.500, at removal, for every Pr.502.
#include <gtest/gtest.h>

#include <string>

#include "motor_model/inverter/a700/communication_error.hpp"

namespace vinv::inverter::a700 {
namespace {

using Alarm = CommunicationError::Alarm;

// A line of ticks of 100 ms; the motor runs until it has been told to stop for ramp_s.
class Story {
 public:
  explicit Story(int pr502, double pr500_s = 1, double ramp_s = 2) : ramp_s_(ramp_s) {
    in_.stop_mode = pr502;
    in_.wait_s = pr500_s;
    in_.line_acts = true;
    in_.running = true;
  }
  void line(bool lost) { in_.line_lost = lost; }
  void option(bool failed) { in_.option_failed = failed; }
  void external() { in_.line_acts = false; }
  // "go", "slow" (decelerating by the error), "stop" (stopped by it), then what is shown: E.OP3!, E.OP3, E.3!
  std::string after(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 10 + 0.5); ++i) {
      const Alarm alarm = error_.step(0.1, in_);
      occurred += error_.occurred() ? 1 : 0;
      if (alarm != Alarm::kNone && alarm_ == Alarm::kNone) alarm_ = alarm;
      if (alarm_ != Alarm::kNone) in_.running = false;
      if (error_.stopping()) {
        stopped_s_ += 0.1;
        if (stopped_s_ >= ramp_s_) in_.running = false;
      } else if (alarm_ == Alarm::kNone) {
        stopped_s_ = 0;
        in_.running = true;
      }
    }
    std::string out = alarm_ != Alarm::kNone ? "trip" : !error_.stopping() ? "go" : in_.running ? "slow" : "stop";
    if (alarm_ == Alarm::kLine) out += " E.OP3!";
    if (alarm_ == Alarm::kOption) out += " E.3!";
    if (error_.shown()) out += " E.OP3";
    return out;
  }
  int occurred = 0;

 private:
  CommunicationError error_;
  CommunicationError::Input in_;
  Alarm alarm_ = Alarm::kNone;
  double ramp_s_;
  double stopped_s_ = 0;
};

TEST(CommunicationError, ALostLineLetsTheDriveGoOnUntilPr500HasElapsed) {
  for (int pr502 : {0, 1, 2, 3}) {
    Story s(pr502);
    s.line(true);
    EXPECT_EQ(s.after(0.9), "go") << pr502;
    s.line(false);  // back within the time: no communication error
    EXPECT_EQ(s.after(5), "go") << pr502;
    s.line(true);
    EXPECT_EQ(s.after(0.9), "go") << pr502;
    EXPECT_EQ(s.occurred, 2) << pr502;
  }
}

TEST(CommunicationError, AfterPr500TheLineActsAsPr502Says) {
  const std::string at_once[] = {"trip E.OP3!", "slow", "slow", "go"};
  const std::string later[] = {"trip E.OP3!", "trip E.OP3!", "stop E.OP3", "go"};
  for (int pr502 : {0, 1, 2, 3}) {
    Story s(pr502);
    s.line(true);
    EXPECT_EQ(s.after(1.3), at_once[pr502]) << pr502;
    EXPECT_EQ(s.after(5), later[pr502]) << pr502;
    EXPECT_EQ(s.occurred, 1) << pr502;
  }
}

TEST(CommunicationError, WhenTheLineComesBackOnlyPr502Is2Restarts) {
  const std::string after[] = {"trip E.OP3!", "trip E.OP3!", "go", "go"};
  for (int pr502 : {0, 1, 2, 3}) {
    Story s(pr502);
    s.line(true);
    s.after(6);
    s.line(false);
    EXPECT_EQ(s.after(1), after[pr502]) << pr502;
  }
}

TEST(CommunicationError, BackDuringTheDecelerationOnlyPr502Is2GoesOnFromThere) {
  Story restarts(2);
  restarts.line(true);
  EXPECT_EQ(restarts.after(2), "slow");
  restarts.line(false);
  EXPECT_EQ(restarts.after(0.1), "go");
  Story stays(1);
  stays.line(true);
  EXPECT_EQ(stays.after(2), "slow");
  stays.line(false);
  EXPECT_EQ(stays.after(0.1), "slow");
  EXPECT_EQ(stays.after(3), "trip E.OP3!");
}

TEST(CommunicationError, TheOptionItselfActsAtOnceAndStaysStopped) {
  for (int pr502 : {0, 1, 2, 3}) {
    Story s(pr502);
    s.option(true);
    const bool coasts = pr502 == 0 || pr502 == 3;
    EXPECT_EQ(s.after(0.3), coasts ? "trip E.3!" : "slow") << pr502;
    s.option(false);
    EXPECT_EQ(s.after(5), "trip E.3!") << pr502;
    EXPECT_EQ(s.occurred, 0);
  }
}

TEST(CommunicationError, OutsideNetworkOperationALostLineIsOnlyCounted) {
  Story s(0, 0);
  s.external();
  s.line(true);
  EXPECT_EQ(s.after(5), "go");
  EXPECT_EQ(s.occurred, 1);
}

TEST(CommunicationError, WithPr500Is0TheErrorIsRecognisedAtOnce) {
  Story s(0, 0);
  s.line(true);
  EXPECT_EQ(s.after(0.1), "trip E.OP3!");
}

TEST(CommunicationError, AResetDoesNotCountTheSameLossAgain) {
  CommunicationError e;
  CommunicationError::Input in{.line_lost = true};
  e.step(0.001, in);
  EXPECT_TRUE(e.occurred());
  e.reset();
  e.step(0.001, in);
  EXPECT_FALSE(e.occurred());
}

}  // namespace
}  // namespace vinv::inverter::a700
