#include "option_boards/canopen/object_table.hpp"

#include <gtest/gtest.h>

namespace vinv::canopen {
namespace {

constexpr std::array<std::string_view, 1> kItems{"thing"};

TEST(CanopenObjectTable, FindsRangesAndSubIndices) {
  const ObjectTable table(
      "head\n"
      "1000,,0,,UNSIGNED32,RO,,constant,,0x10192,,,\n"
      "2000,20ff,0,,UNSIGNED8,RO,,constant,,2,,,\n"
      "2000,20ff,1,2,INTEGER16,RW,rt,thing,7,,-3,4,\n",
      kItems);
  ASSERT_NE(table.find(0x1000), nullptr);
  EXPECT_EQ(table.find(0x0fff), nullptr);
  EXPECT_EQ(table.find(0x1001), nullptr);
  EXPECT_EQ(table.find(0x2100), nullptr);
  EXPECT_EQ(table.find(0x2080, 3), nullptr);
  EXPECT_EQ(table.find(0x1000, 1), nullptr);
  const ObjectRow* entries = table.find(0x20ff, 0);
  const ObjectRow* thing = table.find(0x2000, 2);
  ASSERT_TRUE(entries != nullptr && thing != nullptr);
  EXPECT_EQ(entries->raw_default, 2u);
  EXPECT_FALSE(entries->writable);
  EXPECT_EQ(thing->item, kFirstApplicationItem);
  EXPECT_EQ(thing->argument, 7u);
  EXPECT_EQ(thing->min, -3);
  EXPECT_EQ(thing->max, 4);
  EXPECT_TRUE(thing->in_rpdo && thing->in_tpdo && thing->readable && thing->writable);
  EXPECT_EQ(thing->value_of(0xfffe), -2);
}

TEST(CanopenObjectTableDeathTest, MistakesEndTheProcess) {
  EXPECT_DEATH(ObjectTable("head\n2000,,0,,REAL32,RO,,constant,,,,,\n", kItems), "");
  EXPECT_DEATH(ObjectTable("head\n2000,,0,,UNSIGNED8,RX,,constant,,,,,\n", kItems), "");
  EXPECT_DEATH(ObjectTable("head\n2000,,0,,UNSIGNED8,RO,,nothing,,,,,\n", kItems), "");
  EXPECT_DEATH(ObjectTable("head\n2000,,0,,UNSIGNED8,RO,,thing,,,,,\n1000,,0,,UNSIGNED8,RO,,thing,,,,,\n", kItems), "");
}

}  // namespace
}  // namespace vinv::canopen
