// NMT slave, boot-up, node guarding and life guarding. CiA DS-301 v4.0, 9.2.6.
#include "tests/option_boards/canopen/slave_bench.hpp"

namespace vinv::test {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

class CanopenSlaveNmt : public SlaveBench {
 protected:
  void to(NmtState state) {
    tell(state == NmtState::kOperational ? "000#0105" : state == NmtState::kStopped ? "000#0205" : "000#8005");
    ASSERT_EQ(slave.state(), state);
    commands.clear();
  }
};

TEST_F(CanopenSlaveNmt, BootUpMessageComesFirstAndOnce) {
  EXPECT_EQ(slave.state(), NmtState::kPreOperational);
  slave.handle_frame(now, sdo(0x40, 0x1000, 0));
  EXPECT_EQ(drain(), "705#00 585#4300100092010100");
  EXPECT_EQ(drain(), "");
}

TEST_F(CanopenSlaveNmt, EveryCommandInEveryState) {
  drain();
  struct Command {
    const char* frame;
    NmtCommand command;
    NmtState after;
    const char* sent;
  };
  const Command all[] = {{"000#0105", NmtCommand::kStart, NmtState::kOperational, ""},
                         {"000#0205", NmtCommand::kStop, NmtState::kStopped, ""},
                         {"000#8005", NmtCommand::kEnterPreOperational, NmtState::kPreOperational, ""},
                         {"000#8105", NmtCommand::kResetNode, NmtState::kPreOperational, "705#00"},
                         {"000#8205", NmtCommand::kResetCommunication, NmtState::kPreOperational, "705#00"}};
  for (const NmtState before : {NmtState::kPreOperational, NmtState::kOperational, NmtState::kStopped}) {
    for (const Command& c : all) {
      to(before);
      EXPECT_EQ(tell(c.frame), c.sent) << c.frame;
      EXPECT_EQ(slave.state(), c.after) << c.frame;
      ASSERT_EQ(commands.size(), 1u);
      EXPECT_EQ(commands[0], (std::pair{c.command, before}));
    }
  }
}

TEST_F(CanopenSlaveNmt, CommandsForAllCountAndForOthersDoNot) {
  drain();
  tell("000#0100");
  EXPECT_EQ(slave.state(), NmtState::kOperational);
  tell("000#8006");
  EXPECT_EQ(slave.state(), NmtState::kOperational);
  EXPECT_EQ(commands.size(), 1u);
}

TEST_F(CanopenSlaveNmt, UnknownCommandsAndWrongLengthsAreIgnored) {
  drain();
  for (const char* text : {"000#", "000#01", "000#010500", "000#0005", "000#0305", "000#FF05", "000#R2", "000#8305"}) {
    EXPECT_EQ(tell(text), "") << text;
  }
  CanFrame extended = can("000#0105");
  extended.extended = true;
  slave.handle_frame(now, extended);
  EXPECT_EQ(slave.state(), NmtState::kPreOperational);
  EXPECT_TRUE(commands.empty());
}

TEST_F(CanopenSlaveNmt, StoppedNodeAnswersGuardingOnly) {
  drain();
  tell("000#0205");
  EXPECT_EQ(read(0x1000, 0), "");
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("185#R8"), "");
  EXPECT_EQ(tell("705#R1"), "705#04");
}

TEST_F(CanopenSlaveNmt, PdosWorkInOperationalOnly) {
  drain();
  EXPECT_EQ(tell("205#01000200"), "");
  EXPECT_EQ(tell("185#R6"), "");
  EXPECT_TRUE(writes.empty());
  tell("000#0105");
  tell("205#01000200");
  EXPECT_EQ(writes, (std::vector<std::string>{"pdo 2000 0001", "pdo 2001 0002"}));
  EXPECT_EQ(tell("185#R6"), "185#010000000000");
}

TEST_F(CanopenSlaveNmt, ResetsGiveTheCommunicationObjectsTheirDefaults) {
  for (const char* reset : {"000#8105", "000#8205"}) {
    drain();
    EXPECT_EQ(write(0x1005, 0, 0x90, 4), "ok");
    EXPECT_EQ(write(0x1014, 0, 0x80000095, 4), "ok");
    EXPECT_EQ(write(0x100c, 0, 100, 2), "ok");
    EXPECT_EQ(write(0x100d, 0, 3, 1), "ok");
    map(0x1600, {0x20000010});
    map(0x1a00, {0x20010010});
    EXPECT_EQ(write(0x1800, 2, 254, 1), "ok");
    tell(reset);
    EXPECT_EQ(read(0x1005, 0), "=00000080");
    EXPECT_EQ(read(0x1014, 0), "=00000085");
    EXPECT_EQ(read(0x100c, 0), "=0000");
    EXPECT_EQ(read(0x100d, 0), "=00");
    EXPECT_EQ(read(0x1600, 0), "=02");
    EXPECT_EQ(read(0x1600, 2), "=20010010");
    EXPECT_EQ(read(0x1a00, 1), "=20000010");
    EXPECT_EQ(read(0x1800, 2), "=FD");
  }
}

TEST_F(CanopenSlaveNmt, NodeWithoutSupplyIsSilent) {
  drain();
  slave.stop();
  EXPECT_EQ(slave.state(), NmtState::kOff);
  EXPECT_EQ(tell("000#0100"), "");
  EXPECT_EQ(tell("700#R1"), "");
  EXPECT_EQ(tell("705#R1"), "");
  EXPECT_EQ(slave.next_deadline(), std::nullopt);
  slave.start(now, 7);
  EXPECT_EQ(drain(), "707#00");
}

class CanopenSlaveGuarding : public SlaveBench {};

TEST_F(CanopenSlaveGuarding, AnswersHaveTheStateAndATogglingBit) {
  drain();
  EXPECT_EQ(tell("705#R1"), "705#7F");
  EXPECT_EQ(tell("705#R1"), "705#FF");
  EXPECT_EQ(tell("705#R0"), "705#7F");
  tell("000#0105");
  EXPECT_EQ(tell("705#R1"), "705#85");
  tell("000#0205");
  EXPECT_EQ(tell("705#R1"), "705#04");
  EXPECT_EQ(tell("705#R1"), "705#84");
  EXPECT_EQ(tell("705#00"), "");  // another node's data under our identifier is no request
  EXPECT_EQ(tell("706#R1"), "");
}

TEST_F(CanopenSlaveGuarding, ToggleBitIsZeroAgainAfterAReset) {
  drain();
  EXPECT_EQ(tell("705#R1"), "705#7F");
  EXPECT_EQ(tell("000#8205"), "705#00");
  EXPECT_EQ(tell("705#R1"), "705#7F");
  EXPECT_EQ(tell("000#8105"), "705#00");
  EXPECT_EQ(tell("705#R1"), "705#7F");
  EXPECT_EQ(tell("705#R1"), "705#FF");
}

TEST_F(CanopenSlaveGuarding, LifeTimeIsGuardTimeTimesFactor) {
  drain();
  EXPECT_EQ(write(0x100c, 0, 100, 2), "ok");
  EXPECT_EQ(write(0x100d, 0, 3, 1), "ok");
  advance(10s);
  EXPECT_TRUE(guarding.empty());  // guarding begins with the first request
  tell("705#R1");
  advance(299ms);
  EXPECT_TRUE(guarding.empty());
  advance(1ms);
  EXPECT_EQ(guarding, std::vector<bool>{true});
  advance(10s);
  EXPECT_EQ(guarding.size(), 1u);  // once
}

TEST_F(CanopenSlaveGuarding, EachRequestRestartsTheLifeTimeAndEndsALoss) {
  drain();
  write(0x100c, 0, 100, 2);
  write(0x100d, 0, 2, 1);
  for (int i = 0; i < 20; ++i) {
    tell("705#R1");
    advance(199ms);
  }
  EXPECT_TRUE(guarding.empty());
  advance(1ms);
  EXPECT_EQ(guarding, std::vector<bool>{true});
  tell("705#R1");
  EXPECT_EQ(guarding, (std::vector<bool>{true, false}));
  advance(200ms);
  EXPECT_EQ(guarding, (std::vector<bool>{true, false, true}));
}

TEST_F(CanopenSlaveGuarding, NewLifeTimeOfALostMasterCountsFromItsNextRequest) {
  drain();
  write(0x100c, 0, 100, 2);
  write(0x100d, 0, 1, 1);
  tell("705#R1");
  advance(100ms);
  EXPECT_EQ(guarding, std::vector<bool>{true});
  write(0x100c, 0, 50, 2);
  advance(10s);
  EXPECT_EQ(guarding, std::vector<bool>{true});  // it is lost already
  tell("705#R1");
  advance(50ms);
  EXPECT_EQ(guarding, (std::vector<bool>{true, false, true}));
}

TEST_F(CanopenSlaveGuarding, ZeroInEitherObjectIsNoLifeGuarding) {
  drain();
  write(0x100c, 0, 100, 2);
  tell("705#R1");
  EXPECT_EQ(slave.next_deadline(), std::nullopt);
  write(0x100d, 0, 2, 1);  // counts from now
  advance(199ms);
  EXPECT_TRUE(guarding.empty());
  write(0x100c, 0, 0, 2);
  advance(10s);
  EXPECT_TRUE(guarding.empty());
}

TEST_F(CanopenSlaveGuarding, LifeTimeRunsInEveryStateAndEndsWithAReset) {
  drain();
  for (const char* command : {"000#0105", "000#0205", "000#8005"}) {
    tell("000#8005");
    write(0x100c, 0, 10, 2);
    write(0x100d, 0, 1, 1);
    tell(command);
    tell("705#R1");
    guarding.clear();
    advance(10ms);
    EXPECT_EQ(guarding, std::vector<bool>{true}) << command;
  }
  tell("705#R1");
  guarding.clear();
  tell("000#8205");
  advance(1s);
  EXPECT_TRUE(guarding.empty());
}

}  // namespace
}  // namespace vinv::test
