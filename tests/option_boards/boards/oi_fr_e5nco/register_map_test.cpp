// The address map as a table. OI-FR-E5NCO manual, 8.7 and 11.3.
#include "option_boards/boards/oi_fr_e5nco/register_map.hpp"

#include <gtest/gtest.h>

namespace vinv::boards::oi_fr_e5nco {
namespace {

TEST(RegisterMap, NoAddressHasTwoMeanings) {
  const RegisterMap& map = register_map();
  for (std::uint32_t address = 0; address <= 0xffff; ++address) {
    int readers = 0, writers = 0, rows = 0;
    for (const RegisterRow& row : map.rows()) {
      if (!row.contains(address)) continue;
      ++rows;
      readers += row.readable;
      writers += row.writable;
    }
    EXPECT_LE(readers, 1) << address;
    EXPECT_LE(writers, 1) << address;
    EXPECT_LE(rows, 2) << address;
  }
}

TEST(RegisterMap, HoldsTheRangesOfTheManualsTableAndNothingElse) {
  // 8.7: first, last, read, write.
  struct Printed {
    std::uint32_t first, last;
    bool read, write;
  };
  const Printed printed[] = {{20000, 21802, true, true},  {21812, 21998, true, true},  // 8.7.1 without Pr.902-905
                             {23000, 23006, true, false}, {23100, 23104, true, false}, {24000, 24000, true, true},
                             {24002, 24002, true, true},  {24004, 24004, true, true},  {24006, 24006, false, true},
                             {25000, 25000, false, true}, {25002, 25002, false, true}, {26000, 26000, false, true},
                             {27000, 27016, true, false}};
  for (std::uint32_t address = 0; address <= 0x10100; ++address) {
    bool read = false, write = false;
    for (const Printed& p : printed) {
      if (address < p.first || address > p.last || address % 2 != 0) continue;
      read |= p.read;
      write |= p.write;
    }
    ASSERT_EQ(register_map().find_readable(address) != nullptr, read) << address;
    ASSERT_EQ(register_map().find_writable(address) != nullptr, write) << address;
  }
}

TEST(RegisterMap, ParameterIndexIsHalfTheDistance) {
  EXPECT_EQ(register_map().find_readable(20014)->index_at(20014), 7);
  EXPECT_EQ(register_map().find_writable(21998)->index_at(21998), 999);
  EXPECT_EQ(register_map().find_readable(21812)->index_at(21812), 906);
}

TEST(RegisterMapDeathTest, MistakeInTheTableEndsTheProcess) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const auto header = std::string("first,last,step,access,item,index,min,max,value\n");
  EXPECT_DEATH(RegisterMap(header + "1,2,2,R,nonsense,0,,,\n"), "");
  EXPECT_DEATH(RegisterMap(header + "1,2,2,X,status,0,,,\n"), "");
  EXPECT_DEATH(RegisterMap(header + "4,2,2,R,status,0,,,\n"), "");
  EXPECT_DEATH(RegisterMap(header + "1x,2,2,R,status,0,,,\n"), "");
}

}  // namespace
}  // namespace vinv::boards::oi_fr_e5nco
