// Unit identifiers of Modbus/TCP. MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 4.4.1.2.
#include "option_boards/modbus/unit_table.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/modbus/scripted_unit.hpp"

namespace vinv::modbus {
namespace {

TEST(UnitTable, FindsUnitsByTheirPresentAddress) {
  test::ScriptedUnit a(5), b(63);
  UnitTable table;
  table.add(a);
  table.add(b);
  EXPECT_EQ(table.route(5), &a);
  EXPECT_EQ(table.route(63), &b);
  EXPECT_EQ(table.route(6), nullptr);
  b.address_ = 6;
  EXPECT_EQ(table.route(6), &b);
  EXPECT_EQ(table.route(63), nullptr);
}

TEST(UnitTable, ZeroAndTwoHundredFiftyFiveMeanTheOnlyUnit) {
  test::ScriptedUnit a(5), b(63);
  UnitTable table;
  EXPECT_EQ(table.route(0), nullptr);
  table.add(a);
  EXPECT_EQ(table.route(0), &a);
  EXPECT_EQ(table.route(255), &a);
  table.add(b);
  EXPECT_EQ(table.route(0), nullptr);
  EXPECT_EQ(table.route(255), nullptr);
}

TEST(UnitTable, UnitThatDoesNotListenIsNobody) {
  test::ScriptedUnit a(0);
  UnitTable table;
  table.add(a);
  EXPECT_EQ(table.route(0), nullptr);
  EXPECT_EQ(table.route(255), nullptr);
}

TEST(UnitTable, OfTwoUnitsWithOneAddressTheFirstAnswers) {
  test::ScriptedUnit a(5), b(5);
  UnitTable table;
  table.add(a);
  table.add(b);
  EXPECT_EQ(table.route(5), &a);
}

}  // namespace
}  // namespace vinv::modbus
