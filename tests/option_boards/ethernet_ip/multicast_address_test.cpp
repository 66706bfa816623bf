// CIP Vol 2, 3-5.3.
#include "option_boards/ethernet_ip/multicast_address.hpp"

#include <gtest/gtest.h>

#include "sim/base/ipv4.hpp"

namespace vinv::ethernet_ip {
namespace {

TEST(MulticastAddressTest, HostOneHasTheFirstGroup) {
  EXPECT_EQ(ipv4_text(first_multicast_address(ipv4(192, 168, 1, 1), 0xffffff00)), "239.192.1.0");
}

TEST(MulticastAddressTest, EachHostHasThirtyTwoGroups) {
  EXPECT_EQ(ipv4_text(first_multicast_address(ipv4(192, 168, 1, 2), 0xffffff00)), "239.192.1.32");
  EXPECT_EQ(ipv4_text(first_multicast_address(ipv4(192, 168, 1, 10), 0xffffff00)), "239.192.2.32");
  EXPECT_EQ(ipv4_text(first_multicast_address(ipv4(192, 168, 1, 254), 0xffffff00)), "239.192.32.160");
}

TEST(MulticastAddressTest, OnlyTenBitsOfTheHostCount) {
  EXPECT_EQ(first_multicast_address(ipv4(10, 0, 4, 1), 0xffff0000),
            first_multicast_address(ipv4(10, 0, 0, 1), 0xffff0000));
  EXPECT_EQ(ipv4_text(first_multicast_address(ipv4(10, 0, 4, 0), 0xffff0000)), "239.192.128.224");
}

TEST(MulticastAddressTest, MaskFollowsTheClassOfTheAddress) {
  EXPECT_EQ(mask_by_class(ipv4(10, 1, 2, 3)), 0xff000000u);
  EXPECT_EQ(mask_by_class(ipv4(172, 16, 0, 1)), 0xffff0000u);
  EXPECT_EQ(mask_by_class(ipv4(192, 168, 1, 1)), 0xffffff00u);
}

TEST(Ipv4Test, TextAndNumber) {
  EXPECT_EQ(parse_ipv4("127.0.0.2"), ipv4(127, 0, 0, 2));
  EXPECT_EQ(ipv4_text(ipv4(10, 0, 255, 1)), "10.0.255.1");
  for (const char* bad :
       {"", "1.2.3", "1.2.3.4.5", "256.1.1.1", "1.2.3.", "1..2.3", "1.2.3.4 ", "0001.2.3.4", "a.b.c.d"})
    EXPECT_FALSE(parse_ipv4(bad)) << bad;
}

}  // namespace
}  // namespace vinv::ethernet_ip
