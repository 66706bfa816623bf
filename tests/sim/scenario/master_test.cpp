// `via:`: the same words through a master, and raw frames.
#include <deque>

#include "sim/scenario/protocol_masters.hpp"
#include "sim/transports/memory_link.hpp"
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
  void archive_wires(Archive&) override {}
  void archive_state(Archive& a) override { a.fail("an echo cannot be saved"); }

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

// What is wrong with a word of a master is told when the file is read, with what is allowed.
TEST(ProtocolMasters, AValueThatAMasterCannotSayIsRefusedAtReading) {
  struct Case {
    const char* step;
    const char* message;
  };
  for (const Case& c : {
           Case{"{ via: modbus, run: forwards }", "run is \"forwards\"; allowed: forward, reverse."},
           Case{"{ via: ethernet-ip, monitor: { output_frequenzy: 1 Hz } }",
                "there is no monitor \"output_frequenzy\"; allowed: output_frequency"},
           Case{"{ via: ethernet-ip, monitor: { output_frequency: 40 } }",
                "monitor output_frequency: \"40\" has no unit"},
           Case{"{ via: ethernet-ip, open: { role: owners } }",
                "open.role is \"owners\"; allowed: owner, input_only, listen_only."},
           Case{"{ via: ethernet-ip, open: { roll: owner } }", "unknown key \"roll\" in open; allowed: role"},
           Case{"{ via: ethernet-ip, open: { multiplier: 5 } }", "open.multiplier is \"5\"; allowed: 4, 8, 16"},
           Case{"{ via: ethernet-ip, request: { get: 0x2A/1 } }",
                "request.get is \"0x2A/1\"; allowed: class, instance and attribute, as 0x2A/1/114."},
           Case{"{ via: ethernet-ip, request: { data: 01 } }", "request has one of get, set and service"},
           Case{"{ via: ethernet-ip, output: 6 }", "output is \"6\"; allowed: bytes in hexadecimal"},
           Case{"{ via: ethernet-ip, input: { bytes: 61, mask: FFFF } }",
                "input.mask is \"FFFF\"; allowed: as many bytes"},
           Case{"{ via: ethernet-ip, idle: perhaps }", "idle is \"perhaps\"; allowed: on, off."},
           Case{"{ via: modbus, open: }", "the master modbus cannot say \"open\"; allowed: mode"},
           Case{"{ via: ethernet-ip, request: { service: 1, pat: 0x01/1 } }", "Did you mean \"path\"?"},
           Case{"{ via: ethernet-ip, run: forward }",
                "drive_1 is on no wire of the master ethernet-ip; allowed: modbus, modbus_tcp, canopen, canopen_sdo, "
                "canopen_402."},
       }) {
    LoadOptions load = testing::load_options();
    load.masters = protocol_masters();
    try {
      testing::read(std::string(testing::kHead) + "steps:\n  - " + c.step + "\n", load);
      ADD_FAILURE() << c.step;
    } catch (const ScenarioFileError& e) {
      EXPECT_NE(std::string(e.what()).find(c.message), std::string::npos) << c.step << "\n" << e.what();
      EXPECT_EQ(std::string(e.what()).find("?."), std::string::npos) << e.what();
    }
  }
}

TEST(ProtocolMasters, ADriveThatAMasterDoesNotReachIsToldAtReading) {
  LoadOptions load = testing::load_options();
  load.masters = protocol_masters();
  const auto told = [&](const std::string& drive, const std::string& step) {
    try {
      testing::read("# x\nplant: { drives: [{ " + drive + " }] }\nsteps:\n  - " + step + "\n", load);
    } catch (const ScenarioFileError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string a700 = "inverter: { model: FR-A740-1.5K }", wired = "{ via: modbus_tcp, run: forward }";
  EXPECT_EQ(told(a700, "{ via: ethernet-ip, run: forward }"), "");
  EXPECT_NE(told(a700, wired).find("drive_1 is on no wire of the master modbus_tcp; allowed: ethernet-ip, "),
            std::string::npos);
  EXPECT_NE(told(a700 + ", board: none", "{ via: ethernet-ip, run: forward }").find("; no master reaches it."),
            std::string::npos);
  EXPECT_EQ(told("board: { modbus_tcp: none }", "{ via: modbus, run: forward }"), "");
  EXPECT_NE(told("board: { modbus_tcp: none }", wired).find("; allowed: modbus, canopen, "), std::string::npos);
  EXPECT_NE(told("board: { network: none }", "{ via: canopen, run: forward }").find("; allowed: modbus, modbus_tcp."),
            std::string::npos);
}

TEST(ProtocolMasters, ASerialLineThatSomebodyOutsideHasIsNotTakenAway) {
  kernel::Scheduler scheduler;
  rig::PlantOptions options;
  options.catalogue = rig::shipped_catalogue();
  rig::Plant plant(rig::parse_plant_file("drives: [{ board: { node: 5 } }]\n", "p.yaml", options.catalogue), scheduler,
                   options);
  const auto refused = [&] {
    std::string out;
    for (const MasterKind& kind : protocol_masters())
      if (const auto made = kind.make({plant, 1, {}}); !made) out += std::string(kind.name) + ": " + made.error();
    return out;
  };
  EXPECT_EQ(refused(), "");
  auto [board, outside] = transports::make_memory_link(scheduler);
  plant.connect_serial(0, std::move(board));
  EXPECT_TRUE(refused().starts_with("modbus: serial line ")) << refused();
  EXPECT_EQ(refused().find("modbus_tcp: "), std::string::npos);
}

}  // namespace
}  // namespace vinv::scenario
