#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sim/base/bytes.hpp"
#include "sim/base/random.hpp"
#include "sim/base/result.hpp"
#include "sim/base/table_text.hpp"
#include "sim/base/time.hpp"

namespace vinv {
namespace {

TEST(Time, ConvertsSecondsToTheNearestNanosecond) {
  EXPECT_EQ(seconds_to_duration(0.001).count(), 1'000'000);
  EXPECT_EQ(seconds_to_duration(-1e-9).count(), -1);
  EXPECT_DOUBLE_EQ(to_seconds(instant_from_ns(2'500'000'000)), 2.5);
}

TEST(Bytes, WordsKeepTheirOrder) {
  Bytes b;
  append_be16(b, 0x1234);
  append_le16(b, 0x1234);
  append_be32(b, 0x01020304);
  append_le32(b, 0x01020304);
  EXPECT_EQ(b, (Bytes{0x12, 0x34, 0x34, 0x12, 1, 2, 3, 4, 4, 3, 2, 1}));
  EXPECT_EQ(read_be16(b, 0), 0x1234);
  EXPECT_EQ(read_le16(b, 2), 0x1234);
  EXPECT_EQ(read_be32(b, 4), 0x01020304u);
  EXPECT_EQ(read_le32(b, 8), 0x01020304u);
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<int, std::string> good = 3;
  const Result<int, std::string> bad = Unexpected(std::string("out of range"));
  EXPECT_TRUE(good);
  EXPECT_EQ(*good, 3);
  EXPECT_FALSE(bad);
  EXPECT_EQ(bad.error(), "out of range");
  EXPECT_EQ(bad.value_or(7), 7);
  const Result<void, int> done;
  EXPECT_TRUE(done);
}

TEST(Result, GivesUpAValueThatCanOnlyMove) {
  const auto make = []() -> Result<std::unique_ptr<int>, std::string> { return std::make_unique<int>(5); };
  const std::unique_ptr<int> moved = *make();
  EXPECT_EQ(*moved, 5);
}

TEST(ResultDeathTest, AskingForWhatIsNotThereIsABugOfOurs) {
  const Result<int, std::string> bad = Unexpected(std::string("no"));
  const Result<int, std::string> good = 1;
  EXPECT_DEATH(static_cast<void>(bad.value()), "broken invariant");
  EXPECT_DEATH(static_cast<void>(good.error()), "broken invariant");
}

TEST(TableText, FieldsAreTakenOneByOneAndEmptyOnesHaveAFallback) {
  std::string_view line = "3F,,0x10,-5";
  EXPECT_EQ(number_of_field<std::uint8_t>(take_until(line, ','), 0, 16), 0x3f);
  EXPECT_EQ(number_of_field<std::uint16_t>(take_until(line, ','), 7), 7);
  EXPECT_EQ(number_of_field<std::uint16_t>(take_until(line, ','), 0), 16);
  EXPECT_EQ(number_of_field<std::int64_t>(take_until(line, ','), 0), -5);
  EXPECT_TRUE(line.empty());
}

TEST(TableTextDeathTest, FieldThatIsNoNumberOfItsTypeIsABugOfOurs) {
  for (const std::string_view field : {"256", "-1", "1x", "x"}) {
    EXPECT_DEATH(static_cast<void>(number_of_field<std::uint8_t>(field, 0)), "broken invariant") << field;
  }
}

TEST(Random, SequenceIsPartOfTheTrace) {
  Random r(42);
  EXPECT_EQ(r.next(), 13679457532755275413ULL);
  EXPECT_EQ(r.next(), 2949826092126892291ULL);
}

}  // namespace
}  // namespace vinv
