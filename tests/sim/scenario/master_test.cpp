// `via:`: the same words through a master, and raw frames.
#include <deque>

#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

// Answers after three milliseconds, and echoes frames with their first byte plus one.
class EchoMaster : public Master {
 public:
  explicit EchoMaster(const MasterContext& context) : context_(context) {}
  std::vector<std::string_view> words() const override { return {"run", "stop"}; }
  void begin(Instant now, std::size_t drive, std::string_view word, const rig::Json& value) override {
    EXPECT_FALSE(begun_) << "one thing at a time";
    begun_ = now;
    const std::string name = context_.plant.drives()[drive]->spec.name;
    outcome_ = Outcome(Unexpected(std::string("exception 04")));
    if (word == "run" && value == "reverse") return;
    const auto done = rig::execute(context_.plant, word, name, value);
    outcome_ = done ? Outcome(*done) : Outcome(Unexpected(done.error().message));
  }
  std::optional<Outcome> poll(Instant now) override {
    if (!begun_ || now < *begun_ + std::chrono::milliseconds(3)) return {};
    begun_.reset();
    return outcome_;
  }
  void send_frame(Instant now, ByteView frame) override {
    Bytes echo(frame.begin(), frame.end());
    if (!echo.empty()) ++echo.front();
    frames_.push_back(echo);
    context_.on_wire({now, WireRecord::Kind::kSerial, "line", "master", 0, Bytes(frame.begin(), frame.end())});
  }
  std::vector<Bytes> take_frames() override { return std::exchange(frames_, {}); }

 private:
  MasterContext context_;
  std::optional<Instant> begun_;
  std::optional<Outcome> outcome_;
  std::vector<Bytes> frames_;
};

std::vector<MasterKind> kinds() {
  return {{"echo", {"run", "stop"}, [](const MasterContext& c) -> Result<std::unique_ptr<Master>, std::string> {
             return std::unique_ptr<Master>(std::make_unique<EchoMaster>(c));
           }}};
}

RunResult run_via(const std::string& steps) {
  LoadOptions load = testing::load_options();
  load.masters = kinds();
  const Scenario s =
      testing::read(std::string(testing::kHead) + "steps:\n  - { when: ready, reference: 20 Hz }\n" + steps, load);
  RunOptions options;
  options.masters = kinds();
  return run_virtual(s, rig::shipped_catalogue(), options);
}

TEST(Via, AWordGoesThroughTheMasterAndWaitsForItsAnswer) {
  const RunResult r =
      run_via("  - { via: echo, run: forward }\n  - { note: answered }\n  - { when: at_reference, within: 2 s }\n");
  ASSERT_EQ(r.verdict, Verdict::kPassed) << testing::failures(r);
  Instant asked{}, answered{};
  for (const Event& e : r.events) {
    if (e.text == "run: forward via echo") asked = e.at;
    if (e.text == "answered") answered = e.at;
  }
  EXPECT_EQ(answered - asked, std::chrono::milliseconds(3));
}

TEST(Via, TwoTracksTakeTurns) {
  const RunResult r = run_via(
      "  - repeat: { times: 3, steps: [ { via: echo, run: forward } ] }\n"
      "tracks:\n  other:\n    - when: ready\n    - repeat: { times: 3, steps: [ { via: echo, stop: } ] }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << testing::failures(r);
}

TEST(Via, ARefusalOfTheMasterFailsUnlessItIsExpected) {
  const RunResult r = run_via("  - { via: echo, run: reverse }\n");
  EXPECT_EQ(testing::only_failure(r).seen, "exception 04");
  EXPECT_EQ(run_via("  - { via: echo, run: reverse, refused: yes }\n").verdict, Verdict::kPassed);
}

TEST(Via, AWordThatTheMasterDoesNotKnowIsRefusedAtReading) {
  try {
    run_via("  - { via: echo, shaft: locked }\n");
    FAIL();
  } catch (const ScenarioFileError& e) {
    EXPECT_NE(std::string(e.what()).find("the master echo cannot say \"shaft\"; allowed: run, stop."),
              std::string::npos)
        << e.what();
  }
}

TEST(Frames, AreSentAndExpectedWithAMask) {
  const RunResult r = run_via(
      "  - { via: echo, send_frame: 05 06 11 }\n"
      "  - { via: echo, send_frame: 06 06 22 }\n"
      "  - { via: echo, expect_frame: { bytes: 06 06 00, mask: FF FF 00, within: 10 ms } }\n"
      "  - { via: echo, expect_frame: { bytes: 07 06 22, within: 10 ms } }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << testing::failures(r);
  EXPECT_EQ(r.recording.wire.size(), 2u);
}

TEST(Frames, InTheWrongOrderOrNotAtAllFail) {
  const RunResult order = run_via(
      "  - { via: echo, send_frame: 05 06 }\n"
      "  - { via: echo, send_frame: 06 06 }\n"
      "  - { via: echo, expect_frame: { bytes: 07 06, within: 10 ms } }\n"
      "  - { via: echo, expect_frame: { bytes: 06 06, within: 10 ms } }\n");
  EXPECT_EQ(testing::only_failure(order).seen, "no frame");
  const RunResult none = run_via("  - { via: echo, expect_frame: { bytes: 07, within: 10 ms } }\n");
  EXPECT_EQ(testing::only_failure(none).what, "expect_frame");
}

TEST(Frames, WhatWasHeardBeforeTheLastWordIsNoAnswerToIt) {
  const std::string first = "  - { via: echo, send_frame: 05 06 }\n  - after: 20 ms\n";
  const std::string expect = "  - { via: echo, expect_frame: { bytes: 06 06, within: 10 ms } }\n";
  EXPECT_EQ(run_via(first + expect).verdict, Verdict::kPassed);
  // A frame that is expected in between ends what was sent together.
  const std::string other =
      "  - { via: echo, send_frame: 07 01 }\n  - { via: echo, expect_frame: { bytes: 08 01, within: 10 ms } }\n";
  EXPECT_EQ(testing::only_failure(run_via(first + other + "  - { via: echo, send_frame: 08 02 }\n" + expect)).seen,
            "1 other frame: 09 02");
  EXPECT_EQ(testing::only_failure(run_via(first + "  - { via: echo, stop: }\n" + expect)).seen, "no frame");
}

TEST(Frames, ANotExpectedAnswerIsShownWithWhatCameLast) {
  const RunResult r = run_via(
      "  - { via: echo, send_frame: 01 AA }\n"
      "  - { via: echo, send_frame: 02 AA }\n"
      "  - { via: echo, send_frame: 03 AA }\n"
      "  - { via: echo, send_frame: 0F FF }\n"
      "  - { via: echo, expect_frame: { bytes: 07, within: 10 ms } }\n");
  EXPECT_EQ(testing::only_failure(r).seen, "4 other frames, at last 03 AA | 04 AA | 10 FF");
}

TEST(Frames, AFrameThatMustNotComeFailsWhenItComes) {
  const std::string send = "  - { via: echo, send_frame: 05 06 }\n";
  const RunResult absent = run_via(send + "  - { via: echo, expect_frame: { bytes: 07 06, absent_for: 10 ms } }\n");
  EXPECT_EQ(absent.verdict, Verdict::kPassed) << testing::failures(absent);
  ASSERT_FALSE(absent.checks.empty());
  EXPECT_EQ(absent.checks.back().seen, "none in 10 ms");
  const RunResult there = run_via(send + "  - { via: echo, expect_frame: { bytes: 06 06, absent_for: 10 ms } }\n");
  EXPECT_EQ(testing::only_failure(there).seen, "06 06 after 1 ms");
}

TEST(Frames, BadBytesAndMasksAreRefusedAtReading) {
  for (const char* step : {"{ via: echo, send_frame: 5 }", "{ via: echo, send_frame: 05 GG }",
                           "{ via: echo, expect_frame: { bytes: 05 06, mask: FF, within: 1 s } }",
                           "{ via: echo, expect_frame: { bytes: 05 06 } }",
                           "{ via: echo, expect_frame: { bytes: 05 06, within: 1 s, absent_for: 1 s } }"})
    EXPECT_THROW(run_via(std::string("  - ") + step + "\n"), ScenarioFileError) << step;
}

}  // namespace
}  // namespace vinv::scenario
