// Which values the cases of a plan have.
#include "sim/campaign/plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/sim/campaign/support.hpp"

namespace vinv::campaign {
namespace {

using testing::read;

std::vector<std::string> column(const Campaign& c, const std::string& axis) {
  std::vector<std::string> out;
  for (std::uint64_t k = 1; k <= c.cases(); ++k)
    for (const auto& [name, value] : c.assignment(k))
      if (name == axis) out.push_back(value);
  return out;
}

TEST(Plan, GridHasEachValueWithEachOther) {
  const Campaign c = read("  - grid: { speed: [5 Hz, 6 Hz], pause: { from: 1 s, to: 2 s, count: 3 } }\n");
  EXPECT_EQ(c.cases(), 6u);
  EXPECT_EQ(column(c, "speed"), (std::vector<std::string>{"5 Hz", "5 Hz", "5 Hz", "6 Hz", "6 Hz", "6 Hz"}));
  EXPECT_EQ(column(c, "pause"), (std::vector<std::string>{"1 s", "1.5 s", "2 s", "1 s", "1.5 s", "2 s"}));
}

TEST(Plan, StepsEndWithTheLastThatFitsAndKeepTheirDecimals) {
  const Campaign c = read("  - grid: { speed: { from: 5.0 Hz, to: 5.89 Hz, step: 0.3 Hz } }\n");
  EXPECT_EQ(column(c, "speed"), (std::vector<std::string>{"5 Hz", "5.3 Hz", "5.6 Hz"}));
  const Campaign down = read("  - grid: { speed: { from: 9 Hz, to: 5 Hz, step: 2 Hz } }\n");
  EXPECT_EQ(column(down, "speed"), (std::vector<std::string>{"9 Hz", "7 Hz", "5 Hz"}));
}

TEST(Plan, LogarithmicSpacingMultiplies) {
  const Campaign c = read("  - grid: { pause: { from: 1 ms, to: 1000 ms, count: 4, spacing: logarithmic } }\n");
  EXPECT_EQ(column(c, "pause"), (std::vector<std::string>{"1 ms", "10 ms", "100 ms", "1000 ms"}));
}

TEST(Plan, BoundaryHasMiddleEdgesAndCorners) {
  const Campaign c = read("  - boundary: { speed: { from: 4 Hz, to: 8 Hz, step: 1 Hz }, pause: [1 s, 2 s, 3 s] }\n");
  EXPECT_EQ(column(c, "speed"), (std::vector<std::string>{"6 Hz", "4 Hz", "8 Hz", "5 Hz", "7 Hz", "6 Hz", "6 Hz",
                                                          "4 Hz", "4 Hz", "8 Hz", "8 Hz"}));
  EXPECT_EQ(column(c, "pause"),
            (std::vector<std::string>{"2 s", "2 s", "2 s", "2 s", "2 s", "1 s", "3 s", "1 s", "3 s", "1 s", "3 s"}));
}

TEST(Plan, LatinHypercubeHasOneValueInEachPart) {
  const Campaign c = read(
      "  - latin_hypercube: { speed: { from: 0 Hz, to: 50 Hz }, pause: { from: 1 s, to: 51 s } }\n    samples: 50\n");
  for (const char* axis : {"speed", "pause"}) {
    std::set<int> parts;
    for (const std::string& v : column(c, axis))
      parts.insert(static_cast<int>(std::stod(v) - (axis[0] == 'p' ? 1 : 0)));
    EXPECT_EQ(parts.size(), 50u) << axis;
  }
  std::set<int> distances;
  const auto a = column(c, "speed"), b = column(c, "pause");
  for (std::size_t i = 0; i < a.size(); ++i)
    distances.insert(static_cast<int>(std::stod(a[i])) - static_cast<int>(std::stod(b[i])));
  EXPECT_GT(distances.size(), 20u) << "both go through their parts in the same order";
}

TEST(Plan, RandomValuesFillTheRangeAndDependOnTheSeed) {
  const std::string block = "  - random: { speed: { from: 0 Hz, to: 10 Hz } }\n    samples: 400\n";
  const Campaign c = read(block);
  std::map<int, int> tenths;
  for (const std::string& v : column(c, "speed")) ++tenths[static_cast<int>(std::stod(v))];
  for (int i = 0; i < 10; ++i) EXPECT_GT(tenths[i], 15) << i;
  const Campaign same = read(block);
  const Campaign other = parse_campaign(testing::file(block) + "seed: 2\n", "test.yaml", testing::load_options());
  EXPECT_EQ(column(c, "speed"), column(same, "speed"));
  EXPECT_NE(column(c, "speed"), column(other, "speed"));
}

TEST(Plan, PlansOfOneBlockMultiplyAndBlocksAdd) {
  const Campaign c = read(
      "  - { grid: { speed: [5 Hz, 6 Hz] }, random: { pause: [1 s, 2 s] }, samples: 3 }\n"
      "  - set: { speed: 7 Hz }\n");
  EXPECT_EQ(c.cases(), 7u);
  EXPECT_EQ(column(c, "speed"), (std::vector<std::string>{"5 Hz", "5 Hz", "5 Hz", "6 Hz", "6 Hz", "6 Hz", "7 Hz"}));
  EXPECT_EQ(column(c, "pause").size(), 6u);
}

TEST(Plan, PermutationReachesEverythingOnce) {
  for (const std::uint64_t n : {1u, 2u, 3u, 17u, 1000u}) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::uint64_t to = permuted(i, n, 42);
      EXPECT_LT(to, n);
      seen.insert(to);
    }
    EXPECT_EQ(seen.size(), n);
  }
}

}  // namespace
}  // namespace vinv::campaign
