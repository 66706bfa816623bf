// Every fault word on every wire that has it, seen from our masters and from the motor.
#include "sim/rig/commands.hpp"
#include "tests/sim/masters/plant_bench.hpp"

namespace vinv::test {
namespace {

using masters::ModbusMasterSettings;
using masters::Word;
using rig::Json;

struct FaultBench : PlantBench {
  using PlantBench::PlantBench;
  void wire(const Json& value) {
    const auto done = rig::execute(plant, "wire", "mill", value);
    ASSERT_TRUE(done) << value << ": " << done.error().message;
  }
  std::string refusal(const Json& value) {
    const auto done = rig::execute(plant, "wire", "mill", value);
    return done ? "done" : done.error().message;
  }
  // One read of the status, and how many attempts it took; or the failure.
  std::string ask(masters::ModbusStation& master, Duration at_most = std::chrono::seconds(5)) {
    master.take_results();
    master.submit(now(), masters::ModbusRequest::read(5, 24000));
    std::vector<masters::ModbusResult> results;
    wait([&] { return !(results = master.take_results()).empty(); }, at_most);
    if (results.empty()) return "nothing";
    const auto& r = results.front();
    return (r.answer ? std::string("ok") : text_of(r.answer.error())) + " " + std::to_string(r.attempts);
  }
  std::string ask(masters::CanopenStation& master, Duration at_most = std::chrono::seconds(5)) {
    master.take_events();
    master.with_master(now(), [](auto& m) { m.transfer({5, 0x6041, 0, false, 0, 0}); });
    std::string outcome = "nothing";
    wait(
        [&] {
          for (const auto& e : master.take_events())
            if (e.sdo) outcome = e.sdo->value ? "ok" : text_of(e.sdo->value.error());
          return outcome != "nothing";
        },
        at_most);
    return outcome;
  }
  // How long a read takes.
  template <class Master>
  double ask_ms(Master& master) {
    const Instant before = now();
    EXPECT_TRUE(ask(master).starts_with("ok"));
    return to_seconds(now() - before) * 1000;
  }
};

// --- serial line ---

TEST(SerialFaults, ALostRequestOrAnswerIsAskedForAgain) {
  for (const char* of : {"own", "master"}) {
    FaultBench b;
    const auto master = b.serial_master();
    b.wire({{"drop", "on"}, {"nth", 2}, {"of", of}});
    EXPECT_EQ(b.ask(*master), "ok 1") << of;
    EXPECT_EQ(b.ask(*master), "ok 2") << of;
    EXPECT_EQ(b.ask(*master), "ok 1") << of;
  }
}

TEST(SerialFaults, CorruptedFramesAreFoundByTheirCrc) {
  FaultBench b;
  const auto master = b.serial_master();
  b.wire({{"corrupt", "on"}, {"of", "own"}});
  EXPECT_EQ(b.ask(*master), "damaged answer 3");
  b.wire("none");
  EXPECT_EQ(b.ask(*master), "ok 1");
  b.wire({{"corrupt", "on"}, {"of", "master"}});
  EXPECT_EQ(b.ask(*master), "no answer 3") << "the board is silent to a damaged request";
}

TEST(SerialFaults, DelayAndDuplicatesAreRiddenOut) {
  FaultBench b;
  const auto master = b.serial_master();
  b.ask(*master);
  const double before = b.ask_ms(*master);
  b.wire({{"delay", "60 ms"}, {"of", "own"}});
  EXPECT_NEAR(b.ask_ms(*master), before + 60, 3);
  b.wire("none");
  b.wire({{"duplicate", "on"}, {"of", "own"}});
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(b.ask(*master), "ok 1");
    b.run(milliseconds(20));
  }
  EXPECT_TRUE(master->take_results().empty());
}

TEST(SerialFaults, TruncatedAndSplitFramesAreDamaged) {
  FaultBench b;
  const auto master = b.serial_master();
  b.wire({{"truncate", 4}, {"nth", 1}, {"of", "own"}});
  EXPECT_EQ(b.ask(*master), "ok 2");
  // A gap of 3 ms is more than 1.5 characters at 9600 baud, and less than 3.5: the board discards the frame.
  b.wire("none");
  b.wire({{"split", "3 ms"}, {"of", "master"}});
  EXPECT_EQ(b.ask(*master), "no answer 3");
}

TEST(SerialFaults, TwoUnitsWithOneAddressGarbleEachOther) {
  FaultBench b;
  const auto master = b.serial_master();
  b.wire({{"duplicate_node", "on"}, {"port", "serial"}});
  EXPECT_EQ(b.ask(*master), "damaged answer 3");
  b.wire("none");
  EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(SerialFaults, SilenceOfTheMasterEndsWithItsTime) {
  FaultBench b;
  const auto master = b.serial_master();
  b.wire({{"silence", "on"}, {"for", "2 s"}});
  EXPECT_EQ(b.ask(*master), "no answer 3");
  b.run(milliseconds(600));
  EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(SerialFaults, ByChanceIsTheSameEachTime) {
  const auto story = [] {
    FaultBench b;
    const auto master = b.serial_master();
    b.wire({{"drop", "30 %"}, {"of", "master"}});
    std::string all;
    for (int i = 0; i < 20; ++i) all += b.ask(*master) + ", ";
    return all;
  };
  const std::string first = story();
  EXPECT_NE(first.find("ok 2"), std::string::npos) << first;
  EXPECT_EQ(first, story());
}

// --- TCP ---

TEST(TcpFaults, AHalfOpenConnectionTimesOutAndIsDialledAgain) {
  FaultBench b;
  const auto master = b.tcp_master({.timeout = milliseconds(200), .retries = 0});
  EXPECT_EQ(b.ask(*master), "ok 1");
  b.wire("half_open");
  EXPECT_EQ(b.ask(*master), "no answer 1");
  EXPECT_FALSE(master->connected());
  EXPECT_EQ(b.ask(*master), "no connection 0");
  b.run(masters::ModbusStation::kRedialDelay);
  EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(TcpFaults, ReorderedAnswersAreToldApartByTheirTransaction) {
  FaultBench b;
  const auto master = b.tcp_master({.timeout = milliseconds(50), .retries = 1});
  // The first answer comes behind the second, which is that of the retry.
  b.wire({{"reorder", "1 s"}, {"nth", 1}, {"of", "own"}, {"port", "tcp"}});
  EXPECT_EQ(b.ask(*master), "ok 2");
  b.run(milliseconds(10));
  EXPECT_TRUE(master->take_results().empty());
  EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(TcpFaults, AnswersInSingleBytesAreAssembled) {
  FaultBench b;
  const auto master = b.tcp_master();
  b.wire({{"split", "1 ms"}, {"of", "own"}, {"port", "tcp"}});
  EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(TcpFaults, DuplicateAnswersAreDropped) {
  FaultBench b;
  const auto master = b.tcp_master();
  b.wire({{"duplicate", "on"}, {"of", "own"}, {"port", "tcp"}});
  for (int i = 0; i < 5; ++i) EXPECT_EQ(b.ask(*master), "ok 1");
}

TEST(TcpFaults, EveryThirdRequestIsLost) {
  FaultBench b;
  const auto master = b.tcp_master({.timeout = milliseconds(100), .retries = 1});
  b.wire({{"drop", "on"}, {"every", 3}, {"times", 2}, {"of", "master"}, {"port", "tcp"}});
  std::string all;
  for (int i = 0; i < 7; ++i) all += b.ask(*master) + ", ";
  // Attempts 3 and 6 are lost, and no more than two.
  EXPECT_EQ(all, "ok 1, ok 1, ok 2, ok 1, ok 2, ok 1, ok 1, ");
}

// --- CAN ---

TEST(CanWireFaults, LostFramesTimeOut) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.wire({{"drop", "on"}, {"nth", 1}, {"id", "605"}});
  EXPECT_EQ(b.ask(*master), "no SDO answer");
  EXPECT_EQ(b.ask(*master), "ok");
}

TEST(CanWireFaults, DelayHoldsAnAnswerBack) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  const double before = b.ask_ms(*master);
  b.wire({{"delay", "40 ms"}, {"id", "585"}});
  EXPECT_NEAR(b.ask_ms(*master), before + 40, 2);
}

TEST(CanWireFaults, DuplicateAnswersAreDropped) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  b.wire({{"duplicate", "on"}, {"of", "own"}, {"port", "can"}});
  const auto frames = b.bus().stats(b.now()).frames;
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(b.ask(*master), "ok");
    b.run(milliseconds(5));
  }
  EXPECT_EQ(b.bus().stats(b.now()).frames - frames, 15u);
  EXPECT_TRUE(master->take_events().empty());
}

TEST(CanWireFaults, CorruptionAndErrorFramesCostTimeOnly) {
  for (const char* word : {"corrupt", "error_frame"}) {
    FaultBench b;
    const auto master = b.canopen_master();
    b.wire({{word, "on"}, {"port", "can"}});
    EXPECT_EQ(b.ask(*master), "ok") << word;
    EXPECT_GE(b.bus().stats(b.now()).error_frames, 2u) << word;
  }
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  const auto errors = b.bus().stats(b.now()).error_frames;
  b.wire("error_frame");
  b.run(milliseconds(10));
  EXPECT_EQ(b.bus().stats(b.now()).error_frames, errors + 1);
}

TEST(CanWireFaults, ReorderedPdosActInTheOtherOrder) {
  FaultBench b;
  const auto master = b.canopen_master();
  ASSERT_TRUE(b.tell(*master, "canopen", order(Word::kEnterNetwork)));
  b.wire({{"reorder", "1 s"}, {"nth", 1}, {"id", "205"}});
  // 10 Hz, then 20 Hz; on the wire the other way round.
  for (const unsigned hz : {10u, 20u}) {
    master->with_master(b.now(), [&](auto& m) {
      m.set_output(5, 1, 0, 2, 2);
      m.set_output(5, 1, 2, 2, hz * 100);
      m.send_output(5, 1);
    });
  }
  b.run(std::chrono::seconds(3));
  EXPECT_DOUBLE_EQ(b.signal("output_frequency"), 10);
}

TEST(CanWireFaults, AHeldFrameGoesWhenNoOtherComes) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  const double before = b.ask_ms(*master);
  b.wire({{"reorder", "30 ms"}, {"nth", 1}, {"id", "605"}});
  EXPECT_NEAR(b.ask_ms(*master), before + 30, 2);
}

TEST(CanWireFaults, BusOffOfTheBoardEndsWithTheRecovery) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  b.wire("bus_off");
  EXPECT_EQ(b.plant.can_line_of(b.mill())->controller(0).status().state, transports::CanState::kBusOff);
  b.run(milliseconds(100));
  EXPECT_EQ(b.ask(*master), "ok");
  // By the nth frame of the board.
  b.wire({{"bus_off", "on"}, {"nth", 2}});
  EXPECT_EQ(b.ask(*master), "ok");
  EXPECT_EQ(b.ask(*master), "no SDO answer");
  EXPECT_EQ(b.ask(*master), "ok");
}

// The board is error passive from its lone boot-up: after the collision the twin comes first, then the board.
TEST(CanWireFaults, ATwinCollidesWithTheBoardAndContradictsIt) {
  FaultBench b;
  const auto master = b.canopen_master();
  b.run(milliseconds(100));
  const auto errors = b.bus().stats(b.now()).error_frames;
  b.wire({{"duplicate_node", "on"}, {"port", "can"}});
  master->take_frames();
  EXPECT_EQ(b.ask(*master), "ok");
  b.run(milliseconds(10));
  EXPECT_EQ(b.bus().stats(b.now()).error_frames, errors + 1);
  EXPECT_EQ(b.bus().stats(b.now()).nodes, 3u);
  const auto frames = master->take_frames();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(read_be32(frames[0], 0), 0x585u);
  EXPECT_EQ(read_be32(frames[1], 0), 0x585u);
  EXPECT_NE(frames[0], frames[1]);
  b.wire("none");
  EXPECT_EQ(b.bus().stats(b.now()).nodes, 2u) << "the twin is gone";
  EXPECT_EQ(b.ask(*master), "ok");
}

TEST(CanWireFaults, SilenceOfTheMasterIsALossOfGuarding) {
  FaultBench b;
  const auto master = b.canopen_master();
  ASSERT_TRUE(b.tell(*master, "canopen", order(Word::kEnterNetwork)));
  master->with_master(b.now(), [](auto& m) {
    m.transfer({5, 0x100c, 0, true, 2, 100});
    m.transfer({5, 0x100d, 0, true, 1, 3});
    m.transfer({5, 0x6007, 0, true, 2, 2});  // output off
  });
  b.run(milliseconds(100));
  master->with_master(b.now(), [&](auto& m) { m.guard(b.now(), 5, milliseconds(100), 3); });
  ASSERT_TRUE(b.tell(*master, "canopen", order(Word::kReferenceHz, 20)));
  ASSERT_TRUE(b.tell(*master, "canopen", order(Word::kRunForward)));
  b.run(std::chrono::seconds(3));
  EXPECT_DOUBLE_EQ(b.signal("output_frequency"), 20);
  master->take_events();
  b.wire({{"silence", "on"}, {"for", "1 s"}});
  b.run(milliseconds(450));
  EXPECT_DOUBLE_EQ(b.signal("output_frequency"), 0);
  b.run(milliseconds(1000));
  std::string seen;
  for (const auto& e : master->take_events()) {
    if (e.kind == masters::CanopenEvent::Kind::kGuardLost) seen += "lost ";
    if (e.kind == masters::CanopenEvent::Kind::kGuardBack) seen += "back ";
    if (e.kind == masters::CanopenEvent::Kind::kEmergency) seen += std::to_string(e.emergency.manufacturer[0]) + " ";
  }
  EXPECT_NE(seen.find("31 "), std::string::npos) << seen;
  EXPECT_NE(seen.find("lost "), std::string::npos) << seen;
  EXPECT_NE(seen.find("back "), std::string::npos) << seen;
}

TEST(StationSilence, StopsWhatGoesOutAndWhatIsHeard) {
  FaultBench b;
  const auto can = b.canopen_master();
  const auto tcp = b.tcp_master({.timeout = milliseconds(100), .retries = 0});
  EXPECT_EQ(b.ask(*tcp), "ok 1");
  for (masters::Station* station :
       {static_cast<masters::Station*>(can.get()), static_cast<masters::Station*>(tcp.get())})
    station->set_silent(b.now(), true);
  EXPECT_EQ(b.ask(*can), "no SDO answer");
  EXPECT_EQ(b.ask(*tcp), "no answer 1");
  can->set_silent(b.now(), false);
  EXPECT_EQ(b.ask(*can), "ok");
}

// --- words ---

TEST(WireWords, MistakesAreRefusedWithWhatIsAllowed) {
  FaultBench b;
  EXPECT_NE(b.refusal({{"dorp", "on"}}).find("Did you mean \"drop\"?"), std::string::npos)
      << b.refusal({{"dorp", "on"}});
  EXPECT_NE(b.refusal({{"drop", "on"}, {"nth", 0}}).find("whole number from 1"), std::string::npos);
  EXPECT_NE(b.refusal({{"drop", "on"}, {"nth", 1}, {"every", 2}}).find("exclude"), std::string::npos);
  EXPECT_NE(b.refusal({{"drop", "120 %"}}).find("0 to 100 %"), std::string::npos);
  EXPECT_NE(b.refusal({{"delay", "5 Hz"}}).find("wrong unit"), std::string::npos);
  EXPECT_NE(b.refusal({{"error_frame", "on"}, {"port", "tcp"}}).find("fault of can"), std::string::npos);
  EXPECT_NE(b.refusal({{"truncate", 3}, {"port", "can"}}).find("fault of serial, tcp"), std::string::npos);
  EXPECT_NE(b.refusal({{"half_open", "on"}, {"drop", "on"}}).find("stands alone"), std::string::npos);
  EXPECT_NE(b.refusal({{"drop", "on"}, {"port", "usb"}}).find("can, serial, tcp"), std::string::npos);
  EXPECT_NE(b.refusal({{"nth", 3}}).find("lacks a fault"), std::string::npos);
  EXPECT_NE(b.refusal({{"drop", "10 %"}, {"share", "5 %"}}).find("share belongs to"), std::string::npos);
}

TEST(WireWords, FaultsThatLastAreListedAndEnd) {
  FaultBench b;
  const auto shown = [&](const Json& value) { return rig::execute(b.plant, "wire", "mill", value)->dump(); };
  const std::string all = shown({{"drop", "10 %"}, {"of", "own"}});
  for (const char* list : {"\"faults\":[{\"fault\":\"drop\"", "\"serial_faults\":[{", "\"tcp_faults\":[{"})
    EXPECT_NE(all.find(list), std::string::npos) << all;
  EXPECT_NE(shown({{"drop", "0 %"}, {"of", "own"}}).find("\"faults\":[],\"serial_faults\":[],\"tcp_faults\":[]"),
            std::string::npos);
  EXPECT_NE(shown({{"drop", "on"}, {"nth", 4}, {"port", "tcp"}}).find("\"nth\":4"), std::string::npos);
  EXPECT_EQ(shown({{"none", ""}, {"port", "tcp"}}), "{\"tcp_faults\":[]}");
}

TEST(WireWords, TheSameWordsWorkOnACommandLine) {
  FaultBench b;
  const auto done =
      rig::execute_words(b.plant, "wire", "mill", {"drop", "nth", "3", "for", "2", "s", "port", "serial"});
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NE(done->dump().find("\"nth\":3"), std::string::npos) << *done;
}

}  // namespace
}  // namespace vinv::test
