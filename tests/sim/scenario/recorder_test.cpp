// The recorder keeps every sample around a trip, thins out the rest, and stays within its memory.
#include "sim/scenario/recorder.hpp"

#include <algorithm>

#include "tests/sim/scenario/support.hpp"

namespace vinv::scenario {
namespace {

using std::chrono::milliseconds;

constexpr const char* kPlant = "drives: [{ inverter: { model: FR-E540-0.75K } }]";

struct Bench {
  kernel::Scheduler scheduler;
  rig::Plant plant{rig::parse_plant_file(kPlant, "p.yaml", rig::shipped_catalogue()), scheduler, options()};
  Observer observer{*plant.drives()[0]};
  static rig::PlantOptions options() {
    rig::PlantOptions o;
    o.catalogue = rig::shipped_catalogue();
    return o;
  }
  std::size_t width() const { return observer.signal_names().size(); }
};

Instant at_ms(int ms) { return Instant{} + milliseconds(ms); }

bool has_every_ms(const Recording& r, int from, int to) {
  for (int ms = from; ms <= to; ++ms)
    if (!std::binary_search(r.times.begin(), r.times.end(), at_ms(ms))) return false;
  return true;
}

TEST(Recorder, KeepsEverySampleOfAShortRun) {
  Bench bench;
  Recorder recorder({&bench.observer}, {});
  for (int ms = 1; ms <= 3000; ++ms) recorder.sample(at_ms(ms));
  const Recording r = recorder.take();
  EXPECT_EQ(r.times.size(), 3000u);
  EXPECT_EQ(r.coarsest, milliseconds(1));
  ASSERT_EQ(r.columns.size(), bench.width());
  for (const SignalColumn& c : r.columns) EXPECT_EQ(c.values.size(), 3000u);
}

TEST(Recorder, ThinsOutALongRunButNotAroundItsTrips) {
  Bench bench;
  RecorderSettings settings;
  settings.max_cells = 1000 * bench.width();
  Recorder recorder({&bench.observer}, settings);
  for (int ms = 1; ms <= 60000; ++ms) {
    recorder.sample(at_ms(ms));
    if (ms == 30000 || ms == 30300 || ms == 59900) recorder.mark(at_ms(ms));
  }
  const Recording r = recorder.take();
  EXPECT_EQ(r.windows, 2u) << "two trips close together share one";
  EXPECT_EQ(r.windows_lost, 0u);
  EXPECT_TRUE(has_every_ms(r, 29501, 30800));
  EXPECT_TRUE(has_every_ms(r, 59401, 60000));
  EXPECT_GE(r.coarsest, milliseconds(60));
  EXPECT_LE(r.times.size(), 1000u + 1300u + 1100u);
  EXPECT_TRUE(std::is_sorted(r.times.begin(), r.times.end()));
  EXPECT_EQ(std::adjacent_find(r.times.begin(), r.times.end()), r.times.end());
}

TEST(Recorder, ATripRightAfterTheStartHasWhatThereIs) {
  Bench bench;
  RecorderSettings settings;
  settings.max_cells = 10 * bench.width();
  Recorder recorder({&bench.observer}, settings);
  for (int ms = 1; ms <= 700; ++ms) {
    recorder.sample(at_ms(ms));
    if (ms == 20) recorder.mark(at_ms(ms));
  }
  EXPECT_TRUE(has_every_ms(recorder.take(), 1, 520));
}

TEST(Recorder, WindowsBeyondTheLimitAreCounted) {
  Bench bench;
  RecorderSettings settings;
  settings.before = settings.after = milliseconds(10);
  settings.max_window_cells = 2 * 21 * bench.width();
  Recorder recorder({&bench.observer}, settings);
  for (int ms = 1; ms <= 1000; ++ms) {
    recorder.sample(at_ms(ms));
    if (ms % 100 == 50) recorder.mark(at_ms(ms));
  }
  const Recording r = recorder.take();
  EXPECT_EQ(r.windows + r.windows_lost, 10u);
  EXPECT_GE(r.windows, 2u);
  EXPECT_GE(r.windows_lost, 1u);
}

TEST(Recorder, ARunKeepsTheSamplesAfterATripThatEndsIt) {
  RunOptions options;
  options.recording.max_cells = 2000;
  const RunResult r =
      testing::run(std::string(testing::kHead) + testing::kRunning + "  - fault: E.OHT\n  - after: 5 s\n", options);
  const auto trip =
      std::find_if(r.events.begin(), r.events.end(), [](const Event& e) { return e.kind == Event::Kind::kTrip; });
  ASSERT_NE(trip, r.events.end());
  const int ms = static_cast<int>(to_ns(trip->at) / 1'000'000);
  EXPECT_TRUE(has_every_ms(r.recording, ms - 499, ms + 500));
  EXPECT_EQ(r.end, trip->at + milliseconds(500));
  const auto states = std::find_if(r.recording.states.begin(), r.recording.states.end(),
                                   [](const StateTrace& t) { return t.name == "alarm"; });
  ASSERT_NE(states, r.recording.states.end());
  ASSERT_EQ(states->changes.size(), 2u);
  EXPECT_EQ(states->changes[0].value, "none");
  EXPECT_EQ(states->changes[1].value, "E.OHT");
  EXPECT_EQ(states->changes[1].at, trip->at);
}

}  // namespace
}  // namespace vinv::scenario
