// Forward_Open and Large_Forward_Open: answers and every refusal. CIP Vol 1, 3-5.5.2, table 3-5.33; Vol 2, 3-3.
#include <gtest/gtest.h>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using test::AdapterBench;
using test::from_hex;
using test::item;
using test::join;
using test::Master;
using test::OpenWish;
using test::to_hex;

constexpr unsigned kMulticast = 0x2800;

OpenWish input_only(unsigned serial) {
  OpenWish w;
  w.serial = serial;
  w.path = "20 04 2C 1E 2C 47";
  w.o2t = 0x4800 | 2;
  return w;
}
OpenWish listen_only(unsigned serial) {
  OpenWish w = input_only(serial);
  w.path = "20 04 2C 1F 2C 47";
  w.t2o = kMulticast | 6;
  return w;
}
OpenWish explicit_one(unsigned serial) {
  OpenWish w;
  w.serial = serial;
  w.transport = 0xa3;
  w.o2t = w.t2o = 0x4000 | 500;
  w.path = "20 02 24 01";
  return w;
}

class ConnectionOpeningTest : public ::testing::Test {
 protected:
  ConnectionOpeningTest() : master(Master::registered(bench)) {}
  AdapterBench bench;
  Master master;
};

TEST_F(ConnectionOpeningTest, AnswerHasIdentifiersTriadAndActualIntervals) {
  OpenWish w;
  w.o2t_rpi_us = 20'000;
  const Bytes reply = master.open(w);
  ASSERT_EQ(reply.size(), 30u);
  EXPECT_EQ(to_hex(ByteView(reply).first(4)), "D4 00 00 00");
  EXPECT_NE(read_le32(reply, 4), 0u);
  EXPECT_EQ(to_hex(ByteView(reply).subspan(8)), "44 33 22 11 01 00 37 13 2A 00 00 00 20 4E 00 00 10 27 00 00 00 00");
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 opened"});
  EXPECT_EQ(bench.adapter.connections().io_connections(), 1u);
}

TEST_F(ConnectionOpeningTest, PathOfARealScannerWithKeyAndConfigurationIsTaken) {
  OpenWish w;
  w.path = "34 04 00 00 00 00 00 00 00 00 20 04 24 64 2C 15 2C 47 80 02 01 02 03 04";
  EXPECT_EQ(master.open_status(w), "00");
  EXPECT_EQ(to_hex(bench.device.configuration), "01 02 03 04");
}

TEST_F(ConnectionOpeningTest, ClassCanBeRepeatedBeforeEachPoint) {
  OpenWish w;
  w.path = "20 04 24 64 20 04 24 15 30 03 20 04 24 47 30 03";
  EXPECT_EQ(master.open_status(w), "00");
}

TEST_F(ConnectionOpeningTest, LargeForwardOpenIsAnsweredWithItsOwnService) {
  OpenWish w;
  w.large = true;
  const Bytes reply = master.open(w);
  ASSERT_EQ(reply.size(), 30u);
  EXPECT_EQ(reply[0], 0xdb);
  EXPECT_EQ(reply[2], 0);
}

TEST_F(ConnectionOpeningTest, RefusalHasTriadAndRemainingPath) {
  OpenWish w;
  w.o2t = 0x4800 | 8;
  EXPECT_EQ(to_hex(master.open(w)), "D4 00 01 02 27 01 0A 00 01 00 37 13 2A 00 00 00 00 00");
}

struct Refused {
  const char* name;
  void (*change)(OpenWish&);
  const char* status;
};
class RefusedOpenTest : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedOpenTest, HasItsExtendedStatusAndLeavesNothing) {
  AdapterBench bench;
  auto master = Master::registered(bench);
  OpenWish w;
  GetParam().change(w);
  EXPECT_EQ(master.open_status(w), GetParam().status);
  EXPECT_EQ(bench.adapter.connections().io_connections(), 0u);
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 0u);
  EXPECT_TRUE(bench.take_log().empty());
  bench.advance(std::chrono::seconds(1));
  EXPECT_TRUE(bench.take(Channel::kIo).empty());
  EXPECT_EQ(master.open_status({}), "00");  // the next one finds everything free
}

const Refused kRefused[] = {
    {"O2tSizeTooSmall", [](OpenWish& w) { w.o2t = 0x4800 | 9; }, "01 0127 000A"},
    {"O2tSizeTooLarge", [](OpenWish& w) { w.o2t = 0x4800 | 11; }, "01 0127 000A"},
    {"T2oSizeWrong", [](OpenWish& w) { w.t2o = 0x4800 | 7; }, "01 0128 0006"},
    {"VariableButTooSmall", [](OpenWish& w) { w.o2t = 0x4a00 | 5; }, "01 0127 000A"},
    {"O2tMulticast", [](OpenWish& w) { w.o2t = 0x2800 | 10; }, "01 0123"},
    {"O2tNull", [](OpenWish& w) { w.o2t = 10; }, "01 0123"},
    {"T2oNull", [](OpenWish& w) { w.t2o = 6; }, "01 0124"},
    {"T2oReservedType", [](OpenWish& w) { w.t2o = 0x6800 | 6; }, "01 0124"},
    {"RedundantOwner", [](OpenWish& w) { w.o2t |= 0x8000; }, "01 0125"},
    {"RpiBelowOneMillisecond", [](OpenWish& w) { w.t2o_rpi_us = 999; }, "01 0112 0200 2710 0000 03E8 0000"},
    {"O2tRpiTooLong", [](OpenWish& w) { w.o2t_rpi_us = 4'000'000'000; }, "01 0112 0003 2000 BEBC 2710 0000"},
    {"RpiZero", [](OpenWish& w) { w.o2t_rpi_us = 0; }, "01 0112 0002 03E8 0000 2710 0000"},
    {"InhibitTimeLongerThanRpi",
     [](OpenWish& w) {
       w.transport = 0x11;
       w.path = "43 0B 20 04 2C 15 2C 47";
     },
     "01 011B"},
    {"TransportClass2", [](OpenWish& w) { w.transport = 0x02; }, "01 011C"},
    {"ReservedTrigger", [](OpenWish& w) { w.transport = 0x31; }, "01 011D"},
    {"Multiplier8", [](OpenWish& w) { w.multiplier = 8; }, "01 0133"},
    {"KeyOfAnotherVendor", [](OpenWish& w) { w.path = "34 04 A2 00 02 00 38 00 01 0A 20 04 2C 15 2C 47"; }, "01 0114"},
    {"KeyOfAnotherProduct", [](OpenWish& w) { w.path = "34 04 A1 00 02 00 39 00 01 0A 20 04 2C 15 2C 47"; }, "01 0114"},
    {"KeyOfAnotherDeviceType", [](OpenWish& w) { w.path = "34 04 A1 00 03 00 38 00 01 0A 20 04 2C 15 2C 47"; },
     "01 0115"},
    {"KeyOfAnotherMajorRevision", [](OpenWish& w) { w.path = "34 04 A1 00 02 00 38 00 02 0A 20 04 2C 15 2C 47"; },
     "01 0116"},
    {"KeyOfALaterMinorRevision", [](OpenWish& w) { w.path = "34 04 A1 00 02 00 38 00 81 0B 20 04 2C 15 2C 47"; },
     "01 0116"},
    {"ConsumedPointUnknown", [](OpenWish& w) { w.path = "20 04 2C 16 2C 47"; }, "01 012A"},
    {"ProducedPointUnknown", [](OpenWish& w) { w.path = "20 04 2C 15 2C 48"; }, "01 012B"},
    {"PointsThatDoNotGoTogether", [](OpenWish& w) { w.path = "20 04 2C 14 2C 47"; }, "01 012F"},
    {"ConfigurationPointUnknown", [](OpenWish& w) { w.path = "20 04 24 66 2C 15 2C 47"; }, "01 0129"},
    {"ConfigurationTooLong", [](OpenWish& w) { w.path = "20 04 24 64 2C 15 2C 47 80 03 01 02 03 04 05 06"; },
     "01 0126 0002"},
    {"ConfigurationForAPointWithout", [](OpenWish& w) { w.path = "20 04 24 65 2C 15 2C 47 80 01 01 02"; },
     "01 0126 0000"},
    {"ConfigurationWithoutPoint", [](OpenWish& w) { w.path = "20 04 2C 15 2C 47 80 01 01 02"; }, "01 0129"},
    {"ConfigurationRefusedByTheDevice", [](OpenWish& w) { w.path = "20 04 24 64 2C 15 2C 47 80 02 FF 00 00 00"; },
     "09"},
    {"NoAssembly", [](OpenWish& w) { w.path = "20 70 2C 15 2C 47"; }, "01 0117"},
    {"OnePoint", [](OpenWish& w) { w.path = "20 04 2C 15"; }, "01 0315"},
    {"NoPoints", [](OpenWish& w) { w.path = "20 04"; }, "01 0315"},
    {"FourPoints", [](OpenWish& w) { w.path = "20 04 24 64 2C 15 2C 47 2C 47"; }, "01 0315"},
    {"SegmentCutShort", [](OpenWish& w) { w.path = "20 04 2C 15 2D 00"; }, "01 0315"},
    {"RouteToAnotherPort", [](OpenWish& w) { w.path = "01 00 20 04 2C 15 2C 47"; }, "01 0311"},
    {"HeartbeatWithHeader",
     [](OpenWish& w) {
       w = input_only(1);
       w.o2t = 0x4800 | 6;
     },
     "01 0127 0002"},
    {"AnotherClassForThePoint", [](OpenWish& w) { w.path = "20 04 2C 15 20 70 2C 47"; }, "01 0117"},
    {"AttributeBeforeThePoint", [](OpenWish& w) { w.path = "20 04 30 03 2C 15 2C 47"; }, "01 0315"},
    {"KeyBehindTheClass", [](OpenWish& w) { w.path = "20 04 34 04 00 00 00 00 00 00 00 00 2C 15 2C 47"; }, "01 0315"},
    {"TwoInhibitTimes", [](OpenWish& w) { w.path = "43 02 43 03 20 04 2C 15 2C 47"; }, "01 0315"},
    {"InhibitTimeOfTheWrongSize", [](OpenWish& w) { w.path = "51 01 00 00 20 04 2C 15 2C 47"; }, "01 0315"},
    {"TwoDataSegments", [](OpenWish& w) { w.path = "20 04 24 64 2C 15 2C 47 80 01 01 02 80 01 03 04"; }, "01 0315"},
    {"ListenOnlyWithoutOwner", [](OpenWish& w) { w = listen_only(1); }, "01 0119"},
    {"ExplicitAsClient",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.transport = 0x23;
     },
     "01 011E"},
    {"ExplicitMulticast",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.t2o = 0x2000 | 500;
     },
     "01 0124"},
    {"ExplicitO2tMulticast",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.o2t = 0x2000 | 500;
     },
     "01 0123"},
    {"ExplicitWithoutInterval",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.o2t_rpi_us = 0;
     },
     "01 0111"},
    {"ExplicitWithConfiguration",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.path = "20 02 24 01 80 01 01 02";
     },
     "01 0117"},
    {"ExplicitToAnotherClass",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.path = "20 70 24 01";
     },
     "01 0117"},
    {"ExplicitTooSmall",
     [](OpenWish& w) {
       w = explicit_one(1);
       w.o2t = 0x4000 | 4;
     },
     "01 0109 0FA2"},
};
INSTANTIATE_TEST_SUITE_P(All, RefusedOpenTest, ::testing::ValuesIn(kRefused),
                         [](const auto& one) { return one.param.name; });

TEST_F(ConnectionOpeningTest, DataAfterOrBehindThePathIsRefused) {
  EXPECT_EQ(to_hex(master.request(from_hex("54 02 20 06 24 01 0A 0E 00 00"))), "D4 00 13 00");
  OpenWish w;
  w.path = "20 04 2C 15 2C 47";
  Bytes message = from_hex(
      "54 02 20 06 24 01 0A 0E 00 00 00 00 44 33 22 11 01 00 37 13 2A 00 00 00 00 00 00 00 10 27 00 00 0A 48 "
      "10 27 00 00 06 48 01 02 20 04 2C 15 2C 47");
  EXPECT_EQ(to_hex(master.request(message)), "D4 00 15 00");
}

TEST_F(ConnectionOpeningTest, MatchingKeysAreTaken) {
  unsigned serial = 1;
  for (const char* key : {"34 04 A1 00 02 00 38 00 01 0A", "34 04 A1 00 02 00 38 00 01 00",
                          "34 04 A1 00 02 00 38 00 81 09", "34 04 00 00 00 00 00 00 00 00"}) {
    OpenWish w = input_only(serial++);
    const std::string path = std::string(key) + " 20 04 2C 1E 2C 47";
    w.path = path;
    EXPECT_EQ(master.open_status(w), "00") << key;
  }
}

TEST_F(ConnectionOpeningTest, TriggerOfAServerMeansNothing) {
  unsigned serial = 1;
  for (const unsigned trigger : {0u, 1u, 2u, 3u, 7u}) {
    OpenWish w = explicit_one(serial++);
    w.transport = 0x83 | trigger << 4;
    EXPECT_EQ(master.open_status(w), "00") << trigger;
  }
}

TEST_F(ConnectionOpeningTest, SameTriadAgainIsADuplicate) {
  EXPECT_EQ(master.open_status({}), "00");
  EXPECT_EQ(master.open_status({}), "01 0100");
}

TEST_F(ConnectionOpeningTest, SecondOwnerIsAConflictOnAnyPoint) {
  EXPECT_EQ(master.open_status({}), "00");
  auto other = Master::registered(bench, ipv4(127, 0, 0, 2));
  OpenWish w;
  w.originator_serial = 43;
  EXPECT_EQ(other.open_status(w), "01 0106");
  w.path = "20 04 2C 14 2C 46";
  EXPECT_EQ(other.open_status(w), "01 0106");
  master.close({});
  EXPECT_EQ(other.open_status(w), "00");
}

TEST_F(ConnectionOpeningTest, AnotherConfigurationThanTheOwnersIsAConflict) {
  OpenWish w;
  w.path = "20 04 24 64 2C 15 2C 47 80 02 01 02 03 04";
  EXPECT_EQ(master.open_status(w), "00");
  OpenWish second = input_only(2);
  second.path = "20 04 24 64 2C 1E 2C 47 80 02 01 02 03 05";
  EXPECT_EQ(master.open_status(second), "01 0106");
  second.path = "20 04 24 64 2C 1E 2C 47 80 02 01 02 03 04";
  EXPECT_EQ(master.open_status(second), "00");
}

TEST_F(ConnectionOpeningTest, ConfigurationOfAConnectionIsItsOriginatorsToChange) {
  OpenWish w;
  w.path = "20 04 24 64 2C 15 2C 47 80 02 01 02 03 04";
  EXPECT_EQ(master.open_status(w), "00");
  OpenWish null = w;
  null.o2t = null.t2o = 0;
  null.path = "20 04 24 64 80 02 01 02 03 05";
  EXPECT_EQ(master.open_status(null), "00") << "the same triad";
  null.serial = 2;
  null.path = "20 04 24 64 80 02 01 02 03 06";
  EXPECT_EQ(master.open_status(null), "01 0106");
  EXPECT_EQ(to_hex(bench.device.configuration), "01 02 03 05");
}

TEST_F(ConnectionOpeningTest, OwnerWithoutConfigurationDataLeavesItToOthers) {
  OpenWish w;
  w.path = "20 04 24 64 2C 15 2C 47";
  EXPECT_EQ(master.open_status(w), "00");
  OpenWish second = input_only(2);
  second.path = "20 04 24 64 2C 1E 2C 47 80 02 01 02 03 05";
  EXPECT_EQ(master.open_status(second), "00");
}

TEST_F(ConnectionOpeningTest, ListeningTakesAMulticastOfThatPoint) {
  OpenWish w;
  w.t2o = kMulticast | 6;
  ASSERT_EQ(master.open_status(w), "00");
  OpenWish other = listen_only(2);
  other.path = "20 04 2C 1F 2C 46";
  EXPECT_EQ(master.open_status(other), "01 0119");
  other = listen_only(2);
  other.t2o = 0x4800 | 6;
  EXPECT_EQ(master.open_status(other), "01 0124");
}

TEST(ConnectionLimitsTest, TwoOwnersShareNoPoint) {
  AdapterOptions options;
  options.connections.exclusive_owners = 2;
  AdapterBench bench(options);
  auto master = Master::registered(bench);
  EXPECT_EQ(master.open_status({}), "00");
  OpenWish w;
  w.serial = 2;
  EXPECT_EQ(master.open_status(w), "01 0106");
  w.path = "20 04 2C 14 2C 46";
  EXPECT_EQ(master.open_status(w), "00");
}

TEST(ConnectionPortTest, MulticastAddressFollowsTheNetmask) {
  AdapterBench bench;
  bench.adapter.start({ipv4(192, 168, 1, 5), ipv4(255, 255, 0, 0), 2222});
  auto master = Master::registered(bench);
  OpenWish w;
  w.t2o = kMulticast | 6;
  master.open(w);
  // Host 0105h: 260 times 32 above 239.192.1.0.
  EXPECT_EQ(to_hex(ByteView(master.last).last(16)), "00 02 08 AE EF C0 21 80 00 00 00 00 00 00 00 00");
}

TEST(ConnectionLimitsTest, OutOfConnections) {
  AdapterOptions options;
  options.connections.io_connections = 2;
  options.connections.explicit_connections = 1;
  AdapterBench bench(options);
  auto master = Master::registered(bench);
  EXPECT_EQ(master.open_status(input_only(1)), "00");
  EXPECT_EQ(master.open_status(input_only(2)), "00");
  EXPECT_EQ(master.open_status(input_only(3)), "01 0113");
  EXPECT_EQ(master.open_status(explicit_one(4)), "00");
  EXPECT_EQ(master.open_status(explicit_one(5)), "01 0113");
}

TEST(ConnectionLimitsTest, FloodOfOpensFindsTheTableFullAndLeavesTheRestAlone) {
  AdapterOptions options;
  options.connections.io_connections = options.connections.explicit_connections = 1000;
  AdapterBench bench(options);
  auto master = Master::registered(bench);
  std::string last;
  for (unsigned serial = 1; serial < 300; ++serial)
    last = master.open_status(serial % 2 != 0 ? input_only(serial) : explicit_one(serial));
  EXPECT_EQ(last, "01 0113");
  EXPECT_EQ(bench.adapter.connections().io_connections() + bench.adapter.connections().explicit_connections(),
            ConnectionManager::kMaxConnections);
  bench.advance(std::chrono::seconds(11));
  EXPECT_EQ(bench.adapter.connections().io_connections(), 0u);
}

TEST_F(ConnectionOpeningTest, MulticastIsAnsweredWithGroupAndOurIdentifier) {
  OpenWish w;
  w.t2o = kMulticast | 6;
  const Bytes reply = master.open(w);
  ASSERT_EQ(reply.size(), 30u);
  EXPECT_NE(read_le32(reply, 8), w.t2o_id);
  // 127.0.0.5 of a class A network: host 5, so the fifth block of 32.
  EXPECT_EQ(to_hex(ByteView(master.last).subspan(master.last.size() - 20)),
            "01 80 10 00 00 02 08 AE EF C0 01 80 00 00 00 00 00 00 00 00");
}

TEST_F(ConnectionOpeningTest, FurtherConsumersShareTheMulticast) {
  OpenWish w;
  w.t2o = kMulticast | 6;
  const Bytes owner = master.open(w);
  const Bytes listener = master.open(listen_only(2));
  ASSERT_EQ(listener.size(), 30u);
  EXPECT_EQ(read_le32(listener, 8), read_le32(owner, 8));
  bench.advance(std::chrono::milliseconds(9));
  const auto packets = bench.take(Channel::kIo);
  ASSERT_EQ(packets.size(), 1u);  // one for both
  EXPECT_EQ(packets[0].to, (Ipv4Endpoint{ipv4(239, 192, 1, 128), 2222}));
}

TEST_F(ConnectionOpeningTest, AnotherKindOfMulticastIsAMismatch) {
  OpenWish w;
  w.t2o = kMulticast | 6;
  ASSERT_EQ(master.open_status(w), "00");
  const auto with = [&](void (*change)(OpenWish&)) {
    OpenWish other = listen_only(2);
    change(other);
    return master.open_status(other);
  };
  EXPECT_EQ(with([](OpenWish& o) { o.t2o = kMulticast | 10; }), "01 0134");
  EXPECT_EQ(with([](OpenWish& o) { o.t2o = kMulticast | 0x200 | 6; }), "01 0135");
  EXPECT_EQ(with([](OpenWish& o) { o.t2o = 0x2400 | 6; }), "01 0136");
  EXPECT_EQ(with([](OpenWish& o) {
              o.transport = 0x00;
              o.o2t = 0x4800;
              o.t2o = kMulticast | 4;
            }),
            "01 0137");
  EXPECT_EQ(with([](OpenWish& o) { o.transport = 0x11; }), "01 0138");
  EXPECT_EQ(with([](OpenWish& o) { o.t2o_rpi_us = 5000; }), "01 0112 0200 2710 0000 2710 0000");
  EXPECT_EQ(with([](OpenWish& o) { o.t2o = 0x4800 | 6; }), "01 0124");  // who listens, listens to the multicast
  EXPECT_EQ(with([](OpenWish& o) { o.t2o_rpi_us = 20'000; }), "00");
}

TEST_F(ConnectionOpeningTest, AnotherInhibitTimeOfAMulticastIsAMismatch) {
  OpenWish w = input_only(1);
  w.transport = 0x11;
  w.t2o = kMulticast | 6;
  w.path = "43 02 20 04 2C 1E 2C 47";
  ASSERT_EQ(master.open_status(w), "00");
  w.serial = 2;
  w.path = "43 03 20 04 2C 1E 2C 47";
  EXPECT_EQ(master.open_status(w), "01 0139");
}

TEST(ConnectionLimitsTest, MoreMulticastPointsThanGroupsCannotBe) {
  // Each produced point has at most one group, so a device with two points never uses more than two.
  AdapterBench bench;
  auto master = Master::registered(bench);
  OpenWish a = input_only(1), b = input_only(2);
  a.t2o = b.t2o = kMulticast | 6;
  b.path = "20 04 2C 1E 2C 46";
  master.open(a);
  const Bytes first = master.last;
  master.open(b);
  EXPECT_EQ(to_hex(ByteView(first).last(12).first(4)), "EF C0 01 80");
  EXPECT_EQ(to_hex(ByteView(master.last).last(12).first(4)), "EF C0 01 81");
}

TEST(ConnectionPortTest, AnotherPortThanTheStandardOneIsAnswered) {
  AdapterBench bench;
  bench.adapter.start({ipv4(127, 0, 0, 5), 0, 12'222});
  auto master = Master::registered(bench);
  master.open({});
  EXPECT_EQ(to_hex(ByteView(master.last).last(20)), "00 80 10 00 00 02 2F BE 00 00 00 00 00 00 00 00 00 00 00 00");
}

TEST_F(ConnectionOpeningTest, NullOpenPingsWithoutOpening) {
  OpenWish w;
  w.o2t = w.t2o = 0;
  w.path = "34 04 00 00 00 00 00 00 00 00";
  EXPECT_EQ(master.open_status(w), "00");
  w.path = "34 04 A2 00 00 00 00 00 00 00";
  EXPECT_EQ(master.open_status(w), "01 0114");
  w.path = "20 04 2C 16 2C 47";
  EXPECT_EQ(master.open_status(w), "01 012A");
  w.path = "20 04 2C 15 2C 48";
  EXPECT_EQ(master.open_status(w), "01 012B");
  EXPECT_EQ(bench.adapter.connections().io_connections(), 0u);
}

TEST_F(ConnectionOpeningTest, NullOpenBringsConfiguration) {
  OpenWish w;
  w.o2t = w.t2o = 0;
  w.path = "20 04 24 64 80 02 0A 0B 0C 0D";
  EXPECT_EQ(master.open_status(w), "00");
  EXPECT_EQ(to_hex(bench.device.configuration), "0A 0B 0C 0D");
  w.path = "20 04 24 64 80 01 0A 0B";
  EXPECT_EQ(master.open_status(w), "01 0126 0002");
}

TEST_F(ConnectionOpeningTest, NullOpenOfAnOpenConnectionAnswersAsItIs) {
  const std::uint32_t id = master.open_id({});
  OpenWish w;
  w.o2t = w.t2o = 0;
  const Bytes reply = master.open(w);
  ASSERT_EQ(reply.size(), 30u);
  EXPECT_EQ(read_le32(reply, 4), id);
  EXPECT_EQ(bench.adapter.connections().io_connections(), 1u);
}

}  // namespace
}  // namespace vinv::ethernet_ip
