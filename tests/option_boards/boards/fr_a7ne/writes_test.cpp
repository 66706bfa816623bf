// Explicit writes: one at a time, their timing, what the inverter's refusals become. FR-A7NE manual, 6.2 and appendix.
#include <gtest/gtest.h>

#include "option_boards/boards/fr_a7ne/refusal_codes.hpp"
#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

class FrA7neWrites : public test::UnitBench {};

const char* const kWritePr7 = "10 03 20 66 24 01 30 11 14 00";

TEST_F(FrA7neWrites, AnswerComesWhenTheInverterHasDecided) {
  drive.ticks_to_decide = 5;
  EXPECT_EQ(request(kWritePr7), "later");
  tick(4);
  EXPECT_EQ(poll(), "");
  tick();
  EXPECT_EQ(poll(), "00");
  EXPECT_EQ(drive.parameters[7].value, 20u);
}

// 6.2.2 *1.
TEST_F(FrA7neWrites, SecondWriteWithin100MsIsAStateConflict) {
  EXPECT_EQ(request(kWritePr7), "later");
  EXPECT_EQ(request(kWritePr7), "0C");
  tick();
  EXPECT_EQ(poll(), "00");
  tick(98);
  EXPECT_EQ(request(kWritePr7), "0C");
  EXPECT_EQ(request("10 03 20 29 24 01 30 0C 01"), "0C");
  EXPECT_EQ(request(get_request(0x66, 1, 17)), "00 14 00");
  tick();
  EXPECT_EQ(request(kWritePr7), "later");
}

TEST_F(FrA7neWrites, FastTimingHasNoPauses) {
  config = make_config();
  config.timing = Timing::fast();
  Unit fast(drive, config);
  fast.handle_power(now, true);
  cip::Reply reply;
  const Bytes bytes = test::from_hex(kWritePr7);
  const cip::Request write = *cip::parse_request(bytes).request;
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(fast.router().handle(now, write, reply).has_value());
    drive.tick();
    fast.handle_drive_tick(now);
    EXPECT_TRUE(fast.router().poll_reply()->reply.status.ok());
  }
}

// 6.2.2 (3): about 5 s.
TEST_F(FrA7neWrites, ParameterClearIsSilentForFiveSeconds) {
  EXPECT_EQ(request("10 03 20 2A 24 01 30 66 5A 96"), "later");
  tick(4999);
  EXPECT_EQ(unit.next_deadline(), now + std::chrono::milliseconds(1));
  EXPECT_EQ(poll(), "");
  EXPECT_EQ(count(Kind::kRestoreDefaults), 1u);
  EXPECT_EQ(request(kWritePr7), "0C");
  EXPECT_EQ(request(get_request(1, 1, 1)), "00 A1 00");
  tick();
  EXPECT_EQ(poll(), "00");
  EXPECT_EQ(request(kWritePr7), "later");
}

TEST_F(FrA7neWrites, RefusedClearIsAnsweredAtOnce) {
  drive.mode = port::OperationMode::kExternal;
  EXPECT_EQ(request("10 03 20 2A 24 01 30 66 5A 96"), "later");
  tick();
  EXPECT_EQ(poll(), "0C");
}

TEST_F(FrA7neWrites, EachRefusalOfTheInverterHasItsStatus) {
  using port::Refusal;
  struct Row {
    Refusal refusal;
    const char* answer;
  };
  for (const Row& row :
       {Row{Refusal::kNoSuchItem, "14"}, Row{Refusal::kOutOfRange, "09"}, Row{Refusal::kReadOnly, "0E"},
        Row{Refusal::kWriteOnly, "14"}, Row{Refusal::kRunning, "0C"}, Row{Refusal::kWriteDisabled, "0C"},
        Row{Refusal::kWrongMode, "0C"}, Row{Refusal::kModeChangeRefused, "0C"}, Row{Refusal::kBusy, "0C"},
        Row{Refusal::kNotReady, "10"}, Row{Refusal::kFaulted, "10"}, Row{Refusal::kNotFaulted, "10"}}) {
    drive.refuse_decision = row.refusal;
    EXPECT_EQ(ask(kWritePr7), row.answer);
    EXPECT_EQ(static_cast<unsigned>(status_of(row.refusal)), std::stoul(row.answer, nullptr, 16));
  }
  drive.refuse_decision.reset();
  drive.refuse_post = Refusal::kNotReady;
  EXPECT_EQ(ask(kWritePr7), "10");
}

TEST_F(FrA7neWrites, LengthsRangesAndStorage) {
  EXPECT_EQ(request("10 03 20 66 24 01 30 11 14"), "13");
  EXPECT_EQ(request("10 03 20 66 24 01 30 11 14 00 00"), "15");
  EXPECT_EQ(set(0x66, 1, 17, "FF FF"), "09");
  EXPECT_EQ(set(0x66, 1, 89, "01 00"), "0E");
  EXPECT_EQ(request("0E 02 20 66 24 01"), "14");
  drive.storage_fails = true;
  EXPECT_EQ(set(0x66, 1, 17, "14 00"), "19");
  EXPECT_EQ(set(0x2A, 1, 113, "B8 0B"), "19");
  EXPECT_EQ(set(0x2A, 1, 112, "B8 0B"), "00") << "RAM";
  EXPECT_EQ(set(0x2A, 1, 141, "00 00"), "19");
  EXPECT_EQ(set(0x2A, 1, 102, "5A 96"), "19");
  // Of two steps, the first.
  EXPECT_EQ(ask("05 02 20 01 24 01 01"), "19");
}

TEST_F(FrA7neWrites, MembersAreNotKnown) {
  EXPECT_EQ(request("0E 04 20 66 24 01 30 11 28 01"), "28");
  EXPECT_EQ(request("10 04 20 66 24 01 30 11 28 01 14 00"), "29");
}

TEST_F(FrA7neWrites, AnswerThatDoesNotFitIsRefused) {
  const Bytes bytes = test::from_hex("01 02 20 01 24 01");
  cip::Request all = *cip::parse_request(bytes).request;
  all.reply_limit = 18;
  cip::Reply reply;
  EXPECT_FALSE(unit.router().handle(now, all, reply).has_value());
  EXPECT_EQ(reply.status, cip::Status(cip::GeneralStatus::kReplyDataTooLarge));
  all.reply_limit = 19;
  unit.router().handle(now, all, reply);
  EXPECT_EQ(reply.data.size(), 19u);
}

TEST_F(FrA7neWrites, MailboxThatIsTakenIsWaitedFor) {
  drive.refuse_post = port::Refusal::kBusy;
  EXPECT_EQ(request(kWritePr7), "later");
  tick(3);
  drive.refuse_post.reset();
  tick(2);
  EXPECT_EQ(poll(), "00");
}

TEST_F(FrA7neWrites, WriteThatARestartSwallowsIsADeviceStateConflict) {
  drive.parameters[540].value = 0x0800;
  power(false);
  power(true);
  drive.ticks_to_decide = 10;
  EXPECT_EQ(request(kWritePr7), "later");
  tick(2);
  drive.lose_mailbox();
  tick();
  EXPECT_EQ(poll(), "10");
}

TEST_F(FrA7neWrites, PowerOffForgetsWhoWaits) {
  drive.ticks_to_decide = 10;
  EXPECT_EQ(request(kWritePr7), "later");
  EXPECT_TRUE(unit.router().awaits(1));
  power(false);
  EXPECT_FALSE(unit.router().awaits(1));
  power(true);  // the mailbox has still the old write
  tick(10);
  EXPECT_EQ(poll(), "");
  drive.ticks_to_decide = 1;
  EXPECT_EQ(ask(kWritePr7), "00");
}

// 4.6: inverter reset in NET operation only; the answer still comes, then the option starts anew (Pr.540 bit 11 = 0).
TEST_F(FrA7neWrites, InverterResetRestartsTheOption) {
  drive.mode = port::OperationMode::kPu;
  EXPECT_EQ(ask("10 03 20 2A 24 01 30 65 01 00"), "0C");
  drive.mode = port::OperationMode::kNetwork;
  unit.take_restart();
  EXPECT_EQ(request("10 03 20 2A 24 01 30 65 01 00"), "later");
  tick();
  EXPECT_EQ(poll(), "00");
  EXPECT_TRUE(unit.online());
  tick();
  EXPECT_FALSE(unit.online());
  EXPECT_TRUE(unit.take_restart());
  EXPECT_FALSE(unit.take_restart());
  EXPECT_EQ(unit.identity_state(), cip::IdentityState::kSelfTesting);
  tick(100);
  EXPECT_TRUE(unit.online());
}

TEST_F(FrA7neWrites, OptionStaysWithPr540Bit11) {
  drive.parameters[540].value = 0x0800;
  power(false);
  power(true);
  unit.take_restart();
  drive.reset_needs_alarm = true;  // any time, whatever Pr.75 says
  EXPECT_EQ(ask("10 03 20 2A 24 01 30 65 00 00"), "00");
  EXPECT_TRUE(unit.online());
  EXPECT_FALSE(unit.take_restart());
}

// 7.1.2: reset 0 and 1, as set in Pr.75.
TEST_F(FrA7neWrites, IdentityResetFollowsPr75) {
  EXPECT_EQ(request("05 02 20 01 24 01 02"), "20");
  EXPECT_EQ(request("05 02 20 01 24 01 00 00"), "15");
  drive.reset_needs_alarm = true;
  EXPECT_EQ(ask("05 02 20 01 24 01 00"), "10");
  drive.status_now.alarm = true;
  EXPECT_EQ(request("05 02 20 01 24 01"), "later");
  tick();
  EXPECT_EQ(poll(), "00");
  EXPECT_EQ(count(Kind::kResetInverter), 1u);
}

TEST_F(FrA7neWrites, NoResetFromTheNetworkWhileALineErrorLasts) {
  open_owner();
  unit.on_connection(now, owner(), cip::IoEvent::kTimedOut);
  EXPECT_EQ(request("05 02 20 01 24 01 00"), "0C");
  EXPECT_EQ(request("10 03 20 2A 24 01 30 65 01 00"), "0C");
  open_owner();
  EXPECT_EQ(request("05 02 20 01 24 01 00"), "later");
}

TEST_F(FrA7neWrites, IdentityResetOneClearsParametersAndFlash) {
  EXPECT_EQ(set(0xF5, 1, 6, "02 00 61 62"), "00");
  EXPECT_EQ(get(0xF5, 1, 6), "00 02 00 61 62");
  unit.take_restart();
  EXPECT_EQ(request("05 02 20 01 24 01 01"), "later");
  tick(4999);
  EXPECT_EQ(last(Kind::kRestoreDefaults).value, 1u);
  EXPECT_EQ(count(Kind::kResetInverter), 0u);
  EXPECT_EQ(unit.next_deadline(), now + std::chrono::milliseconds(1)) << "the reset comes after the clear";
  tick(2);
  EXPECT_EQ(count(Kind::kResetInverter), 1u);
  EXPECT_EQ(poll(), "00");
  EXPECT_FALSE(unit.take_restart());
  tick(101);
  EXPECT_TRUE(unit.take_restart());
  EXPECT_EQ(get(0xF5, 1, 6), "00 00 00");
}

TEST_F(FrA7neWrites, IdentityResetOneThatIsRefusedResetsNothing) {
  EXPECT_EQ(set(0xF5, 1, 6, "02 00 61 62"), "00");
  drive.refuse_decision = port::Refusal::kWriteDisabled;
  EXPECT_EQ(request("05 02 20 01 24 01 01"), "later");
  tick(2);
  EXPECT_EQ(poll(), "0C");
  tick(6000);
  EXPECT_TRUE(drive.executed.empty());
  drive.refuse_decision.reset();
  drive.mode = port::OperationMode::kExternal;
  EXPECT_EQ(request("05 02 20 01 24 01 01"), "0C");
  drive.mode = port::OperationMode::kNetwork;
  for (const unsigned pr75 : {1u, 3u, 15u, 17u}) {
    drive.parameters[75] = {pr75, 0, 17};
    EXPECT_EQ(request("05 02 20 01 24 01 01"), "10") << pr75;
  }
  EXPECT_EQ(drive.posted.size(), 1u);
  EXPECT_EQ(get(0xF5, 1, 6), "00 02 00 61 62") << "the flash as well";
}

TEST_F(FrA7neWrites, SnapshotContinuesInTheMiddleOfAClear) {
  request("10 03 20 2A 24 01 30 66 5A 96");
  tick(1000);
  const Bytes snapshot = save_snapshot(unit);
  tick(5000);
  EXPECT_EQ(poll(), "00");
  ASSERT_TRUE(load_snapshot(unit, snapshot).has_value());
  now = now - std::chrono::milliseconds(5000);
  tick(3999);
  EXPECT_EQ(poll(), "");
  tick();
  EXPECT_EQ(poll(), "00");
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
