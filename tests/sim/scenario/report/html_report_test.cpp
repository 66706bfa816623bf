#include "sim/scenario/report/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "sim/scenario/report/html_data.hpp"
#include "tests/sim/scenario/report/sample_run.hpp"

namespace vinv::scenario {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kBuild = "vinverter 0.1.0 (abc1234)";

// The page without its data and scripts: what a reader without scripts has.
std::string readable_part(const std::string& page) { return page.substr(0, page.find("</main>")); }

TEST(HtmlReport, DataOfASmallRunIsThis) {
  RunResult r = small_run();
  r.recording.wire = {wire(1, WireRecord::Kind::kCanFrame, "can", "master", 0x605, {0x40, 0x41}),
                      wire(3, WireRecord::Kind::kSerial, "rtu", "fan", 0, {})};
  std::string page;
  append_data_elements(page, r);
  EXPECT_EQ(page,
            "<script type=\"application/json\" id=\"run\">{\"name\":\"stop\",\"end\":0.020,"
            "\"columns\":[{\"drive\":\"fan\",\"name\":\"output_frequency\",\"unit\":\"Hz\"},"
            "{\"drive\":\"fan\",\"name\":\"fan\",\"unit\":\"-\",\"constant\":true}],"
            "\"states\":[{\"drive\":\"fan\",\"name\":\"alarm\",\"lost\":0,\"words\":[\"none\",\"E.OV3\"],"
            "\"t\":[0.000,0.010],\"v\":[0,1]}],"
            "\"events\":[[0.000,\"action\",\"fan\",\"run: forward\",12],"
            "[0.010,\"trip\",\"fan\",\"trip E.OV3: DC link 802 V\",0]],"
            "\"checks\":[[0.005,true,\"output_frequency\"],[0.020,false,\"alarm\"]],"
            "\"wire\":{\"records\":2,\"shown\":2,\"networks\":[\"can\",\"rtu\"],\"senders\":[\"master\",\"fan\"]}}"
            "</script>\n"
            "<script type=\"text/plain\" id=\"times\">AAAAAAAAAAB7FK5H4XqEP3sUrkfhepQ/</script>\n"
            "<script type=\"text/plain\" id=\"c0\">AAAAAAAAoD9mZkhC</script>\n"
            "<script type=\"text/plain\" id=\"c1\">AACAPw==</script>\n"
            "<script type=\"text/plain\" id=\"wire\">1000000 0 0 0 605 4041\n2000000 2 1 1 0 </script>\n");
}

TEST(HtmlReport, TheEssentialsAreReadableWithoutScripts) {
  const std::string page = readable_part(html_report(nullptr, small_run(), kBuild, {{"signals.csv", "stop.csv"}}));
  for (const char* text :
       {"<p class=\"verdict failed\">failed</p>", "A short stop trips on over-voltage", "scenarios/fr-e500/stop.yaml",
        "0.020 s of virtual time", "1 of 2 failed", "<dt>seed</dt><dd>7</dd>", kBuild, "trip E.OV3: DC link 802 V",
        "<td>none</td><td>E.OV3</td><td class=\"n\">16</td>", "<b>Cause</b> DC link 802 V, deceleration 0.5 s",
        "<a class=\"t\" href=\"#t=0.020\">0.020</a>", "<a href=\"stop.csv\">signals.csv</a>",
        "3 samples of 2 signals, every 10 ms, and every 1 ms in 1 span around what happened."}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_LT(page.find("<td>alarm</td>"), page.find("<td>output_frequency</td>")) << "failed checks come first";
}

TEST(HtmlReport, TheEventsBeforeAFailedCheckGoWithIt) {
  RunResult r = small_run();
  r.events.assign(9, {at_ms(1), Event::Kind::kState, "fan", "", 0});
  for (std::size_t i = 0; i < r.events.size(); ++i) r.events[i].text = "event " + std::to_string(i);
  r.checks[1].events_before = 7;
  const std::string page = readable_part(html_report(nullptr, r, "", {}));
  const std::string checks = page.substr(0, page.find("id=\"signals\""));
  EXPECT_THAT(checks, Not(HasSubstr("event 1<")));
  EXPECT_THAT(checks, HasSubstr("event 2<"));
  EXPECT_THAT(checks, HasSubstr("event 6<"));
  EXPECT_THAT(checks, Not(HasSubstr("event 7<")));
}

TEST(HtmlReport, ARunThatCouldNotBeginSaysWhy) {
  RunResult r;
  r.path = "stop.yaml";
  r.name = "stop";
  r.reason = "stop.yaml:3:5: unknown word runn; did you mean run?";
  const std::string page = readable_part(html_report(nullptr, r, kBuild, {}));
  EXPECT_THAT(page, HasSubstr("<p class=\"verdict notrun\">not run</p>"));
  EXPECT_THAT(page, HasSubstr(r.reason));
}

TEST(HtmlReport, TheDrivesOfThePlantAndTheVariablesAreListed) {
  Scenario s;
  rig::DriveSpec d;
  d.name = "fan";
  d.model.value = "FR-E540-1.5K";
  d.board.emplace();
  d.board->type.value = "oi-fr-e5nco";
  d.board->node.value = 5;
  s.plant.drives.push_back(d);
  s.variables["speed"] = "40 Hz";
  const std::string page = readable_part(html_report(&s, small_run(), kBuild, {}));
  EXPECT_THAT(page, HasSubstr("<td>fan</td><td>FR-E540-1.5K</td><td>oi-fr-e5nco, node 5</td>"));
  EXPECT_THAT(page, HasSubstr("<td>speed</td><td>40 Hz</td>"));
}

// Every text of a run that a scenario file can choose, as an attack.
TEST(HtmlReport, NoTextOfAScenarioCanBecomeMarkup) {
  const std::string evil = "</script><script>alert(1)</script><img src=x onerror=\"alert(1)\">'<!--\xC0\xBC";
  RunResult r = small_run();
  r.recording.wire = sample_wire();
  Scenario s;
  s.plant.drives.emplace_back();
  s.plant.drives[0].name = s.plant.drives[0].model.value = evil;
  s.plant.drives[0].board.emplace();
  s.plant.drives[0].board->type.value = evil;
  s.variables[evil] = evil;
  r.path = r.name = r.title = r.reason = evil;
  for (Event& e : r.events) e.drive = e.text = evil;
  for (CheckResult& c : r.checks) c.drive = c.what = c.expected = c.seen = c.cause = evil;
  for (SignalColumn& c : r.recording.columns) c.drive = c.name = c.unit = evil;
  for (StateTrace& t : r.recording.states) {
    t.drive = t.name = evil;
    for (auto& change : t.changes) change.value = evil;
  }
  for (WireRecord& w : r.recording.wire) w.network = w.sender = evil;
  const std::string page = html_report(&s, r, evil, {{evil, evil}});
  const std::string plain = html_report(nullptr, small_run(), "", {});
  const auto count = [](const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count(page, "<script"), count(plain, "<script"));
  EXPECT_EQ(count(page, "</script"), count(plain, "</script"));
  EXPECT_EQ(count(page, "<!--"), count(plain, "<!--"));
  EXPECT_EQ(count(page, "<img"), 0U);
  EXPECT_EQ(count(page, "onerror=\""), 0U) << "a quotation mark would end an attribute";
  EXPECT_EQ(count(page, "\xC0"), 0U);
}

TEST(HtmlReport, NeedsNothingFromOutside) {
  const std::string page = html_report(nullptr, small_run(), kBuild, {});
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("MIT License")) << "of the library that the page contains";
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"[^\"#]*//"))) << "a reference to another machine";
  EXPECT_THAT(page, Not(HasSubstr("@import")));
}

TEST(HtmlReport, LongTablesAreCutWhereThereAreNoScripts) {
  RunResult r = small_run();
  r.events.assign(kMaxEventsWithoutScripts + 7, r.events[0]);
  EXPECT_THAT(readable_part(html_report(nullptr, r, "", {})), HasSubstr("<p>7 more: in the events file.</p>"));
  r.checks.assign(kMaxChecksShown + 3, r.checks[0]);
  EXPECT_THAT(readable_part(html_report(nullptr, r, "", {})), HasSubstr("<p>3 more passed or failed.</p>"));
}

TEST(HtmlReport, TheSameRunGivesTheSameBytes) {
  EXPECT_EQ(html_report(nullptr, long_run(1000), kBuild, {}), html_report(nullptr, long_run(1000), kBuild, {}));
}

}  // namespace
}  // namespace vinv::scenario
