// Every check, passing and failing; time, waiting, tracks, repeat; trips.
#include <algorithm>
#include <fstream>

#include "sim/kernel/virtual_clock.hpp"
#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

using testing::failures;
using testing::kHead;
using testing::kRunning;
using testing::only_failure;
using testing::read;
using testing::run;
using testing::run_steps;

struct Case {
  const char* step;      // of the running drive
  const char* expected;  // of the check that fails; empty: it passes
};

void expect_outcome(const Case& c) {
  const RunResult r = run_steps(std::string("  - ") + c.step + "\n");
  if (*c.expected == '\0') {
    EXPECT_EQ(r.verdict, Verdict::kPassed) << c.step << "\n" << failures(r);
    EXPECT_GE(r.checks.size(), 1u) << c.step;
    return;
  }
  EXPECT_EQ(r.verdict, Verdict::kFailed) << c.step;
  const CheckResult& failed = only_failure(r);
  EXPECT_EQ(failed.what + " | " + failed.expected + " | " + failed.seen, c.expected) << c.step;
  EXPECT_EQ(failed.where.line, 12) << c.step;
}

TEST(Check, AValueWithToleranceBoundOrRange) {
  for (const Case& c : {
           Case{"check: { output_frequency: 20 Hz +- 0.1 Hz }", ""},
           Case{"check: { output_frequency: 20 Hz, tolerance: 1 % }", ""},
           Case{"check: { output_frequency: 19 Hz .. 21 Hz }", ""},
           Case{"check: { output_frequency: above 19 Hz }", ""},
           Case{"check: { output_frequency: \">= 19 Hz\" }", ""},
           Case{"check: { output_frequency: < 21 Hz }", ""},
           Case{"check: output_frequency > 19 Hz", ""},
           Case{"{ after: 100 ms, check: { set_frequency: 21 Hz +- 0.1 Hz } }",
                "check: set_frequency | 21 Hz +- 0.1 Hz | 20 Hz"},
       })
    expect_outcome(c);
  const RunResult r = run_steps("  - check: { dc_link: below 500 V }\n");
  EXPECT_EQ(only_failure(r).expected, "below 500 V");
  EXPECT_TRUE(only_failure(r).seen.ends_with(" V")) << only_failure(r).seen;
}

TEST(Check, StatesTextsTerminalsAndParameters) {
  for (const Case& c : {
           Case{"check: running", ""},
           Case{"check: not stopped", ""},
           Case{"check: { running: on, tripped: off, alarm: none, mode: EXT }", ""},
           Case{"check: { terminals: { STF: on, STR: off, RUN: on } }", ""},
           Case{"check: { parameters: { Pr.7: 0.5 } }", ""},
           Case{"check: stopped", "check: stopped | on | off"},
           Case{"check: { mode: PU }", "check: mode | PU | EXT"},
           Case{"check: { display: E.OV3 }", "check: display | E.OV3 | 20.00"},
           Case{"check: { terminals: { RUN: off } }", "check: RUN | off | on"},
           Case{"check: { parameters: { Pr.7: 0.6 } }", "check: Pr.7 | 0.6 | 0.5"},
       })
    expect_outcome(c);
}

TEST(Reached, InTimeNotTooEarlyAndForStates) {
  for (const Case& c : {
           Case{"reached: { output_frequency: 20 Hz +- 0.1 Hz, within: 10 ms }", ""},
           Case{"reached: { running: on, within: 10 ms }", ""},
           Case{"reached: { output_frequency: 30 Hz, within: 100 ms }",
                "reached: output_frequency | 30 Hz within 100 ms | 20 Hz after 100 ms"},
           Case{"reached: { stopped: on, within: 50 ms }", "reached: stopped | on within 50 ms | off after 50 ms"},
           Case{"reached: { running: on, within: 1 s, not_before: 100 ms }",
                "reached: running | on within 1 s, not before 100 ms | on after 0 s"},
           Case{"reached: { terminals: { RUN: on }, within: 10 ms }", ""},
           Case{"reached: { terminals: { RUN: off }, within: 10 ms }",
                "reached: RUN | off within 10 ms | on after 10 ms"},
           Case{"reached: { parameters: { Pr.7: 0.5 }, within: 10 ms }", ""},
           Case{"reached: { parameters: { Pr.7: 0.6 }, within: 10 ms }",
                "reached: Pr.7 | 0.6 within 10 ms | 0.5 after 10 ms"},
       })
    expect_outcome(c);
  const RunResult stopped =
      run_steps("  - stop\n  - reached: { terminals: { RUN: off }, within: 180 ms, not_before: 160 ms }\n");
  EXPECT_EQ(stopped.verdict, Verdict::kPassed) << failures(stopped);
  // Passing through a value counts, although no sample may lie on it.
  const RunResult r = run_steps("  - stop\n  - reached: { output_frequency: 11.2345 Hz, within: 200 ms }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Ramp, TimeAndLinearityAreMeasured) {
  const auto ramp = [](const std::string& more) {
    return run_steps("  - stop\n  - ramp: { signal: output_frequency, from: 18 Hz, to: 8 Hz, " + more + " }\n");
  };
  EXPECT_EQ(ramp("time: 100 ms, tolerance: 2 ms").verdict, Verdict::kPassed);
  EXPECT_EQ(ramp("time: 100 ms, tolerance: 2 %, linearity: 0.1 Hz").verdict, Verdict::kPassed);
  const RunResult slow = ramp("time: 80 ms, tolerance: 2 ms");
  EXPECT_EQ(only_failure(slow).expected, "18 Hz to 8 Hz in 80 ms +- 2 ms");
  EXPECT_EQ(only_failure(slow).seen, "100 ms");
  // One after the other, the second from where the first has ended.
  const RunResult both = run_steps(
      "  - stop\n  - ramp: { signal: output_frequency, from: 18 Hz, to: 12 Hz, time: 60 ms, tolerance: 1 ms }\n"
      "  - ramp: { signal: output_frequency, from: 12 Hz, to: 8 Hz, time: 40 ms, tolerance: 1 ms, linearity: 0.1 Hz "
      "}\n");
  EXPECT_EQ(both.verdict, Verdict::kPassed) << failures(both);
  EXPECT_EQ(both.checks.size(), 3u);
  // An S pattern takes the same time and is not straight.
  const RunResult curved =
      run(std::string(kHead) + kRunning +
          "  - stop\n  - when: stopped\n  - mode: PU\n  - parameter: { Pr.29: 2, Pr.7: 2 }\n  - reference: 50 Hz\n"
          "  - key: FWD\n  - ramp: { signal: output_frequency, from: 2 Hz, to: 49 Hz, time: 1.6 s, tolerance: 400 ms, "
          "linearity: 0.5 Hz }\n");
  EXPECT_EQ(only_failure(curved).what, "linearity: output_frequency");
  const RunResult never =
      run_steps("  - ramp: { signal: output_frequency, from: 30 Hz, to: 40 Hz, time: 100 ms, tolerance: 2 ms }\n");
  EXPECT_EQ(only_failure(never).seen, "no beginning at 30 Hz; 20 Hz after 5.302 s");
  const RunResult unfinished = run_steps(
      "  - stop\n  - ramp: { signal: output_frequency, from: 20 Hz, to: -5 Hz, time: 100 ms, tolerance: 2 ms }\n");
  EXPECT_TRUE(only_failure(unfinished).seen.starts_with("only 0 Hz after")) << only_failure(unfinished).seen;
}

TEST(Span, AlwaysAndNeverWatchEachTick) {
  const auto span = [](const std::string& s) {
    return run_steps("  - " + s + "\n    during: [ stop, when: stopped ]\n");
  };
  EXPECT_EQ(span("always: { output_frequency: at most 20.1 Hz }").verdict, Verdict::kPassed);
  EXPECT_EQ(span("never: { output_frequency: above 20.1 Hz }").verdict, Verdict::kPassed);
  EXPECT_EQ(span("never: tripped").verdict, Verdict::kPassed);
  const RunResult low = span("always: { output_frequency: above 10 Hz }");
  EXPECT_EQ(only_failure(low).seen, "10 Hz");
  EXPECT_EQ(only_failure(low).expected, "always output_frequency above 10 Hz");
  const RunResult band = span("never: { output_frequency: 9 Hz .. 11 Hz, running: on }");
  EXPECT_EQ(only_failure(band).expected, "never output_frequency 9 Hz .. 11 Hz and running on");
  EXPECT_EQ(only_failure(band).seen, "11 Hz, on");
  // The run goes on after it: the story was told to its end.
  EXPECT_GT(to_seconds(band.end - only_failure(band).at), 0.05);
}

TEST(Span, LastsAsLongAsItSays) {
  const RunResult timed = run_steps("  - always: running\n    during: 300 ms\n  - stop\n  - when: stopped\n");
  EXPECT_EQ(timed.verdict, Verdict::kPassed) << failures(timed);
  const RunResult to_the_end = run_steps("  - always: running\n  - stop\n  - when: stopped\n");
  EXPECT_EQ(only_failure(to_the_end).expected, "always running on");
  EXPECT_EQ(only_failure(to_the_end).seen, "off");
}

TEST(Span, OvershootAndMonotonyAreMeasured) {
  const auto span = [](const std::string& s) {
    return run_steps("  - " + s +
                     "\n    during:\n      - reference: 30 Hz\n      - when: at_reference\n      - after: 1 s\n");
  };
  EXPECT_EQ(span("overshoot: { output_frequency: 30 Hz, at_most: 0.1 Hz }").verdict, Verdict::kPassed);
  EXPECT_EQ(span("rising: output_frequency").verdict, Verdict::kPassed);
  const RunResult over = span("overshoot: { output_frequency: 25 Hz, at_most: 1 Hz }");
  EXPECT_EQ(only_failure(over).expected, "at most 1 Hz beyond 25 Hz");
  const RunResult falling = span("falling: output_frequency");
  EXPECT_EQ(only_failure(falling).expected, "only falls");
  EXPECT_EQ(span("falling: { output_frequency: 15 Hz }").verdict, Verdict::kPassed);
}

TEST(Span, FollowsATableOverTime) {
  const std::string path = ::testing::TempDir() + "follows.csv";
  // The ramp down from 20 Hz takes 0.2 s; what the last row does not reach is not compared.
  std::ofstream(path) << "# a ramp\ntime_s,output_frequency Hz,drive_1.output_current A\n0,20,1\n0.1,10,1\n0.15,5,1\n";
  const std::string follows = "  - stop\n  - follows: { file: " + path + ", output_frequency: ";
  const RunResult good = run_steps(follows + "0.15 Hz, output_current: 5 A }\n    during: 1 s\n");
  EXPECT_EQ(good.verdict, Verdict::kPassed) << failures(good);
  EXPECT_NE(good.checks.back().seen.find("of the tolerance of output_"), std::string::npos) << good.checks.back().seen;
  const RunResult close = run_steps(follows + "0.01 Hz, begin: 1 ms }\n    during: 1 s\n");
  const CheckResult& failure = only_failure(close);
  EXPECT_NE(failure.expected.find("+- 0.01 Hz at 0.0"), std::string::npos) << failure.expected;
  // Begun in the middle of the table, it expects 10 Hz at once.
  const RunResult early = run_steps(follows + "0.15 Hz, begin: 100 ms }\n    during: 1 s\n");
  EXPECT_EQ(only_failure(early).expected.substr(0, 20), "output_frequency 9.9");
  // A span that never meets the table compares nothing.
  const RunResult beyond = run_steps(follows + "0.15 Hz, begin: 10 s }\n    during: 1 s\n");
  EXPECT_EQ(only_failure(beyond).seen, "none");
}

TEST(Trip, IsExpectedWithWhatGoesWithIt) {
  const RunResult r = run_steps(
      "  - fault: E.OHT\n"
      "  - trip: { code: E.OHT, within: 100 ms, running: off, tripped: on, display: E.OHT, terminals: { ABC: on }, "
      "cause: injected }\n"
      "  - stop\n  - reset\n  - when: ready\n  - check: { alarm: none }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Trip, WhatGoesWithItMayFollowWithinATenthOfASecond) {
  // The motor coasts from 600 rpm: a few milliseconds for 20 rpm, more than 100 ms for all.
  const std::string trip = "  - fault: E.OHT\n  - trip: { code: E.OHT, within: 1 s, speed: below ";
  const RunResult soon = run_steps(trip + "575 rpm }\n");
  EXPECT_EQ(soon.verdict, Verdict::kPassed) << failures(soon);
  EXPECT_EQ(only_failure(run_steps(trip + "5 rpm }\n")).what, "trip: speed");
}

TEST(Trip, OfAnotherDriveIsNotTheOneThatIsExpected) {
  const RunResult r =
      run("# Two drives.\nplant:\n  drives:\n"
          "    - { name: a, inverter: { model: FR-E540-0.75K } }\n"
          "    - { name: b, inverter: { model: FR-E540-0.75K } }\n"
          "tracks:\n"
          "  waits:\n    - { drive: a, when: ready, trip: { code: E.OHT, within: 1 s } }\n"
          "  trips:\n    - { drive: b, when: ready }\n    - { drive: b, after: 10 ms, fault: E.OHT }\n");
  EXPECT_EQ(only_failure(r).what, "no unexpected trip");
  EXPECT_EQ(only_failure(r).drive, "b");
}

TEST(Reached, ARangeIsReachedInsideIt) {
  const RunResult in = run_steps("  - stop\n  - reached: { output_frequency: 9 Hz .. 11 Hz, within: 1 s }\n");
  EXPECT_EQ(in.verdict, Verdict::kPassed) << failures(in);
  const RunResult out = run_steps("  - reached: { output_frequency: 21 Hz .. 22 Hz, within: 100 ms }\n");
  EXPECT_EQ(only_failure(out).what, "reached: output_frequency");
}

TEST(Trip, ThatDoesNotComeOrLooksDifferentFails) {
  const RunResult none = run_steps("  - trip: { code: E.OV3, within: 100 ms }\n");
  EXPECT_EQ(only_failure(none).expected, "E.OV3 within 100 ms");
  EXPECT_EQ(only_failure(none).seen, "no alarm");
  const RunResult wrong = run_steps("  - fault: E.OHT\n  - trip: { code: E.OHT, within: 1 s, running: on }\n");
  EXPECT_EQ(only_failure(wrong).what, "trip: running");
  EXPECT_EQ(only_failure(wrong).seen, "off");
  const RunResult cause = run_steps("  - fault: E.OHT\n  - trip: { code: E.OHT, within: 1 s, cause: DC link }\n");
  EXPECT_EQ(only_failure(cause).what, "trip: cause");
  EXPECT_NE(only_failure(cause).cause, "");
}

TEST(Trip, ThatNobodyExpectsFailsTheRun) {
  const RunResult r = run_steps("  - fault: E.OHT\n  - after: 1 s\n  - check: running\n");
  EXPECT_EQ(only_failure(r).what, "no unexpected trip");
  EXPECT_EQ(only_failure(r).seen, "E.OHT");
  EXPECT_NE(only_failure(r).cause.find("injected"), std::string::npos);
  const RunResult other = run_steps("  - fault: E.OHT\n  - trip: { code: E.OV3, within: 1 s }\n");
  EXPECT_EQ(only_failure(other).what, "no unexpected trip");
  const RunResult allowed =
      run(std::string(kHead) + "allow_trips: [E.OHT]\n" + kRunning + "  - fault: E.OHT\n  - after: 1 s\n");
  EXPECT_EQ(allowed.verdict, Verdict::kPassed) << failures(allowed);
}

TEST(Failure, TellsWhatWhenExpectedSeenCauseAndTheEventsBefore) {
  const RunResult r = run_steps("  - fault: E.OHT\n  - after: 1 s\n");
  const std::string text = failure_text(r, only_failure(r));
  EXPECT_NE(text.find("test.yaml: at "), std::string::npos) << text;
  EXPECT_NE(text.find(" drive_1: no unexpected trip\n  expected  no alarm\n  seen      E.OHT\n  alarm     "),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("  before    "), std::string::npos) << text;
  EXPECT_NE(text.find("drive_1: fault: E.OHT\n"), std::string::npos) << text;
  EXPECT_NE(text.find("drive_1: trip E.OHT: "), std::string::npos) << text;
}

// --- time and order ---

TEST(Time, StepsBeginAtTheirTimeAndAfterOneAnother) {
  const RunResult r = run(std::string(kHead) +
                          "steps:\n  - { at: 2 s, note: first }\n  - { after: 250 ms, note: second }\n"
                          "  - { after: 1500 us, note: third }\n");
  ASSERT_EQ(r.verdict, Verdict::kPassed) << failures(r);
  std::vector<std::int64_t> at;
  for (const Event& e : r.events)
    if (e.kind == Event::Kind::kNote) at.push_back(to_ns(e.at) / 1000);
  EXPECT_EQ(at, (std::vector<std::int64_t>{2'000'000, 2'250'000, 2'251'500}));
}

TEST(Time, ATimeThatIsOverFails) {
  const RunResult r = run(std::string(kHead) + "steps:\n  - at: 2 s\n  - { at: 1 s, note: late }\n");
  EXPECT_EQ(only_failure(r).seen, "it is 2.000 s already");
}

TEST(Time, AConditionThatDoesNotComeInTimeFails) {
  const RunResult r = run_steps("  - { when: output_frequency > 30 Hz, within: 300 ms, stop: }\n");
  EXPECT_EQ(only_failure(r).what, "when: output_frequency");
  EXPECT_EQ(only_failure(r).expected, "> 30 Hz within 300 ms");
  EXPECT_EQ(only_failure(r).seen, "20 Hz");
}

TEST(Time, AScenarioThatWaitsForEverEndsAtItsLimit) {
  const RunResult r = run(std::string(kHead) + kRunning + "  - { when: output_frequency > 30 Hz, stop: }\n");
  EXPECT_EQ(only_failure(r).what, "limit");
  EXPECT_EQ(only_failure(r).expected, "the end within 20 s");
  EXPECT_EQ(only_failure(r).seen, "at \"stop\"");
  EXPECT_EQ(to_seconds(r.end), 20);
}

TEST(Time, ALoopInWhichNoTimePassesIsStopped) {
  const RunResult r = run(std::string(kHead) + "steps:\n  - repeat: { times: 1000000, steps: [ { note: again } ] }\n");
  EXPECT_EQ(only_failure(r).seen, "100000 steps at one instant");
}

TEST(Order, WhatWasJustDoneIsLookedAtFromTheNextTickOn) {
  const RunResult r =
      run_steps("  - reference: 10 Hz\n  - when: at_reference\n    check: { output_frequency: 10 Hz +- 0.1 Hz }\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Order, RepeatsAndTracksRunAsWritten) {
  const RunResult r = run(std::string(kHead) +
                          "steps:\n"
                          "  - repeat:\n"
                          "      times: 2\n"
                          "      steps:\n"
                          "        - { after: 100 ms, note: a }\n"
                          "        - repeat: { times: 2, steps: [ { after: 10 ms, note: b } ] }\n"
                          "tracks:\n"
                          "  other:\n"
                          "    - { at: 115 ms, note: c }\n"
                          "    - repeat: { each: { n: [x, y] }, steps: [ { after: 20 ms, note: $n } ] }\n");
  ASSERT_EQ(r.verdict, Verdict::kPassed) << failures(r);
  std::string notes;
  for (const Event& e : r.events)
    if (e.kind == Event::Kind::kNote) notes += e.text;
  EXPECT_EQ(notes, "abcbxyabb");
}

TEST(Order, ASpanInsideARepeatInsideASpanEndsEachTime) {
  const RunResult r = run(std::string(kHead) + kRunning +
                          "  - always: running\n"
                          "    during:\n"
                          "      - repeat:\n"
                          "          times: 3\n"
                          "          steps:\n"
                          "            - always: { output_frequency: below 21 Hz }\n"
                          "              during: 20 ms\n"
                          "            - after: 10 ms\n");
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
  EXPECT_EQ(r.checks.size(), 4u);
}

TEST(Refused, AnActionThatTheDriveRefusesFailsUnlessItIsExpected) {
  const RunResult r = run_steps("  - parameter: { Pr.7: 2.0 }\n");
  EXPECT_EQ(only_failure(r).expected, "done");
  EXPECT_NE(only_failure(r).seen.find("PU"), std::string::npos) << only_failure(r).seen;
  EXPECT_EQ(run_steps("  - { parameter: { Pr.7: 2.0 }, refused: yes }\n").verdict, Verdict::kPassed);
  const RunResult taken = run_steps("  - { reference: 10 Hz, refused: yes }\n");
  EXPECT_EQ(only_failure(taken).expected, "refused");
  EXPECT_EQ(only_failure(taken).seen, "done");
}

// --- live tolerance ---

TEST(LiveTolerance, WidensLimitsInLiveRunsOnly) {
  const std::string text = std::string(kHead) + "tolerance: { time: 200 ms, value: 10 % }\n" + kRunning +
                           "  - check: { output_frequency: 21 Hz +- 0.1 Hz }\n"
                           "  - stop\n  - reached: { stopped: on, within: 50 ms }\n";
  EXPECT_EQ(run(text).failures(), 2u);
  RunOptions live;
  live.live = true;
  const RunResult r = run(text, live);
  EXPECT_EQ(r.verdict, Verdict::kPassed) << failures(r);
}

TEST(Tracks, ARunThatIsTakenDownEarlyLeavesNothingToComeBackTo) {
  const Scenario s = read(std::string(kHead) +
                          "tracks:\n"
                          "  a:\n"
                          "    - { after: 10 ms, note: a1 }\n"
                          "    - { after: 10 ms, note: a2 }\n"
                          "  b:\n"
                          "    - { after: 10 ms, note: b1 }\n"
                          "    - { after: 10 s, note: b2 }\n");
  kernel::Scheduler scheduler;
  {
    rig::PlantOptions options;
    options.catalogue = rig::shipped_catalogue();
    rig::Plant plant(s.plant, scheduler, std::move(options));
    Runner runner(s, plant, {});
    plant.start();
    runner.start();
    kernel::VirtualClock(scheduler).run_until(scheduler.now() + std::chrono::milliseconds(15));
  }
  EXPECT_EQ(scheduler.waiting(), 0u);
}

}  // namespace
}  // namespace vinv::scenario
