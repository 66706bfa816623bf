// SDO server: expedited transfers, each abort code that it gives itself, bad frames. CiA DS-301 v4.0, 9.2.2.
#include "tests/option_boards/canopen/slave_bench.hpp"

namespace vinv::test {
namespace {

class CanopenSlaveSdo : public SlaveBench {
 protected:
  CanopenSlaveSdo() { drain(); }
};

TEST_F(CanopenSlaveSdo, UploadsHaveTheSizeOfTheObject) {
  values = {{0, 0x1234}, {2, 0x89abcdef}, {3, 0xfffffffb}};
  EXPECT_EQ(tell("605#4000200000000000"), "585#4B00200034120000");
  EXPECT_EQ(tell("605#4002200000000000"), "585#43022000EFCDAB89");
  EXPECT_EQ(tell("605#4003200000000000"), "585#4F032000FB000000");  // nothing above the byte
  EXPECT_EQ(tell("605#4008100000000000"), "585#4308100041424344");  // ABCD
  EXPECT_EQ(tell("605#400B100000000000"), "585#430B100005000000");
}

TEST_F(CanopenSlaveSdo, DownloadsAreAcknowledged) {
  EXPECT_EQ(tell("605#2B00200064000000"), "585#6000200000000000");
  EXPECT_EQ(tell("605#2302200078563412"), "585#6002200000000000");
  EXPECT_EQ(tell("605#2F032000FB000000"), "585#6003200000000000");
  EXPECT_EQ(writes, (std::vector<std::string>{"sdo 2000 0064", "sdo 2002 12345678", "sdo 2003 00FB"}));
}

TEST_F(CanopenSlaveSdo, DownloadWithoutSizeHasTheObjectsOwn) {
  EXPECT_EQ(tell("605#22002000640099AA"), "585#6000200000000000");
  EXPECT_EQ(writes, std::vector<std::string>{"sdo 2000 0064"});
}

TEST_F(CanopenSlaveSdo, EachAbortCode) {
  EXPECT_EQ(read(0x3000, 0), "06020000");
  EXPECT_EQ(write(0x3000, 0, 1, 2), "06020000");
  EXPECT_EQ(read(0x2105, 0), "06020000");  // in the table's range, but the device does not have it
  EXPECT_EQ(read(0x2105, 1), "06020000");
  EXPECT_EQ(read(0x2100, 0), "=0000");
  EXPECT_EQ(read(0x2100, 1), "06090011");
  EXPECT_EQ(read(0x2000, 1), "06090011");
  EXPECT_EQ(write(0x2200, 3, 1, 2), "06090011");
  EXPECT_EQ(read(0x2200, 2), "=0000");
  EXPECT_EQ(read(0x2005, 0), "06010001");
  EXPECT_EQ(write(0x2006, 0, 1, 2), "06010002");
  EXPECT_EQ(write(0x1000, 0, 1, 4), "06010002");
  for (const unsigned size : {1u, 3u, 4u}) EXPECT_EQ(write(0x2000, 0, 1, size), "06070010") << size;
  for (const unsigned size : {2u, 3u, 4u}) EXPECT_EQ(write(0x2003, 0, 1, size), "06070010") << size;
  for (const unsigned size : {1u, 2u, 3u}) EXPECT_EQ(write(0x2002, 0, 1, size), "06070010") << size;
  EXPECT_EQ(write(0x2000, 0, 1000, 2), "ok");
  EXPECT_EQ(write(0x2000, 0, 1001, 2), "06090030");
  EXPECT_EQ(write(0x2003, 0, 0xfb, 1), "ok");
  EXPECT_EQ(write(0x2003, 0, 0xfa, 1), "06090030");
  EXPECT_EQ(write(0x2003, 0, 6, 1), "06090030");
  EXPECT_EQ(writes.size(), 2u);
}

TEST_F(CanopenSlaveSdo, SegmentedAndBlockTransfersAreRefused) {
  EXPECT_EQ(tell("605#2100200004000000"), "585#8000200001000405");  // initiate segmented download, size indicated
  EXPECT_EQ(tell("605#2000200000000000"), "585#8000200001000405");
  EXPECT_EQ(tell("605#0000200000000000"), "585#8000000001000405");  // download segment
  EXPECT_EQ(tell("605#6000000000000000"), "585#8000000001000405");  // upload segment
  EXPECT_EQ(tell("605#A408100001000000"), "585#8008100001000405");  // initiate block upload
  EXPECT_EQ(tell("605#C600200004000000"), "585#8000200001000405");  // initiate block download
  EXPECT_EQ(tell("605#E000200000000000"), "585#8000000001000405");  // no such specifier
  EXPECT_TRUE(writes.empty());
}

TEST_F(CanopenSlaveSdo, EveryCommandByteIsAnsweredOnceOrAnAbort) {
  for (unsigned command = 0; command < 256; ++command) {
    slave.handle_frame(now, sdo(static_cast<std::uint8_t>(command), 0x2002, 0, 1));
    const bool abort = command >> 5 == 4;
    std::vector<CanFrame> sent;
    while (const auto frame = slave.poll_transmit(now)) sent.push_back(*frame);
    ASSERT_EQ(sent.size(), abort ? 0u : 1u) << command;
    if (abort) continue;
    EXPECT_EQ(sent[0].id, 0x585u);
    const bool upload = command >> 5 == 2, expedited = command >> 5 == 1 && (command & 2) != 0;
    if (!upload && !expedited) {
      EXPECT_EQ(sent[0].data[0], 0x80) << command;
    }
    if (upload) {
      EXPECT_EQ(sent[0].data[0], 0x43) << command;
    }
  }
}

TEST_F(CanopenSlaveSdo, OtherLengthsThanEightAreNoRequests) {
  for (std::uint8_t length = 0; length < 8; ++length) {
    CanFrame frame = sdo(0x40, 0x1000, 0);
    frame.length = length;
    slave.handle_frame(now, frame);
    EXPECT_EQ(drain(), "") << int{length};
  }
  EXPECT_EQ(tell("605#R8"), "");
  EXPECT_EQ(tell("606#4000100000000000"), "");
  EXPECT_EQ(tell("585#4000100000000000"), "");
}

TEST_F(CanopenSlaveSdo, DownloadDecidedLaterIsAnsweredLater) {
  EXPECT_EQ(tell("605#2B08200001000000"), "");
  EXPECT_EQ(advance(1s), "");
  slave.complete_download({});
  EXPECT_EQ(drain(), "585#6008200000000000");
  EXPECT_EQ(tell("605#2B08200001000000"), "");
  slave.complete_download(Unexpected(canopen::AbortCode::kDeviceState));
  EXPECT_EQ(drain(), "585#8008200022000008");
  EXPECT_EQ(abandoned, 0);
}

TEST_F(CanopenSlaveSdo, AbortByTheClientEndsTheTransferWithoutAnAnswer) {
  EXPECT_EQ(tell("605#2B08200001000000"), "");
  EXPECT_EQ(tell("605#8008200000000405"), "");
  EXPECT_EQ(abandoned, 1);
  slave.complete_download({});
  EXPECT_EQ(drain(), "");
  EXPECT_EQ(read(0x1000, 0), "=00010192");
}

TEST_F(CanopenSlaveSdo, NewRequestTakesThePlaceOfAnUndecidedOne) {
  EXPECT_EQ(tell("605#2B08200001000000"), "");
  EXPECT_EQ(read(0x1000, 0), "=00010192");
  EXPECT_EQ(abandoned, 1);
  slave.complete_download({});
  EXPECT_EQ(drain(), "");
}

TEST_F(CanopenSlaveSdo, NodeThatIsStoppedOrResetAbandonsTheTransfer) {
  for (const char* command : {"000#0205", "000#8105", "000#8205"}) {
    tell("000#8005");
    abandoned = 0;
    EXPECT_EQ(tell("605#2B08200001000000"), "");
    tell(command);
    EXPECT_EQ(abandoned, 1) << command;
    slave.complete_download({});
    EXPECT_EQ(drain(), "") << command;
  }
}

TEST_F(CanopenSlaveSdo, ClientThatDoesNotWaitGetsItsAnswersInOrder) {
  for (const std::uint16_t index : {0x1000, 0x3000, 0x100b}) slave.handle_frame(now, sdo(0x40, index, 0));
  EXPECT_EQ(drain(), "585#4300100092010100 585#8000300000000206 585#430B100005000000");
  for (int i = 0; i < 100; ++i) slave.handle_frame(now, sdo(0x40, 0x1000, 0));
  int answers = 0;
  while (slave.poll_transmit(now)) ++answers;
  EXPECT_EQ(answers, static_cast<int>(canopen::Slave::kMaxSdoAnswers));
}

}  // namespace
}  // namespace vinv::test
