// Get_Connection_Data, Search_Connection_Data, Get_Connection_Owner. CIP Vol 1, 3-5.5.5 to 3-5.5.7.
#include <gtest/gtest.h>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using test::AdapterBench;
using test::Master;
using test::OpenWish;
using test::to_hex;

class ConnectionServicesTest : public ::testing::Test {
 protected:
  ConnectionServicesTest() : master(Master::registered(bench)) {}
  AdapterBench bench;
  Master master;
};

TEST_F(ConnectionServicesTest, ConnectionDataByNumberAndByTriad) {
  OpenWish w;
  w.multiplier = 2;
  w.t2o_rpi_us = 20'000;
  const std::uint32_t id = master.open_id(w);
  const std::string hex_id = to_hex(test::le32(id));
  const std::string data = "01 00 03 00 AE 08 AE 08 01 00 37 13 2A 00 00 00 " + hex_id + " " + hex_id +
                           " 02 00 00 00 10 27 00 00 10 27 00 00 44 33 22 11 44 33 22 11 02 00 00 00 20 4E 00 00 "
                           "20 4E 00 00";
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 01 00"), "D6 00 00 00 " + data);
  EXPECT_EQ(master.request_hex("57 02 20 06 24 01 01 00 37 13 2A 00 00 00"), "D7 00 00 00 " + data);
}

// It gets the multicast that there is, more often than it asked for.
TEST_F(ConnectionServicesTest, DataOfAFurtherConsumerHaveItsWishAndTheActualInterval) {
  OpenWish w;
  w.t2o = 0x2800 | 6;
  ASSERT_NE(master.open_id(w), 0u);
  w.serial = 2;
  w.o2t = 0x4800 | 2;
  w.t2o_rpi_us = 20'000;
  w.path = "20 04 2C 1F 2C 47";
  ASSERT_NE(master.open_id(w), 0u);
  const std::string data = master.request_hex("56 02 20 06 24 01 02 00");
  EXPECT_EQ(data.substr(data.size() - 23), "20 4E 00 00 10 27 00 00");
}

TEST_F(ConnectionServicesTest, NumberOfAClosedConnectionIsFree) {
  OpenWish w;
  ASSERT_NE(master.open_id(w), 0u);
  w.serial = 2;
  w.o2t = 0x4800 | 2;
  w.path = "20 04 2C 1E 2C 47";
  ASSERT_NE(master.open_id(w), 0u);
  master.close({});
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 01 00"), "D6 00 05 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 02 00").substr(0, 17), "D6 00 00 00 02 00");
}

TEST_F(ConnectionServicesTest, UnknownConnectionsAreRefused) {
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 01 00"), "D6 00 05 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 00 00"), "D6 00 05 00");
  EXPECT_EQ(master.request_hex("57 02 20 06 24 01 01 00 37 13 2A 00 00 00"), "D7 00 05 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 01"), "D6 00 13 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 01 01 00 00"), "D6 00 15 00");
}

TEST_F(ConnectionServicesTest, OwnerWithItsLastWord) {
  const std::uint32_t id = master.open_id({});
  EXPECT_EQ(master.request_hex("5A 02 20 06 24 01 00 03 20 04 2C 15 2C 47"),
            "DA 00 00 00 01 01 01 01 01 00 37 13 2A 00 00 00");
  master.send_io(id, 1, 1, "00 00 00 00");
  EXPECT_EQ(master.request_hex("5A 02 20 06 24 01 00 03 20 04 2C 15 2C 47"),
            "DA 00 00 00 01 01 01 02 01 00 37 13 2A 00 00 00");
}

TEST_F(ConnectionServicesTest, NobodyOwnsAnUnconnectedPoint) {
  EXPECT_EQ(master.request_hex("5A 02 20 06 24 01 00 03 20 04 2C 15 2C 47"), "DA 00 01 01 07 01");
  EXPECT_EQ(master.request_hex("5A 02 20 06 24 01 00 04 20 04 2C 15 2C 47"), "DA 00 13 00");
  EXPECT_EQ(master.request_hex("5A 02 20 06 24 01 00 01 20 04"), "DA 00 04 00");
}

TEST_F(ConnectionServicesTest, OtherServicesAndInstancesAreNotThere) {
  EXPECT_EQ(master.request_hex("0E 03 20 06 24 01 30 01"), "8E 00 08 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 02 01 00"), "D6 00 16 00");
  EXPECT_EQ(master.request_hex("56 02 20 06 24 00 01 00"), "D6 00 08 00");
  EXPECT_EQ(master.request_hex("4E 02 20 06 24 01 0A 0E"), "CE 00 13 00");
}

}  // namespace
}  // namespace vinv::ethernet_ip
