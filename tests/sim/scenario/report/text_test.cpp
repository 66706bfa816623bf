#include "sim/scenario/report/text.hpp"

#include <gtest/gtest.h>

namespace vinv::scenario {
namespace {

TEST(ReportText, MarkupBecomesEntities) {
  EXPECT_EQ(html_text("<b a=\"1\" b='2'>&amp;</b>"), "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;amp;&lt;/b&gt;");
}

TEST(ReportText, WhatIsNoUtf8IsReplaced) {
  EXPECT_EQ(clean_utf8("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(clean_utf8("\xF0\x9F\x98\x80"), "\xF0\x9F\x98\x80");
  EXPECT_EQ(clean_utf8("a\xFF"
                       "b"),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(clean_utf8("\xC0\xBC"
                       "x"),
            "\xEF\xBF\xBD\xEF\xBF\xBDx")
      << "an overlong < stays no <";
  EXPECT_EQ(clean_utf8("\xED\xA0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD") << "a surrogate";
  EXPECT_EQ(clean_utf8("\xE2\x82"), "\xEF\xBF\xBD\xEF\xBF\xBD") << "a sequence that ends early";
  EXPECT_EQ(clean_utf8(std::string_view("\0\x1B[0m\t\n", 7)), "\xEF\xBF\xBD\xEF\xBF\xBD[0m\t\n");
}

TEST(ReportText, JsonCannotEndItsScriptElement) {
  EXPECT_EQ(json_for_script(R"({"a":"</script><!--&"})"), "{\"a\":\"\\u003c/script\\u003e\\u003c!--\\u0026\"}");
}

TEST(ReportText, FileNamesBecomeUrls) {
  EXPECT_EQ(url_text("a b\"#?%javascript:.html"), "a%20b%22%23%3F%25javascript%3A.html");
}

TEST(ReportText, CsvFieldsAreQuotedWhereTheyMustBe) {
  EXPECT_EQ(csv_field("plain text"), "plain text");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_field("=HYPERLINK(\"x\")"), "\"'=HYPERLINK(\"\"x\"\")\"");
}

TEST(ReportText, SecondsAreExact) {
  EXPECT_EQ(seconds_text(Instant{}), "0.000");
  EXPECT_EQ(seconds_text(instant_from_ns(3'412'000'000)), "3.412");
  EXPECT_EQ(seconds_text(instant_from_ns(125)), "0.000000125");
  EXPECT_EQ(seconds_text(instant_from_ns(60'000'000'500)), "60.0000005");
  EXPECT_EQ(seconds_text(instant_from_ns(-1'500'000'000)), "-1.500");
}

TEST(ReportText, PathsOfThisMachineAreNotShown) {
  EXPECT_EQ(shown_path("scenarios/fr-e500/stop.yaml"), "scenarios/fr-e500/stop.yaml");
  EXPECT_EQ(shown_path("/srv/somebody/plant/stop.yaml"), "plant/stop.yaml");
  EXPECT_EQ(shown_path("/stop.yaml"), "stop.yaml");
}

}  // namespace
}  // namespace vinv::scenario
