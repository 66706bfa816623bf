// One story over every way to the same drive: the motor must not know which master told it.
#include <cmath>

#include "tests/sim/masters/plant_bench.hpp"

namespace vinv::test {
namespace {

using masters::Word;

struct Way {
  std::string_view name;
  std::string_view profile;
};
constexpr Way kWays[] = {{"ModbusRtu", "modbus"},
                         {"ModbusTcp", "modbus"},
                         {"CanopenPdo", "canopen"},
                         {"CanopenSdo", "canopen-sdo"},
                         {"Canopen402", "canopen-402"}};

struct Sample {
  double frequency, speed, current;
};

// What the motor did, from the first output on.
struct Trace {
  std::vector<Sample> ramp;  // each 10 ms
  Duration stop_to_trip{};
  double dc_link_at_trip = 0;
  std::vector<Sample> second_ramp;
};

std::unique_ptr<masters::Station> master_of(PlantBench& bench, const Way& way) {
  if (way.name == "ModbusRtu") return bench.serial_master();
  if (way.name == "ModbusTcp") return bench.tcp_master();
  return bench.canopen_master();
}

// Tells to run and records, each millisecond from the first output on; every tenth sample of 2.5 s stays.
std::vector<Sample> record_ramp(PlantBench& bench, const std::function<void()>& run) {
  std::vector<Sample> samples;
  const auto event = bench.scheduler.schedule_every(
      bench.now() + milliseconds(1), milliseconds(1), kernel::Priority::kObserver, [&](Instant) {
        const Sample s{bench.signal("output_frequency"), bench.signal("speed"), bench.signal("output_current")};
        if (s.frequency > 0 || !samples.empty()) samples.push_back(s);
      });
  run();
  EXPECT_TRUE(bench.wait([&] { return samples.size() >= 2500; }, milliseconds(3000)));
  bench.scheduler.cancel(event);
  std::vector<Sample> out;
  for (std::size_t i = 0; i < 2500 && i < samples.size(); i += 10) out.push_back(samples[i]);
  return out;
}

Trace tell_story(const Way& way) {
  Trace trace;
  PlantBench bench;
  const auto master = master_of(bench, way);
  const auto tell = [&](const masters::Order& o) {
    const auto outcome = bench.tell(*master, way.profile, o);
    EXPECT_TRUE(outcome.has_value()) << way.name << ": " << outcome.error();
    return outcome ? outcome->value : NAN;
  };
  tell(order(Word::kEnterNetwork));
  tell(parameter(7, 0.1, 2.0));
  EXPECT_DOUBLE_EQ(tell(parameter(7, 0.1)), 2.0);
  tell(order(Word::kReferenceHz, 40));
  trace.ramp = record_ramp(bench, [&] { tell(order(Word::kRunForward)); });
  EXPECT_DOUBLE_EQ(tell(monitor("output_frequency")), 40) << way.name;
  EXPECT_NEAR(tell(monitor("speed")), 1200, 1) << way.name;

  const auto alarm = [&] { return bench.mill().inverter->alarm_name(); };
  std::optional<Instant> stopped, tripped;
  const auto event = bench.scheduler.schedule_every(
      bench.now() + milliseconds(1), milliseconds(1), kernel::Priority::kObserver, [&](Instant at) {
        if (tripped) return;
        if (!stopped && bench.signal("output_frequency") < 40) stopped = at;
        trace.dc_link_at_trip = std::max(trace.dc_link_at_trip, bench.signal("dc_link"));
        if (!alarm().empty()) tripped = at;
      });
  tell(order(Word::kStop));
  EXPECT_TRUE(bench.wait([&] { return tripped.has_value(); }, milliseconds(1000)));
  bench.scheduler.cancel(event);
  trace.stop_to_trip = tripped.value_or(bench.now()) - stopped.value_or(bench.now());
  EXPECT_EQ(alarm(), "E.OV3") << way.name;
  bench.run(milliseconds(60));
  EXPECT_DOUBLE_EQ(tell(monitor("alarm")), 0x22) << way.name;

  EXPECT_TRUE(bench.wait([&] { return std::abs(bench.signal("speed")) < 1; }, std::chrono::seconds(30)));
  tell(order(Word::kReset));
  EXPECT_EQ(alarm(), "") << way.name;
  bench.run(milliseconds(500));
  EXPECT_DOUBLE_EQ(bench.signal("output_frequency"), 0) << way.name << ": a reset starts nothing";
  tell(order(Word::kEnterNetwork));
  tell(order(Word::kReferenceHz, 40));
  trace.second_ramp = record_ramp(bench, [&] { tell(order(Word::kRunForward)); });
  EXPECT_DOUBLE_EQ(tell(monitor("output_frequency")), 40) << way.name;
  return trace;
}

void expect_alike(const std::vector<Sample>& a, const std::vector<Sample>& b, std::string_view way) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    // A phase of up to one control period between the masters is 0.03 Hz on this ramp.
    EXPECT_NEAR(a[i].frequency, b[i].frequency, 0.05) << way << " at " << 10 * i << " ms";
    EXPECT_NEAR(a[i].speed, b[i].speed, 3) << way << " at " << 10 * i << " ms";
    EXPECT_NEAR(a[i].current, b[i].current, 0.2) << way << " at " << 10 * i << " ms";
  }
}

TEST(MasterStory, GivesTheSameMotorTraceOverEveryProtocol) {
  const Trace reference = tell_story(kWays[0]);
  ASSERT_EQ(reference.ramp.size(), 250u);
  EXPECT_NEAR(reference.ramp[80].frequency, 20, 1);  // 50 Hz in 2 s
  EXPECT_DOUBLE_EQ(reference.ramp.back().frequency, 40);
  for (std::size_t i = 1; i < std::size(kWays); ++i) {
    const Trace other = tell_story(kWays[i]);
    expect_alike(reference.ramp, other.ramp, kWays[i].name);
    expect_alike(reference.second_ramp, other.second_ramp, kWays[i].name);
    EXPECT_NEAR(to_seconds(reference.stop_to_trip), to_seconds(other.stop_to_trip), 0.004) << kWays[i].name;
    EXPECT_NEAR(reference.dc_link_at_trip, other.dc_link_at_trip, 5) << kWays[i].name;
  }
}

}  // namespace
}  // namespace vinv::test
