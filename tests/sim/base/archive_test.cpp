// Snapshots: round trips, refusals, and what a load that failed leaves behind (docs/decisions/0005-snapshots.md).
#include "sim/base/archive.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/base/random.hpp"

namespace vinv {
namespace {

enum class Mood : std::int8_t { kSad = -1, kEven, kGlad };
VINV_ENUM_RANGE(Mood, kSad, kGlad);

class Part {
 public:
  enum class Phase : std::uint8_t { kOff, kOn };
  friend VINV_ENUM_RANGE(Phase, kOff, kOn);
  Part() = default;
  explicit Part(double v) : value_(v) {}
  double value() const { return value_; }

 private:
  double value_ = 0;
  Phase phase_ = Phase::kOn;
  VINV_ARCHIVE(Part, value_, phase_);
};

struct Whole {
  bool flag = false;
  std::uint16_t word = 0;
  std::int64_t wide = 0;
  float small = 0;
  Mood mood = Mood::kEven;
  Instant at{};
  Duration period{};
  std::string text;
  std::array<Part, 2> pair{};
  std::optional<Part> maybe;
  std::vector<double> numbers;
  std::vector<Part> parts;
  std::deque<std::string> queue;
  std::map<std::uint8_t, Part> table;
  std::optional<Result<void, Mood>> outcome;
  std::pair<int, bool> both;
  Random random{1};
  VINV_ARCHIVE(Whole, flag, word, wide, small, mood, at, period, text, pair, maybe, numbers, parts, queue, table,
               outcome, both, random);
};

Whole rich() {
  Whole w;
  w.flag = true;
  w.word = 0xabcd;
  w.wide = std::numeric_limits<std::int64_t>::min();
  w.small = 0.1f;
  w.mood = Mood::kSad;
  w.at = kForever;
  w.period = Duration{-5};
  w.text = std::string("a\0b", 3);
  w.pair = {Part(1), Part(-0.0)};
  w.maybe = Part(std::numeric_limits<double>::infinity());
  w.numbers = {1, 2, 3};
  w.parts = {Part(4), Part(5)};
  w.queue = {"x", "", "yy"};
  w.table[7] = Part(8);
  w.table[9] = Part(10);
  w.outcome = Result<void, Mood>(Unexpected(Mood::kGlad));
  w.both = {-3, true};
  w.random.next();
  return w;
}

TEST(Archive, EverythingComesBack) {
  Whole saved = rich();
  const Bytes bytes = save_snapshot(saved);
  Whole loaded;
  loaded.numbers = {9, 9, 9, 9};
  loaded.queue = {"old"};
  loaded.table[1] = Part(1);
  const auto ok = load_snapshot(loaded, bytes);
  ASSERT_TRUE(ok.has_value()) << ok.error();
  EXPECT_EQ(loaded.word, 0xabcd);
  EXPECT_EQ(loaded.wide, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(loaded.mood, Mood::kSad);
  EXPECT_EQ(loaded.at, kForever);
  EXPECT_EQ(loaded.text.size(), 3u);
  EXPECT_EQ(loaded.maybe->value(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(loaded.queue, saved.queue);
  EXPECT_EQ(loaded.table.size(), 2u);
  EXPECT_EQ(loaded.table[9].value(), 10);
  EXPECT_EQ(loaded.outcome->error(), Mood::kGlad);
  EXPECT_EQ(loaded.both, saved.both);
  EXPECT_EQ(save_snapshot(loaded), bytes);
  EXPECT_EQ(loaded.random.next(), saved.random.next());
  // And empty over full.
  Whole empty;
  ASSERT_TRUE(load_snapshot(loaded, save_snapshot(empty)).has_value());
  EXPECT_EQ(save_snapshot(loaded), save_snapshot(empty));
  EXPECT_FALSE(loaded.maybe.has_value());
}

TEST(Archive, BufferIsUsedAgain) {
  Whole w = rich();
  Bytes bytes;
  save_snapshot(w, bytes);
  const Bytes first = bytes;
  const auto* place = bytes.data();
  save_snapshot(w, bytes);
  EXPECT_EQ(bytes.data(), place);
  EXPECT_EQ(bytes, first);
  // Longer than the room it starts with.
  w.numbers.assign(5000, 0.5);
  save_snapshot(w, bytes);
  Whole loaded;
  ASSERT_TRUE(load_snapshot(loaded, bytes).has_value());
  EXPECT_EQ(loaded.numbers, w.numbers);
}

std::string refusal(Whole& target, ByteView bytes) {
  const Bytes before = save_snapshot(target);
  const auto ok = load_snapshot(target, bytes);
  EXPECT_EQ(save_snapshot(target), before);
  return ok ? "" : ok.error();
}

TEST(Archive, DamagedBytesAreRefusedBeforeAnythingChanges) {
  Whole saved = rich();
  const Bytes bytes = save_snapshot(saved);
  Whole target = rich();
  target.word = 1;
  EXPECT_EQ(refusal(target, {}), "these bytes are not a snapshot");
  for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_NE(refusal(target, ByteView(bytes).first(n)), "") << n;
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    Bytes damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    ASSERT_NE(refusal(target, damaged), "") << bit;
  }
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_NE(refusal(target, longer).find("bytes where"), std::string::npos);
  Bytes newer = bytes;
  newer[8] = 2;
  EXPECT_EQ(refusal(target, newer), "the snapshot has format 2, this program reads format 1");
}

// With the right checksum over wrong contents: nothing is read out of bounds, nothing is half loaded.
TEST(Archive, ForgedBytesAreRefusedOrTakenWhole) {
  Whole saved = rich();
  const Bytes bytes = save_snapshot(saved);
  Random random(3);
  Whole target;
  const Bytes before = save_snapshot(target);
  int refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes forged = bytes;
    for (std::uint64_t n = 1 + random.below(4); n > 0; --n) {
      const auto at = kSnapshotHeader + random.below(forged.size() - kSnapshotHeader);
      forged[at] = random.below(2) != 0 ? 0xff : static_cast<std::uint8_t>(random.next());
    }
    if (random.below(4) == 0) forged.resize(kSnapshotHeader + random.below(forged.size() - kSnapshotHeader));
    seal_snapshot(forged);
    if (load_snapshot(target, forged)) {
      ASSERT_TRUE(load_snapshot(target, before).has_value());
    } else {
      ++refused;
    }
    ASSERT_EQ(save_snapshot(target), before) << i;
  }
  EXPECT_GT(refused, 10'000);
}

namespace other {
struct Counter {
  std::uint32_t first = 1;
  std::uint32_t second = 2;
  VINV_ARCHIVE(Counter, first, second);
};
struct Counters {
  std::uint32_t before = 5;
  Counter counter;
  VINV_ARCHIVE(Counters, before, counter);
};
}  // namespace other

namespace renamed {
struct Counter {
  std::uint32_t first = 1;
  std::uint32_t third = 2;
  VINV_ARCHIVE(Counter, first, third);
};
struct Counters {
  std::uint32_t before = 6;
  Counter counter;
  VINV_ARCHIVE(Counters, before, counter);
};
}  // namespace renamed

namespace retyped {
struct Counter {
  std::uint32_t first = 1;
  std::int32_t second = 2;
  VINV_ARCHIVE(Counter, first, second);
};
}  // namespace retyped

TEST(Archive, BuildWithOtherFieldsIsRefusedByName) {
  other::Counters there;
  const Bytes bytes = save_snapshot(there);
  renamed::Counters here;
  const auto ok = load_snapshot(here, bytes);
  ASSERT_FALSE(ok.has_value());
  EXPECT_EQ(ok.error(), "the snapshot is of another build: Counter has other fields there");
  EXPECT_EQ(here.before, 6u);  // read before the difference was met, and given back
  retyped::Counter typed;
  EXPECT_FALSE(load_snapshot(typed, save_snapshot(there.counter)).has_value());
}

struct Guarded {
  int value = 1;
  VINV_ARCHIVE(Guarded, value);
};
struct Named {
  std::string name;
  Guarded guarded;
  friend void archive(Archive& a, Named& n) {
    VINV_MEMBERS(n, name, guarded);
    a.must_match("motor", name);
    VINV_FIELDS(a, Named, guarded);
    a.require(guarded.value < 100, "too large");
  }
};

TEST(Archive, ConstantsMustMatchAndValuesMayBeJudged) {
  Named big{"big", {7}};
  Named small{"small", {}};
  auto ok = load_snapshot(small, save_snapshot(big));
  ASSERT_FALSE(ok.has_value());
  EXPECT_EQ(ok.error(), "the snapshot is of another motor: big, not small");
  Named other_big{"big", {}};
  ASSERT_TRUE(load_snapshot(other_big, save_snapshot(big)).has_value());
  EXPECT_EQ(other_big.guarded.value, 7);
  big.guarded.value = 100;
  ok = load_snapshot(other_big, save_snapshot(big));
  ASSERT_FALSE(ok.has_value());
  EXPECT_EQ(ok.error(), "the snapshot is damaged: too large");
  EXPECT_EQ(other_big.guarded.value, 7);
}

TEST(Archive, AListingNamesEveryValue) {
  Named n{"big", {}};
  other::Counters c;
  EXPECT_EQ(list_snapshot(c), "Counters.before = 5\nCounters.counter.first = 1\nCounters.counter.second = 2\n");
  Whole w = rich();
  const std::string text = list_snapshot(w);
  EXPECT_NE(text.find("Whole.maybe.value_ = inf\n"), std::string::npos) << text;
  EXPECT_NE(text.find("Whole.mood = -1\n"), std::string::npos) << text;
}

TEST(Archive, ChecksumSeesOrderAndLength) {
  const Bytes a{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  Bytes swapped = a;
  std::rotate(swapped.begin(), swapped.begin() + 8, swapped.end());
  EXPECT_NE(snapshot_checksum(a), snapshot_checksum(swapped));
  EXPECT_NE(snapshot_checksum({}), snapshot_checksum(Bytes{0}));
  EXPECT_NE(snapshot_checksum(Bytes{0}), snapshot_checksum(Bytes(8, 0)));
}

}  // namespace
}  // namespace vinv
