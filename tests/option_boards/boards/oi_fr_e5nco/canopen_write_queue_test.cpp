// The order in which CANopen writes reach the inverter's one mailbox, and who gets the mailbox.
#include <gtest/gtest.h>

#include "option_boards/boards/oi_fr_e5nco/mailbox_share.hpp"
#include "option_boards/boards/oi_fr_e5nco/write_queue.hpp"
#include "tests/option_boards/support/fake_drive.hpp"

namespace vinv::boards::oi_fr_e5nco {
namespace {

using test::FakeDrive;
using Kind = port::WriteRequest::Kind;

WriteJob job(WriteOrigin origin, WriteTopic topic, std::uint32_t value, std::uint16_t parameter = 0) {
  WriteJob made{.origin = origin, .topic = topic};
  made.add({.kind = topic == WriteTopic::kParameter ? Kind::kParameter : Kind::kFrequency,
            .parameter = {parameter, 0},
            .value = value});
  return made;
}

class OiFrE5ncoWriteQueue : public ::testing::Test {
 protected:
  OiFrE5ncoWriteQueue() { drive.mode = port::OperationMode::kNetwork; }
  std::vector<std::uint32_t> run(int ticks = 200) {
    for (int i = 0; i < ticks; ++i) {
      while (const auto done = queue.advance(now, drive)) finished.push_back(*done);
      drive.tick();
    }
    std::vector<std::uint32_t> values;
    for (const auto& request : drive.executed) values.push_back(request.value);
    return values;
  }
  FakeDrive drive;
  WriteQueue queue;
  std::vector<FinishedWrite> finished;
  Instant now = instant_from_ns(1'000'000'000);
};

TEST_F(OiFrE5ncoWriteQueue, LatestPdoWriteTakesThePlaceOfTheFirst) {
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kFrequency, 1));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kAnalog, 2));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kFrequency, 3));
  EXPECT_EQ(run(), (std::vector<std::uint32_t>{3, 2}));
  EXPECT_TRUE(queue.idle());
}

TEST_F(OiFrE5ncoWriteQueue, SdoWritesAreNeverReplacedAndReplaceNothing) {
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kFrequency, 1));
  queue.put(job(WriteOrigin::kSdo, WriteTopic::kFrequency, 2));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kFrequency, 3));
  EXPECT_EQ(run(), (std::vector<std::uint32_t>{3, 2}));
}

TEST_F(OiFrE5ncoWriteQueue, ParametersAreReplacedByTheirNumber) {
  drive.parameters[8] = {0, 0, 100};
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kParameter, 1, 7));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kParameter, 2, 8));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kParameter, 3, 7));
  EXPECT_EQ(run(), (std::vector<std::uint32_t>{3, 2}));
}

TEST_F(OiFrE5ncoWriteQueue, UrgentWriteComesFirstAndDropsOtherMotorCommands) {
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kFrequency, 1));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kRun, 2));
  queue.put(job(WriteOrigin::kSdo, WriteTopic::kRun, 3));
  queue.put_first(job(WriteOrigin::kInternal, WriteTopic::kRun, 9));
  EXPECT_EQ(run(), (std::vector<std::uint32_t>{9, 1, 3}));
}

TEST_F(OiFrE5ncoWriteQueue, HasALimit) {
  for (std::size_t i = 0; i < WriteQueue::kCapacity; ++i) {
    EXPECT_TRUE(queue.put(job(WriteOrigin::kSdo, WriteTopic::kOther, static_cast<std::uint32_t>(i))));
  }
  EXPECT_FALSE(queue.put(job(WriteOrigin::kSdo, WriteTopic::kOther, 99)));
  queue.put_first(job(WriteOrigin::kInternal, WriteTopic::kRun, 50));
  const auto values = run();
  ASSERT_EQ(values.size(), WriteQueue::kCapacity);
  EXPECT_EQ(values.front(), 50u);
  EXPECT_EQ(values[1], 0u);
}

TEST_F(OiFrE5ncoWriteQueue, UrgentWriteTakesTheRoomOfOneThatNobodyAwaits) {
  for (std::uint32_t i = 0; i < WriteQueue::kCapacity - 2; ++i) {
    EXPECT_TRUE(queue.put(job(WriteOrigin::kInternal, WriteTopic::kOther, i)));
  }
  EXPECT_TRUE(queue.put(job(WriteOrigin::kNmt, WriteTopic::kMode, 60)));
  EXPECT_TRUE(queue.put(job(WriteOrigin::kSdo, WriteTopic::kOther, 70)));
  queue.put_first(job(WriteOrigin::kInternal, WriteTopic::kRun, 50));
  const auto values = run();
  ASSERT_EQ(values.size(), WriteQueue::kCapacity);
  EXPECT_EQ(values[0], 50u);
  EXPECT_EQ(values[WriteQueue::kCapacity - 3], WriteQueue::kCapacity - 4);  // the last one before is gone
  EXPECT_EQ(values[WriteQueue::kCapacity - 2], 60u);
  EXPECT_EQ(values[WriteQueue::kCapacity - 1], 70u);
}

TEST_F(OiFrE5ncoWriteQueue, FirstRefusalEndsAJobOfTwoSteps) {
  WriteJob two = job(WriteOrigin::kPdo, WriteTopic::kRun, 50000);
  two.add({.kind = Kind::kCommand});
  queue.put(two);
  EXPECT_TRUE(run().empty());
  ASSERT_EQ(finished.size(), 1u);
  EXPECT_EQ(finished[0].outcome.error(), port::Refusal::kOutOfRange);
  EXPECT_EQ(drive.posted.size(), 1u);
}

TEST_F(OiFrE5ncoWriteQueue, ClearedQueueTellsNobodyOfWhatIsWithTheInverter) {
  drive.ticks_to_decide = 5;
  queue.put(job(WriteOrigin::kSdo, WriteTopic::kFrequency, 1));
  queue.put(job(WriteOrigin::kPdo, WriteTopic::kAnalog, 2));
  run(1);
  queue.clear();
  EXPECT_EQ(run(), std::vector<std::uint32_t>{1});
  ASSERT_EQ(finished.size(), 1u);
  EXPECT_EQ(finished[0].job.origin, WriteOrigin::kInternal);
}

TEST_F(OiFrE5ncoWriteQueue, SharesOfTheMailboxTakeTurns) {
  Mailbox mailbox;
  MailboxShare modbus(drive, mailbox, MailboxUser::kModbus), canopen(drive, mailbox, MailboxUser::kCanopen);
  ASSERT_TRUE(modbus.post_write(now, {.kind = Kind::kFrequency, .value = 1}));
  EXPECT_EQ(modbus.post_write(now, {.kind = Kind::kFrequency}).error(), port::Refusal::kBusy);
  ASSERT_TRUE(canopen.post_write(now, {.kind = Kind::kFrequency, .value = 2}));
  EXPECT_EQ(canopen.post_write(now, {.kind = Kind::kFrequency}).error(), port::Refusal::kBusy);
  EXPECT_TRUE(canopen.write_pending());
  drive.tick();
  EXPECT_FALSE(canopen.take_outcome());  // the one that is there is not its own
  EXPECT_TRUE(modbus.take_outcome());
  EXPECT_FALSE(modbus.write_pending());
  ASSERT_TRUE(modbus.post_write(now, {.kind = Kind::kFrequency, .value = 3}));  // after CANopen's
  drive.tick();
  EXPECT_FALSE(modbus.take_outcome());
  EXPECT_TRUE(canopen.take_outcome());
  drive.tick();
  EXPECT_TRUE(modbus.take_outcome());
  EXPECT_EQ(run(0), (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST_F(OiFrE5ncoWriteQueue, CommandIsNotBlamedForWhatModbusCouldNotStore) {
  Mailbox mailbox;
  MailboxShare modbus(drive, mailbox, MailboxUser::kModbus), canopen(drive, mailbox, MailboxUser::kCanopen);
  drive.storage_fails = true;
  ASSERT_TRUE(modbus.post_write(now, {.kind = Kind::kParameter, .parameter = {7, 0}, .value = 60}));
  queue.put(job(WriteOrigin::kSdo, WriteTopic::kFrequency, 2));
  EXPECT_FALSE(queue.advance(now, canopen));
  drive.tick();
  EXPECT_TRUE(modbus.take_outcome());
  EXPECT_EQ(drive.storage_failures(), 1u);
  drive.tick();
  const auto done = queue.advance(now, canopen);
  ASSERT_TRUE(done);
  EXPECT_TRUE(done->outcome);
  EXPECT_FALSE(done->storage_failed);
}

TEST_F(OiFrE5ncoWriteQueue, ShareWhoseWriteIsLostGivesTheMailboxOn) {
  Mailbox mailbox;
  MailboxShare modbus(drive, mailbox, MailboxUser::kModbus), canopen(drive, mailbox, MailboxUser::kCanopen);
  ASSERT_TRUE(canopen.post_write(now, {.kind = Kind::kFrequency, .value = 1}));
  ASSERT_TRUE(modbus.post_write(now, {.kind = Kind::kFrequency, .value = 2}));
  drive.lose_mailbox();
  drive.is_ready = false;
  EXPECT_FALSE(canopen.write_pending());
  EXPECT_FALSE(canopen.take_outcome());
  const auto refused = modbus.take_outcome();  // waited, and is refused now
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->error(), port::Refusal::kNotReady);
  EXPECT_FALSE(modbus.write_pending());
  drive.is_ready = true;
  EXPECT_TRUE(modbus.post_write(now, {.kind = Kind::kFrequency, .value = 3}));
}

}  // namespace
}  // namespace vinv::boards::oi_fr_e5nco
