// A run is saved and goes on as another one: its result is that of a run that nobody interrupted.
#include "sim/scenario/virtual_run.hpp"

#include <algorithm>

#include "sim/base/random.hpp"
#include "sim/scenario/junit.hpp"
#include "sim/scenario/protocol_masters.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/html_report.hpp"
#include "sim/scenario/report/wire_report.hpp"
#include "sim/scenario/snapshot_file.hpp"
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

LoadOptions with_masters() {
  LoadOptions options = testing::load_options();
  options.masters = protocol_masters();
  return options;
}
RunOptions speaking() {
  RunOptions options;
  options.masters = protocol_masters();
  return options;
}

RunOptions small_recording() {
  RunOptions options;
  options.recording.max_cells = 60'000;  // thinned out on the way
  return options;
}

std::string reports(const Scenario& s, const RunResult& r) {
  JunitWriter junit("unused");
  junit.write(nullptr, r);
  const Bytes capture = wire_pcapng(r.recording);
  return html_report(&s, r, "build", {}) + signals_csv(r.recording) + states_csv(r.recording) + events_csv(r) +
         candump_log(r.recording) + std::string(capture.begin(), capture.end()) + junit.text();
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

std::vector<Duration> random_instants(Random& random, std::size_t count, const RunResult& whole) {
  const auto last = static_cast<std::uint64_t>(whole.end.time_since_epoch() / milliseconds(100));
  std::vector<Duration> instants;
  for (std::size_t i = 0; i < count; ++i)
    instants.push_back(milliseconds(100) * static_cast<std::int64_t>(random.below(last)));
  std::sort(instants.begin(), instants.end());
  return instants;
}

// A trip, restarts, persistence, masters of every kind, a bus that fails: 200 instants in all.
TEST(Interrupted, ShippedScenariosAreResumedAtTwoHundredRandomInstants) {
  constexpr std::size_t kEach = 10;
  Random random(11);
  std::size_t interruptions = 0;
  for (const char* name : {"over_voltage_trip",
                           "restart_after_dip",
                           "two_drives",
                           "parameter_persistence",
                           "option_board_failure",
                           "dc_brake",
                           "s_curve",
                           "panel_operation",
                           "multi_speed",
                           "master_modbus",
                           "master_modbus_tcp",
                           "master_canopen",
                           "master_canopen_402",
                           "communication/can_bus_off",
                           "communication/can_master_silent_2",
                           "communication/modbus_master_silent",
                           "mode/manual_modbus_examples",
                           "mode/manual_canopen_examples",
                           "mode/eeprom_or_ram",
                           "mode/quick_stop"}) {
    const Scenario s =
        load_scenario(VINV_SOURCE_DIR "/scenarios/fr-e500/" + std::string(name) + ".yaml", with_masters());
    const RunResult whole = run_virtual(s, rig::shipped_catalogue(), speaking());
    ASSERT_EQ(whole.verdict, Verdict::kPassed) << name << failures(whole);
    const RunResult resumed = relayed(s, random_instants(random, kEach, whole), speaking(), &interruptions);
    EXPECT_TRUE(reports(s, resumed) == reports(s, whole)) << name << failures(resumed);
  }
  EXPECT_EQ(interruptions, 20 * kEach);
}

// Requests and answers are under way at most instants, late, damaged or doubled; a connection is half open.
constexpr const char* kTalk =
    "# Four masters on wires with faults.\n"
    "plant:\n"
    "  networks: { line: { can: virtual, bitrate: 125k } }\n"
    "  drives:\n"
    "    - { name: a, inverter: { model: FR-E540-0.75K }, board: { type: oi-fr-e5nco, node: 5, network: line },\n"
    "        parameters: { Pr.7: 0.5, Pr.8: 0.5 } }\n"
    "    - { name: b, inverter: { model: FR-E540-1.5K }, board: { type: oi-fr-e5nco, node: 6, network: line } }\n"
    "limit: 30 s\n"
    "tracks:\n"
    "  pdo:\n"
    "    - { drive: a, when: ready, via: canopen, mode: NET }\n"
    "    - { drive: a, via: canopen, reference: 20 Hz }\n"
    "    - { drive: a, via: canopen, run: forward }\n"
    "    - { drive: a, wire: { delay: 7 ms, share: 40 %, port: can } }\n"
    "    - { drive: a, wire: { corrupt: 20 %, port: can } }\n"
    "    - { drive: a, wire: { reorder: 30 ms, share: 20 %, port: can } }\n"
    "    - repeat:\n"
    "        times: 12\n"
    "        steps:\n"
    "          - { drive: a, after: 90 ms, via: canopen, reference: 30 Hz }\n"
    "          - { drive: a, after: 110 ms, via: canopen_sdo, monitor: output_frequency }\n"
    "          - { drive: a, after: 110 ms, via: canopen, reference: 20 Hz }\n"
    "  rtu:\n"
    "    - { drive: b, when: ready, after: 10 ms, wire: { delay: 12 ms, share: 50 %, port: serial } }\n"
    "    - { drive: b, wire: { corrupt: 15 %, port: serial } }\n"
    "    - repeat:\n"
    "        times: 8\n"
    "        steps:\n"
    "          - { drive: b, after: 30 ms, via: modbus, monitor: output_frequency }\n"
    "          - { drive: b, after: 20 ms, via: modbus, parameter: [Pr.7, Pr.8] }\n"
    "  tcp:\n"
    "    - { drive: b, when: ready, after: 300 ms, wire: { delay: 40 ms, share: 60 %, port: tcp } }\n"
    "    - { drive: b, wire: { split: 2 ms, share: 50 %, port: tcp } }\n"
    "    - repeat:\n"
    "        times: 10\n"
    "        steps: [ { drive: b, after: 10 ms, via: modbus_tcp, monitor: status } ]\n"
    "    - { drive: b, wire: half_open }\n"
    "    - { drive: b, via: modbus_tcp, monitor: status, refused: yes }\n"
    "    - { drive: b, after: 700 ms, via: modbus_tcp, monitor: status }\n";

TEST(Interrupted, MastersOnWiresWithFaultsGoOnByteForByteWithAnySeed) {
  const Scenario s = read(kTalk, with_masters());
  std::string first;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    RunOptions options = speaking();
    options.seed = seed;
    const RunResult whole = run_virtual(s, rig::shipped_catalogue(), options);
    ASSERT_NE(whole.verdict, Verdict::kNotRun) << whole.reason;
    EXPECT_GT(whole.recording.wire.size(), 60u);
    std::vector<Duration> instants;
    for (Instant at{}; at < whole.end; at += milliseconds(100)) instants.push_back(at.time_since_epoch());
    EXPECT_GT(instants.size(), 12u) << failures(whole);
    const RunResult resumed = relayed(s, instants, options);
    EXPECT_TRUE(reports(s, resumed) == reports(s, whole)) << seed << failures(resumed);
    EXPECT_NE(reports(s, whole), first);
    first = reports(s, whole);
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
  run.run_until(milliseconds(1500));
  Bytes saved;
  ASSERT_TRUE(run.save(saved));
  for (const Scenario* s : {&light, &heavy, &light}) {
    const RunResult forked = resume_virtual(*s, catalogue, {}, saved);
    EXPECT_TRUE(reports(*s, forked) == reports(*s, run_virtual(*s, catalogue, {}))) << failures(forked);
  }
  EXPECT_EQ(run.finish().verdict, Verdict::kPassed);
}

TEST(Fork, AnotherSeedIsOtherLuckFromTheSnapshotOn) {
  const Scenario s = read(kTalk, with_masters());
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  VirtualRun run(s, catalogue, speaking());
  const auto at = run.run_to_grid(milliseconds(650));
  ASSERT_TRUE(at) << at.error();
  EXPECT_EQ(*at, milliseconds(700));
  Bytes saved;
  ASSERT_TRUE(run.save(saved));
  const auto forked = [&](std::optional<std::uint64_t> seed) {
    RunOptions options = speaking();
    options.seed = seed;
    const RunResult r = resume_virtual(s, catalogue, options, saved);
    EXPECT_NE(r.verdict, Verdict::kNotRun) << r.reason;
    return states_csv(r.recording) + events_csv(r) + candump_log(r.recording);
  };
  const std::string same = forked(std::nullopt);
  EXPECT_EQ(forked(1), same);
  EXPECT_NE(forked(2), same);
  EXPECT_EQ(forked(2), forked(2));
  EXPECT_NE(forked(2), forked(3));
}

// In the first round of a loop, before its last step: masters that the snapshot does not know, and none.
TEST(Fork, WhatIsStillToComeInALoopMayBeOther) {
  const auto ending = [](const std::string& step) {
    return read(
        "# Loops.\n"
        "plant:\n"
        "  networks: { line: { can: virtual } }\n"
        "  drives: [ { board: { type: oi-fr-e5nco, node: 5, network: line } } ]\n"
        "steps:\n"
        "  - { when: ready, note: up }\n"
        "  - repeat: { times: 3, steps: [ { after: 1 s, note: a }, " +
            step + " ] }\n",
        with_masters());
  };
  const Scenario plain = ending("{ after: 300 ms, note: b }");
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  VirtualRun run(plain, catalogue, speaking());
  run.run_until(milliseconds(700));
  Bytes saved;
  ASSERT_TRUE(run.save(saved));
  for (const char* step : {"{ after: 1 s, note: c }", "{ via: modbus, mode: NET }", "{ via: canopen, mode: NET }"}) {
    const Scenario other = ending(step);
    const RunResult forked = resume_virtual(other, catalogue, speaking(), saved);
    EXPECT_EQ(forked.verdict, Verdict::kPassed) << step << failures(forked);
    EXPECT_TRUE(reports(other, forked) == reports(other, run_virtual(other, catalogue, speaking()))) << step;
  }
  // In the second round it waits for the end of these 300 ms.
  run.run_until(milliseconds(2800));
  ASSERT_TRUE(run.save(saved));
  const RunResult late = resume_virtual(ending("{ after: 1 s, note: c }"), catalogue, speaking(), saved);
  EXPECT_EQ(late.verdict, Verdict::kNotRun);
}

TEST(SnapshotFiles, ASavedRunComesBackAndAForeignBuildOrDamageIsRefused) {
  const std::string path = ::testing::TempDir() + "/vinv_snapshot_file_test";
  const Scenario s = read(kStory);
  VirtualRun run(s, rig::shipped_catalogue(), {});
  run.run_until(seconds(2));
  SnapshotFile file{"1.0 (abc)", "story.yaml", seconds(2), {}};
  ASSERT_TRUE(run.save(file.bytes));
  ASSERT_TRUE(write_snapshot_file(path, file));
  const auto back = read_snapshot_file(path, "1.0 (abc)");
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->bytes, file.bytes);
  EXPECT_EQ(read_snapshot_file(path, "1.1 (def)").error(),
            "the snapshot " + path +
                " cannot be used: it was written by build 1.0 (abc), this is 1.1 (def). Snapshots serve the build that "
                "wrote them.");
  file.bytes[file.bytes.size() / 2] ^= 1;
  ASSERT_TRUE(write_snapshot_file(path, file));
  EXPECT_NE(read_snapshot_file(path, "1.0 (abc)").error().find("checksum"), std::string::npos);
  EXPECT_NE(read_snapshot_file(VINV_SOURCE_DIR "/README.md", "1.0 (abc)").error().find("no snapshot"),
            std::string::npos);
  EXPECT_NE(read_snapshot_file(path + "/x", "1.0 (abc)").error().find("no such file"), std::string::npos);
  EXPECT_NE(write_snapshot_file("/dev/full", file).error().find("No space left"), std::string::npos);
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
  EXPECT_NE(over.error().find("the run is over at "), std::string::npos);
}

}  // namespace
}  // namespace vinv::scenario
