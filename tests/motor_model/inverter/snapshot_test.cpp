// Snapshots of a whole inverter: a run that is interrupted and resumed in a new inverter equals the uninterrupted one
// byte for byte; damaged and foreign snapshots are refused (docs/decisions/0005-snapshots.md).
#include <algorithm>
#include <set>

#include "tests/motor_model/inverter/bench.hpp"
#include "tests/motor_model/inverter/random_story.hpp"

namespace vinv::inverter::test {
namespace {

constexpr Duration kGrid = std::chrono::milliseconds(20);
constexpr int kGridTicks = 20;
constexpr int kTicks = 60'000;

InverterConfig story_config(plant::SolverChoice solver = plant::SolverChoice::kErk) {
  InverterConfig c = config_1k5();
  c.brake_resistance_ohm = 150;
  c.solver.choice = solver;
  c.snapshot_grid = kGrid;
  return c;
}

std::unique_ptr<Inverter> fresh(const InverterConfig& config) {
  auto made = make_inverter("fr-e500", config);
  EXPECT_TRUE(made.has_value());
  return std::move(made).value();
}

// The first value in which two states differ.
std::string difference(Inverter& a, Inverter& b) {
  const std::string one = list_snapshot(a);
  const std::string two = list_snapshot(b);
  const auto [x, y] = std::mismatch(one.begin(), one.end(), two.begin(), two.end());
  if (x == one.end() && y == two.end()) return "no difference in the listed state";
  const auto line = [](const std::string& text, std::size_t at) {
    const std::size_t begin = text.rfind('\n', at) + 1;
    return text.substr(begin, text.find('\n', at) - begin);
  };
  const auto at = static_cast<std::size_t>(x - one.begin());
  return line(one, at) + " / " + line(two, at);
}

constexpr std::uint64_t kSeeds[] = {9, 1, 4, 6, 8};

// What happened in the stories: a test that resumes only stopped inverters proves nothing.
struct Happened {
  std::set<int> run_states;
  std::set<std::string> alarms;
  std::set<int> modes;
  std::set<std::string> displays;
  bool auto_tuning = false;
  int power_losses = 0;
};

struct Uninterrupted {
  std::vector<std::uint64_t> trace;  // after each tick
  std::vector<Bytes> snapshots;      // after tick n * kGridTicks, on the grid
  std::vector<std::uint64_t> looks;  // at the same instants
};

bool on_grid(int tick) { return (RandomStory::kFirstTick + tick) % kGridTicks == 0; }

Uninterrupted run(const RandomStory& story, const InverterConfig& config, Happened* happened = nullptr) {
  Uninterrupted out;
  const auto inverter = fresh(config);
  bool powered = false;
  for (int tick = 0; tick < story.ticks(); ++tick) {
    Trace trace;
    story.play(*inverter, tick, trace);
    out.trace.push_back(trace.hash());
    if (on_grid(tick)) {
      Bytes bytes;
      EXPECT_TRUE(inverter->save(bytes).has_value()) << tick;
      out.snapshots.push_back(std::move(bytes));
      Trace now;
      look(*inverter, tick, now);
      out.looks.push_back(now.hash());
    }
    if (happened == nullptr) continue;
    for (const SignalValue& s : inverter->signals()) {
      if (s.name == "run_state") happened->run_states.insert(static_cast<int>(s.value));
    }
    happened->alarms.insert(inverter->alarm_name());
    happened->modes.insert(static_cast<int>(inverter->port().operation_mode()));
    happened->displays.insert(inverter->display());
    happened->auto_tuning = happened->auto_tuning || inverter->port().read_parameter({96, 0}).value_or(0u) == 2;
    happened->power_losses += powered && !inverter->powered() ? 1 : 0;
    powered = inverter->powered();
  }
  return out;
}

// Goes on in an inverter from tick first; false with a message at the first difference.
bool follows(Inverter& inverter, const RandomStory& story, int first, int end, const Uninterrupted& expected,
             const InverterConfig& config) {
  for (int tick = first; tick < end; ++tick) {
    Trace trace;
    story.play(inverter, tick, trace);
    const bool same_trace = trace.hash() == expected.trace[static_cast<std::size_t>(tick)];
    if (same_trace && !on_grid(tick)) continue;
    const Bytes& snapshot = expected.snapshots[static_cast<std::size_t>(tick / kGridTicks)];
    if (same_trace && save_snapshot(inverter) == snapshot) continue;
    const auto other = fresh(config);
    EXPECT_TRUE(other->load(snapshot).has_value());
    ADD_FAILURE() << "resumed before tick " << first << ", differs at " << tick << ": "
                  << (on_grid(tick) ? difference(inverter, *other) : "in what can be seen");
    return false;
  }
  return true;
}

std::vector<int> random_instants(int count, std::uint64_t seed) {
  Random random(seed);
  std::set<int> chosen;
  while (static_cast<int>(chosen.size()) < count) {
    const auto n = static_cast<int>(random.below(kTicks / kGridTicks));
    if (on_grid(n * kGridTicks)) chosen.insert(n);
  }
  return {chosen.begin(), chosen.end()};
}

TEST(RandomStory, GoesThroughAllOfTheInverter) {
  Happened h;
  for (const std::uint64_t seed : kSeeds) run(RandomStory(seed, kTicks), story_config(), &h);
  EXPECT_EQ(h.run_states.size(), 9u) << testing::PrintToString(h.run_states);
  EXPECT_GE(h.alarms.size(), 8u) << testing::PrintToString(h.alarms);
  EXPECT_EQ(h.modes.size(), 5u);
  EXPECT_GE(h.power_losses, 5);
  EXPECT_TRUE(h.auto_tuning);
  for (const char* shown : {"JOG", "PS", "----", "Err.", ""}) EXPECT_EQ(h.displays.count(shown), 1u) << shown;
}

TEST(Snapshot, RunResumedAtTwoHundredInstantsEqualsTheUninterruptedOne) {
  const InverterConfig config = story_config();
  const RandomStory story(kSeeds[0], kTicks);
  const Uninterrupted expected = run(story, config);

  // Each in a new inverter: the next seconds, and all the rest from some.
  const std::vector<int> instants = random_instants(200, 7);
  int to_the_end = 0;
  for (const int n : instants) {
    const auto inverter = fresh(config);
    const auto loaded = inverter->load(expected.snapshots[static_cast<std::size_t>(n)]);
    ASSERT_TRUE(loaded.has_value()) << loaded.error();
    EXPECT_EQ(save_snapshot(*inverter), expected.snapshots[static_cast<std::size_t>(n)]);
    Trace now;
    look(*inverter, n * kGridTicks, now);
    EXPECT_EQ(now.hash(), expected.looks[static_cast<std::size_t>(n)]) << n;
    const int first = n * kGridTicks + 1;
    const int end = n % 25 == 0 ? kTicks : std::min(kTicks, first + 1500);
    to_the_end += end == kTicks ? 1 : 0;
    if (!follows(*inverter, story, first, end, expected, config)) return;
  }
  EXPECT_GE(to_the_end, 5);

  // One run, interrupted at every one of them.
  auto inverter = fresh(config);
  int next = 0;
  for (const int n : instants) {
    if (!follows(*inverter, story, next, n * kGridTicks + 1, expected, config)) return;
    Bytes bytes;
    ASSERT_TRUE(inverter->save(bytes).has_value());
    inverter = fresh(config);
    ASSERT_TRUE(inverter->load(bytes).has_value());
    next = n * kGridTicks + 1;
  }
  follows(*inverter, story, next, kTicks, expected, config);
}

class SnapshotOfASeed : public testing::TestWithParam<std::pair<std::uint64_t, plant::SolverChoice>> {};

TEST_P(SnapshotOfASeed, ResumedRunsEqualTheUninterruptedOne) {
  const auto [seed, solver] = GetParam();
  const InverterConfig config = story_config(solver);
  const RandomStory story(seed, kTicks);
  const Uninterrupted expected = run(story, config);
  for (const int n : random_instants(30, seed)) {
    const auto inverter = fresh(config);
    ASSERT_TRUE(inverter->load(expected.snapshots[static_cast<std::size_t>(n)]).has_value());
    const int first = n * kGridTicks + 1;
    if (!follows(*inverter, story, first, std::min(kTicks, first + 2000), expected, config)) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SnapshotOfASeed,
                         testing::Values(std::pair{kSeeds[1], plant::SolverChoice::kErk},
                                         std::pair{kSeeds[2], plant::SolverChoice::kErk},
                                         std::pair{kSeeds[3], plant::SolverChoice::kCvodeBdf},
                                         std::pair{kSeeds[4], plant::SolverChoice::kRk4}));

// An inverter with a past of its own takes a snapshot as a new one does.
TEST(Snapshot, LoadDoesNotDependOnWhatTheInverterDidBefore) {
  const InverterConfig config = story_config();
  const RandomStory story(21, 6000);
  const RandomStory other(22, 5000);
  const Uninterrupted expected = run(story, config);
  const auto inverter = fresh(config);
  for (int tick = 0; tick < other.ticks(); ++tick) {
    Trace trace;
    other.play(*inverter, tick, trace);
  }
  for (const int n : {290, 100, 30, 200}) {
    ASSERT_TRUE(inverter->load(expected.snapshots[static_cast<std::size_t>(n)]).has_value());
    const int first = n * kGridTicks + 1;
    if (!follows(*inverter, story, first, std::min(6000, first + 700), expected, config)) return;
  }
}

// What a comparator reported in the tick before the snapshot is judged in the tick after it.
TEST(Snapshot, TripOnTheWayArrivesInTheResumedRun) {
  InverterConfig config = story_config();
  config.brake_resistance_ohm = 0;
  config.snapshot_grid = Inverter::kControlPeriod;
  config.load.inertia_kg_m2 = 0.1;
  Bench b(config);
  b.preset("Pr.7", 3);
  b.preset("Pr.8", 0.2);
  b.power_on();
  b.terminal("STF");
  ASSERT_TRUE(b->set_analog("2", 5).has_value());
  b.run(4);
  b.terminal("STF", false);
  std::vector<Bytes> snapshots;
  while (b->alarm_name().empty() && snapshots.size() < 2000) {
    snapshots.push_back(save_snapshot(*b));
    b.tick();
  }
  ASSERT_EQ(b->alarm_name(), "E.OC3");
  const Bytes tripped = save_snapshot(*b);
  for (std::size_t ticks = 1; ticks <= 5; ++ticks) {
    const auto inverter = fresh(config);
    ASSERT_TRUE(inverter->load(snapshots[snapshots.size() - ticks]).has_value());
    for (std::size_t left = ticks; left > 0; --left) {
      EXPECT_EQ(inverter->alarm_name(), "");
      inverter->tick(b.now() - static_cast<int>(left) * Inverter::kControlPeriod);
    }
    EXPECT_EQ(inverter->alarm_cause(), b->alarm_cause()) << ticks;
    EXPECT_EQ(save_snapshot(*inverter), tripped) << ticks;
  }
}

TEST(Snapshot, PowerComesBackWithTheMainsOfTheSnapshot) {
  Bench b(story_config());
  b.power_on();
  b->set_mains({.voltage_v_rms = 340});
  b.run(0.5);
  b->set_power(false);
  b.tick();
  const Bytes snapshot = save_snapshot(*b);
  const auto inverter = fresh(story_config());
  ASSERT_TRUE(inverter->load(snapshot).has_value());
  inverter->set_power(true);
  Instant now = b.now();
  for (int i = 0; i < 500; ++i, now += Inverter::kControlPeriod) inverter->tick(now);
  EXPECT_NEAR(inverter->plant().measurements().dc_link_v, 340 * std::sqrt(2.0), 5);
}

TEST(Snapshot, ForksGoTheirOwnWays) {
  Bench b(story_config());
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(40));
  ASSERT_TRUE(b.command({port::NetTerminal::kStf}));
  b.run(3);
  while (!b->on_snapshot_grid()) b.tick();
  Bytes snapshot;
  ASSERT_TRUE(b->save(snapshot).has_value());
  double least = 1e9;
  double most = 0;
  for (int fork = 0; fork < 5; ++fork) {
    const auto inverter = fresh(story_config());
    ASSERT_TRUE(inverter->load(snapshot).has_value());
    plant::LoadSettings load;
    load.constant_nm = fork;
    inverter->set_load(load);
    Instant now = b.now();
    for (int i = 0; i < 500; ++i, now += Inverter::kControlPeriod) inverter->tick(now);
    EXPECT_TRUE(inverter->port().status().running);
    least = std::min(least, inverter->plant().measurements().output_current_a_rms);
    most = std::max(most, inverter->plant().measurements().output_current_a_rms);
  }
  EXPECT_GT(most, least + 0.2);
}

TEST(Snapshot, TakenOnlyOnTheGrid) {
  Bench b(story_config());
  b.power_on();
  b.run(0.2);
  int taken = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const bool due = b.now().time_since_epoch() % kGrid == Duration{};
    b.tick();
    Bytes bytes;
    const Outcome saved = b->save(bytes);
    EXPECT_EQ(saved.has_value(), due) << tick;
    EXPECT_THAT(saved ? "grid" : saved.error(), testing::HasSubstr("grid"));
    taken += saved ? 1 : 0;
  }
  EXPECT_EQ(taken, 10);

  InverterConfig config = story_config();
  config.snapshot_grid = std::chrono::microseconds(1500);
  const auto made = make_inverter("fr-e500", config);
  ASSERT_FALSE(made.has_value());
  EXPECT_THAT(made.error(), testing::HasSubstr("snapshot grid"));
}

class RefusedSnapshot : public testing::Test {
 protected:
  void SetUp() override {
    b_.power_on();
    b_.terminal("STF");
    ASSERT_TRUE(b_->set_analog("2", 3).has_value());
    b_.run(1);
    while (!b_->on_snapshot_grid()) b_.tick();
    ASSERT_TRUE(b_->save(bytes_).has_value());
    target_ = fresh(story_config());
    before_ = save_snapshot(*target_);
  }
  // The sentence; the inverter is as it was.
  std::string refusal(ByteView bytes) { return refusal(*target_, bytes); }
  static std::string refusal(Inverter& inverter, ByteView bytes) {
    const Bytes before = save_snapshot(inverter);
    const Outcome loaded = inverter.load(bytes);
    EXPECT_FALSE(loaded.has_value());
    EXPECT_EQ(save_snapshot(inverter), before);
    return loaded ? "" : loaded.error();
  }

  Bench b_{story_config()};
  Bytes bytes_;
  std::unique_ptr<Inverter> target_;
  Bytes before_;
};

TEST_F(RefusedSnapshot, EveryTruncationAndEveryFlippedBit) {
  for (std::size_t n = 0; n < bytes_.size(); n += n < 64 ? 1 : 97) {
    EXPECT_FALSE(target_->load(ByteView(bytes_).first(n)).has_value()) << n;
  }
  Random random(5);
  for (int i = 0; i < 4000; ++i) {
    Bytes damaged = bytes_;
    damaged[random.below(damaged.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
    EXPECT_FALSE(target_->load(damaged).has_value()) << i;
  }
  EXPECT_EQ(save_snapshot(*target_), before_);
  EXPECT_THAT(refusal({}), testing::HasSubstr("not a snapshot"));
}

// Bytes that were meant to deceive: right checksum, wrong contents. Never out of bounds, never half loaded.
TEST_F(RefusedSnapshot, ForgedContentsAreRefusedOrTakenWhole) {
  Random random(6);
  int taken = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes forged = bytes_;
    const auto changes = 1 + random.below(3);
    for (std::uint64_t c = 0; c < changes; ++c) {
      const auto at = kSnapshotHeader + random.below(forged.size() - kSnapshotHeader);
      forged[at] = static_cast<std::uint8_t>(random.next());
    }
    if (random.below(8) == 0) forged.resize(kSnapshotHeader + random.below(forged.size() - kSnapshotHeader));
    seal_snapshot(forged);
    const Outcome loaded = target_->load(forged);
    if (loaded) {
      EXPECT_EQ(save_snapshot(*target_), forged) << i;
      ASSERT_TRUE(target_->load(before_).has_value());
      ++taken;
    } else {
      EXPECT_EQ(save_snapshot(*target_), before_) << i << ": " << loaded.error();
    }
  }
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 3000);
}

TEST_F(RefusedSnapshot, OfAnotherModelMotorOrOption) {
  InverterConfig config = story_config();
  config.model = "FR-E540-2.2K";
  EXPECT_THAT(refusal(*fresh(config), bytes_),
              testing::HasSubstr("of another inverter: FR-E540-1.5K, not FR-E540-2.2K"));
  config = story_config();
  config.motor = *plant::find_machine("iec4p_2k2kW_400V");
  EXPECT_THAT(refusal(*fresh(config), bytes_), testing::HasSubstr("of another motor: iec4p_1k5kW_400V, not "));
  config = story_config();
  config.option_fitted = false;
  EXPECT_THAT(refusal(*fresh(config), bytes_), testing::HasSubstr("option board"));
  config = story_config();
  config.snapshot_grid = std::chrono::milliseconds(100);
  EXPECT_THAT(refusal(*fresh(config), bytes_), testing::HasSubstr("snapshot grid"));
}

}  // namespace
}  // namespace vinv::inverter::test
