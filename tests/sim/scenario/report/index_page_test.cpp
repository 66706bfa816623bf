#include "sim/scenario/report/index_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/scenario/report/sample_run.hpp"

namespace vinv::scenario {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(IndexPage, HasARowForEachRunWithItsFirstFailure) {
  IndexEntry failed = index_entry(small_run());
  failed.page = "fr-e500_stop.html";
  failed.files = {{"signals.csv", "fr-e500_stop.csv"}};
  RunResult good = small_run();
  good.verdict = Verdict::kPassed;
  good.checks.pop_back();
  const std::string page = index_page({failed, index_entry(good)}, "build 1");
  EXPECT_THAT(page, HasSubstr("<h1>Scenarios: 1 passed, 1 failed, 0 could not run</h1>"));
  EXPECT_THAT(page, HasSubstr("<p class=\"verdict failed\">failed</p>"));
  EXPECT_THAT(
      page, HasSubstr("<tr class=\"failed\"><td>failed</td><td><a href=\"fr-e500_stop.html\">A short stop trips on "
                      "over-voltage</a><br><small>scenarios/fr-e500/stop.yaml, seed 7</small></td>"
                      "<td class=\"n\" data-sort=\"20000000\">0.020</td><td class=\"n\" data-sort=\"1\">1 of 2</td>"
                      "<td><a href=\"fr-e500_stop.html#t=0.020\">0.020 s</a> fan alarm: expected none, seen E.OV3</td>"
                      "<td><a href=\"fr-e500_stop.csv\">signals.csv</a></td></tr>"));
  EXPECT_THAT(page, HasSubstr("<tr class=\"passed\"><td>passed</td>"));
}

TEST(IndexPage, ARunThatCouldNotBeginHasItsReason) {
  RunResult r;
  r.name = "stop";
  r.reason = "stop.yaml:3:5: unknown word <runn>";
  const std::string page = index_page({index_entry(r)}, "");
  EXPECT_THAT(page, HasSubstr("unknown word &lt;runn&gt;"));
  EXPECT_THAT(page, HasSubstr("<tr class=\"notrun\"><td>not run</td><td>stop<br>"));
}

TEST(IndexPage, AFileThatCouldNotBeWrittenIsNamedAndNotLinked) {
  IndexEntry e = index_entry(small_run());
  e.unwritten = {"out/stop.html.new cannot be written: No space left on device."};
  const std::string page = index_page({e}, "");
  EXPECT_THAT(page, HasSubstr("out/stop.html.new cannot be written: No space left on device."));
  EXPECT_THAT(page, Not(HasSubstr("<a ")));
}

}  // namespace
}  // namespace vinv::scenario
