// A run is saved and goes on as another one: its result is that of a run that nobody interrupted.
#include "sim/scenario/virtual_run.hpp"

#include <algorithm>

#include "sim/base/random.hpp"
#include "sim/scenario/batch.hpp"
#include "sim/scenario/junit.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_report.hpp"
#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::failures;
using testing::read;

// Tracks, loops, waits of every kind, spans, ramps, a trip with its window, commands that take time: 20 s of them.
constexpr const char* kStory =
    "# Two drives and all that a scenario can wait for.\n"
    "plant:\n"
    "  networks: { line: { can: virtual } }\n"
    "  drives:\n"
    "    - { name: a, inverter: { model: FR-E540-0.75K }, board: { node: 5, network: line },\n"
    "        load: { inertia_kg_m2: 0.002, torque: { constant_Nm: 0.5 } }, parameters: { Pr.7: 0.5, Pr.8: 0.5 } }\n"
    "    - { name: b, inverter: { model: FR-E540-1.5K }, parameters: { Pr.7: 4.0, Pr.8: 4.0 } }\n"
    "limit: 60 s\n"
    "allow_trips: [E.OHT]\n"
    "tracks:\n"
    "  first:\n"
    "    - { drive: a, when: ready, reference: 20 Hz }\n"
    "    - { drive: a, after: 230 ms, run: forward }\n"
    "    - { drive: a, ramp: { signal: output_frequency, from: 1 Hz, to: 20 Hz, time: 190 ms, tolerance: 20 ms,\n"
    "        linearity: 1 Hz } }\n"
    "    - repeat:\n"
    "        times: 3\n"
    "        steps:\n"
    "          - { drive: a, after: 310 ms, mains: { dip: 20 %, for: 250 ms } }\n"
    "          - drive: a\n"
    "            overshoot: { output_frequency: 20 Hz, at_most: 1 Hz }\n"
    "            during: [ { drive: a, after: 450 ms, load: { torque: 1 Nm, over: 700 ms } }, { after: 333 ms, note: x "
    "} ]\n"
    "    - { drive: a, after: 100 ms, fault: { E.OHT: on } }\n"
    "    - { drive: a, trip: { code: E.OHT, within: 1 s, tripped: on } }\n"
    "    - { drive: a, after: 150 ms, reset: }\n"
    "    - { drive: a, when: ready, within: 5 s }\n"
    "    - { drive: a, after: 300 ms, power: cycle }\n"
    "    - { drive: a, after: 2500 ms, when: running, within: 5 s }\n"
    "    - { drive: a, at: 20 s, check: { alarm: none } }\n"
    "  second:\n"
    "    - { drive: b, when: ready, reference: 40 Hz }\n"
    "    - { drive: b, at: 1500 ms, run: forward }\n"
    "    - { drive: b, reached: { output_frequency: 30 Hz, within: 5 s } }\n"
    "    - { drive: b, always: { output_frequency: above 25 Hz }, during: 7 s }\n"
    "    - { drive: b, stop: }\n"
    "    - { drive: b, when: stopped, within: 10 s }\n";

RunOptions small_recording() {
  RunOptions options;
  options.recording.max_cells = 60'000;  // thinned out on the way
  return options;
}

std::string reports(const Scenario& s, const RunResult& r) {
  JunitWriter junit("unused");
  junit.write(nullptr, r);
  return html_report(&s, r, "build", {}) + signals_csv(r.recording) + states_csv(r.recording) + events_csv(r) +
         junit.text();
}

// Each instant as another run.
RunResult relayed(const Scenario& s, const std::vector<Duration>& instants, const RunOptions& options,
                  std::size_t* interruptions = nullptr) {
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  auto run = std::make_unique<VirtualRun>(s, catalogue, options);
  for (const Duration at : instants) {
    run->run_until(at);
    if (run->finished()) break;
    Bytes saved;
    const auto ok = run->save(saved);
    EXPECT_TRUE(ok) << ok.error();
    run = std::make_unique<VirtualRun>(s, catalogue, options);
    const auto loaded = run->load(saved);
    EXPECT_TRUE(loaded) << loaded.error();
    Bytes again;
    EXPECT_TRUE(run->save(again));
    EXPECT_EQ(again, saved) << to_seconds(at) << " s";
    if (interruptions != nullptr) ++*interruptions;
  }
  return run->finish();
}

TEST(Interrupted, ARunResumedAtTwoHundredInstantsLeavesTheReportsOfOneThatIsNotInterrupted) {
  const Scenario s = read(kStory);
  const RunResult whole = run_virtual(s, rig::shipped_catalogue(), small_recording());
  ASSERT_EQ(whole.verdict, Verdict::kPassed) << failures(whole);
  EXPECT_EQ(whole.recording.windows, 1u);
  std::vector<Duration> instants;
  for (int i = 0; i < 200; ++i) instants.push_back(i * milliseconds(100));
  std::size_t interruptions = 0;
  const RunResult resumed = relayed(s, instants, small_recording(), &interruptions);
  EXPECT_EQ(interruptions, 200u);
  EXPECT_TRUE(reports(s, resumed) == reports(s, whole)) << failures(resumed);
}

TEST(Interrupted, EachShippedScenarioIsResumedAtRandomInstants) {
  Random random(11);
  for (const std::string& file : find_scenarios({VINV_SOURCE_DIR "/scenarios"}, "")) {
    const Scenario s = load_scenario(file, testing::load_options());
    const RunResult whole = run_virtual(s, rig::shipped_catalogue(), {});
    std::vector<Duration> instants;
    for (int i = 0; i < 6; ++i)
      instants.push_back(milliseconds(100) * static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(
                                                 whole.end.time_since_epoch() / milliseconds(100)))));
    std::sort(instants.begin(), instants.end());
    EXPECT_TRUE(reports(s, relayed(s, instants, {})) == reports(s, whole)) << file;
  }
}

TEST(Fork, ContinuationsDifferFromTheSnapshotOnOnly) {
  const std::string head = std::string(testing::kHead) + testing::kRunning + "  - { after: 1 s, note: here }\n";
  const auto continued = [&](const std::string& torque) {
    return read(head + "  - { load: { torque: " + torque + " Nm } }\n  - { after: 1 s, check: { torque: " + torque +
                " Nm +- 0.3 Nm } }\n");
  };
  const Scenario light = continued("1");
  const Scenario heavy = continued("2");
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  VirtualRun run(light, catalogue, {});
  run.run_until(milliseconds(2000));
  Bytes saved;
  ASSERT_TRUE(run.save(saved));
  for (const Scenario* s : {&light, &heavy, &light}) {
    const RunResult forked = resume_virtual(*s, catalogue, {}, saved);
    EXPECT_TRUE(reports(*s, forked) == reports(*s, run_virtual(*s, catalogue, {}))) << failures(forked);
  }
  EXPECT_EQ(run.finish().verdict, Verdict::kPassed);
}

class RefusedRun : public ::testing::Test {
 protected:
  RefusedRun() : scenario_(read(kStory)), run_(scenario_, rig::shipped_catalogue(), {}) {
    run_.run_until(seconds(4));
    EXPECT_TRUE(run_.save(before_));
  }
  std::string refusal(ByteView snapshot) {
    const auto loaded = run_.load(snapshot);
    EXPECT_FALSE(loaded);
    Bytes after;
    EXPECT_TRUE(run_.save(after));
    EXPECT_EQ(after, before_);
    return loaded ? "" : loaded.error();
  }
  Bytes saved_at(const std::string& text, Duration at, const RunOptions& options = {}) {
    const Scenario s = read(text);
    VirtualRun other(s, rig::shipped_catalogue(), options);
    other.run_until(at);
    Bytes saved;
    const auto ok = other.save(saved);
    EXPECT_TRUE(ok) << ok.error();
    return saved;
  }
  Scenario scenario_;
  VirtualRun run_;
  Bytes before_;
};

TEST_F(RefusedRun, DamageLeavesTheRunAsItWasAndItsResultToo) {
  const Bytes good = saved_at(kStory, seconds(6));
  Random random(2);
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    Bytes bad = good;
    // The recording, which is most of it, may hold any number.
    const std::size_t from = i % 2 == 0 ? kSnapshotHeader : bad.size() - 600;
    bad[from + random.below(600)] ^= static_cast<std::uint8_t>(1u << random.below(8));
    ASSERT_NE(refusal(bad).find("checksum"), std::string::npos);
    seal_snapshot(bad);
    if (run_.load(bad)) {
      ASSERT_TRUE(run_.load(before_));
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, 3);
  EXPECT_NE(refusal(ByteView(good).first(good.size() - 1)), "");
  const RunResult end = run_.finish();
  EXPECT_TRUE(reports(scenario_, end) == reports(scenario_, run_virtual(scenario_, rig::shipped_catalogue(), {})));
}

TEST_F(RefusedRun, AScenarioThatCameAnotherWayIsAForeignOne) {
  std::string text = kStory;
  text.replace(text.find("at: 1500 ms"), 11, "at: 1600 ms");
  EXPECT_EQ(refusal(saved_at(text, seconds(4))),
            "the snapshot is of another scenario: it has other steps before this instant");
  text = kStory;
  text.replace(text.find("FR-E540-1.5K"), 12, "FR-E540-2.2K");
  EXPECT_NE(refusal(saved_at(text, seconds(4))).find("the snapshot is of another plant"), std::string::npos);
  EXPECT_NE(refusal(saved_at(kStory, seconds(4), small_recording())).find("limit of recorded values"),
            std::string::npos);
  const RunResult r = resume_virtual(scenario_, rig::shipped_catalogue(), {}, saved_at(text, seconds(4)));
  EXPECT_EQ(r.verdict, Verdict::kNotRun);
  EXPECT_NE(r.reason.find("another plant"), std::string::npos);
}

TEST_F(RefusedRun, OffTheGridAndAfterTheEndNothingIsSaved) {
  run_.run_until(milliseconds(4050));
  Bytes out;
  const auto off_grid = run_.save(out);
  ASSERT_FALSE(off_grid);
  EXPECT_NE(off_grid.error().find("it is 4.050000 s"), std::string::npos);
  run_.run_until(seconds(60));
  const auto over = run_.save(out);
  ASSERT_FALSE(over);
  EXPECT_EQ(over.error(), "the run is over.");
}

}  // namespace
}  // namespace vinv::scenario
