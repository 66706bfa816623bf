#include "option_boards/boards/make_board.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/support/fake_drive.hpp"

namespace vinv::boards {
namespace {

TEST(MakeBoard, MakesEveryTypeItNames) {
  test::FakeDrive drive;
  for (const auto name : board_types()) {
    const auto board = make_board({std::string(name), 5}, drive);
    ASSERT_TRUE(board) << name;
    EXPECT_EQ((*board)->type(), name);
    EXPECT_FALSE(board_families(name).empty());
  }
}

TEST(MakeBoard, BoardsFitTheirFamily) {
  EXPECT_EQ(board_families("oi-fr-e5nco"), std::vector<std::string_view>{"fr-e500"});
  EXPECT_EQ(board_families("fr-a7ne"), std::vector<std::string_view>{"fr-a700"});
  EXPECT_TRUE(board_families("fr-a7nd").empty());
}

TEST(MakeBoard, RefusesAnUnknownTypeNamingWhatIsAllowed) {
  test::FakeDrive drive;
  const auto board = make_board({"oi-fr-e5nc", 5}, drive);
  ASSERT_FALSE(board);
  EXPECT_EQ(board.error(), "unknown board type \"oi-fr-e5nc\"; allowed: oi-fr-e5nco, fr-a7ne");
}

TEST(MakeBoard, RefusesANodeOutsideOneToNinetyNine) {
  test::FakeDrive drive;
  for (const unsigned node : {0u, 100u, 255u, 1000u}) {
    const auto board = make_board({"oi-fr-e5nco", node}, drive);
    ASSERT_FALSE(board) << node;
    EXPECT_EQ(board.error(),
              "node " + std::to_string(node) + " of board oi-fr-e5nco is out of range; allowed: 1 to 99");
  }
  EXPECT_TRUE(make_board({"oi-fr-e5nco", 1}, drive));
  EXPECT_TRUE(make_board({"oi-fr-e5nco", 99}, drive));
}

TEST(MakeBoard, SwitchesAreDigitsByTheirPrintedNames) {
  test::FakeDrive drive;
  auto board = make_board({"oi-fr-e5nco", 5}, drive);
  ASSERT_TRUE(board);
  EXPECT_TRUE((*board)->set_switch("SW1", 9));
  EXPECT_TRUE((*board)->set_switch("SW2", 0));
  EXPECT_EQ((*board)->set_switch("SW1", 10).error(), "SW1 is a digit, 0 to 9; 10 is not");
  EXPECT_EQ((*board)->set_switch("SW3", 1).error(),
            "oi-fr-e5nco has no switch \"SW3\"; it has SW1 (tens) and SW2 (units)");
}

}  // namespace
}  // namespace vinv::boards
