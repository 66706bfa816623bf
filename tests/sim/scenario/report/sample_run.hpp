// Runs for the tests of the reports, made by hand: small ones whose every byte can be written down, and a long one.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sim/scenario/result.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

inline Instant at_ms(std::int64_t ms) { return Instant{std::chrono::milliseconds(ms)}; }

// Three samples, one trip, a failed check.
inline RunResult small_run() {
  RunResult r;
  r.path = "scenarios/fr-e500/stop.yaml";
  r.name = "stop";
  r.title = "A short stop trips on over-voltage";
  r.seed = 7;
  r.verdict = Verdict::kFailed;
  r.end = at_ms(20);
  r.events = {{at_ms(0), Event::Kind::kAction, "fan", "run: forward", 12},
              {at_ms(10), Event::Kind::kTrip, "fan", "trip E.OV3: DC link 802 V", 0}};
  CheckResult passed;
  passed.passed = true;
  passed.at = at_ms(5);
  passed.drive = "fan";
  passed.what = "output_frequency";
  passed.expected = "above 0 Hz";
  passed.seen = "1.25 Hz";
  passed.where = {14, 5};
  passed.events_before = 1;
  CheckResult failed = passed;
  failed.passed = false;
  failed.at = at_ms(20);
  failed.what = "alarm";
  failed.expected = "none";
  failed.seen = "E.OV3";
  failed.cause = "DC link 802 V, deceleration 0.5 s";
  failed.where = {16, 5};
  failed.events_before = 2;
  r.checks = {passed, failed};
  Recording& rec = r.recording;
  rec.times = {at_ms(0), at_ms(10), at_ms(20)};
  rec.columns = {{"fan", "output_frequency", "Hz", {0, 1.25, 50.1}}, {"fan", "fan", "-", {1, 1, 1}}};
  rec.states = {{"fan", "alarm", {{at_ms(0), "none"}, {at_ms(10), "E.OV3"}}, 0}};
  rec.finest = std::chrono::milliseconds(1);
  rec.coarsest = std::chrono::milliseconds(10);
  rec.windows = 1;
  return r;
}

inline WireRecord wire(std::int64_t ms, WireRecord::Kind kind, const std::string& network, const std::string& sender,
                       std::uint32_t id, Bytes bytes) {
  WireRecord r;
  r.at = at_ms(ms);
  r.kind = kind;
  r.network = network;
  r.sender = sender;
  r.id = id;
  r.bytes = std::move(bytes);
  return r;
}

inline std::vector<WireRecord> sample_wire() {
  using Kind = WireRecord::Kind;
  return {wire(1, Kind::kCanFrame, "line can", "master", 0x605, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}),
          wire(2, Kind::kCanFrame, "line can", "fan", 0x80000123, {0xDE, 0xAD}),
          wire(3, Kind::kCanFrame, "line can", "master", 0x40000705, {0}),
          wire(4, Kind::kCanError, "line can", "fan", 0x20000088, {0, 0, 1, 10, 0, 0, 0, 0}),
          wire(5, Kind::kSerial, "rtu", "master", 0, {5, 3, 0x5A, 0x3C, 0, 1, 0x57, 0x0A}),
          wire(9, Kind::kSerial, "rtu", "fan", 0, {5, 3, 2, 0x0F, 0xA0, 0x4D, 0xCC}),
          wire(10, Kind::kTcp, "127.0.0.1:1502", "master", 0, {0, 1, 0, 0, 0, 6, 5, 3, 0x5A, 0x3C, 0, 1}),
          wire(12, Kind::kTcp, "127.0.0.1:1502", "fan", 0, {0, 1, 0, 0, 0, 5, 5, 3, 2, 0x0F, 0xA0})};
}

// One drive for 60 s, every millisecond of it, with a trip; frames: on a CAN bus, evenly spread.
inline RunResult long_run(std::size_t frames) {
  RunResult r = small_run();
  r.end = at_ms(60'000);
  Recording& rec = r.recording;
  rec = {};
  rec.finest = rec.coarsest = std::chrono::milliseconds(1);
  struct Kind {
    const char* name;
    const char* unit;
    double scale;
    double wobble;
  };
  const std::vector<Kind> kinds = {{"set_frequency", "Hz", 50, 0},
                                   {"output_frequency", "Hz", 50, 0},
                                   {"output_current", "A", 3.1, 0.2},
                                   {"output_voltage", "V", 380, 1},
                                   {"dc_link", "V", 540, 4},
                                   {"speed", "rpm", 1450, 2},
                                   {"torque", "Nm", 9.5, 0.3},
                                   {"load_torque", "Nm", 9.0, 0.01},
                                   {"shaft_power", "W", 1400, 8},
                                   {"input_power", "W", 1650, 20},
                                   {"output_power", "W", 1600, 9},
                                   {"brake_power", "W", 0, 0},
                                   {"motor_thermal", "%", 63, 0.001},
                                   {"inverter_thermal", "%", 40, 0.001},
                                   {"brake_duty", "%", 0, 0},
                                   {"heat_sink", "degC", 45, 0.001},
                                   {"winding", "degC", 70, 0.001},
                                   {"run_state", "-", 3, 0},
                                   {"alarm_code", "-", 0, 0},
                                   {"am", "V", 10, 0.01},
                                   {"fan", "-", 1, 0},
                                   {"carrier", "Hz", 14500, 0},
                                   {"operating_hours", "h", 1, 0}};
  for (const Kind& k : kinds) rec.columns.push_back({"fan", k.name, k.unit, {}});
  for (int ms = 0; ms <= 60'000; ++ms) {
    rec.times.push_back(at_ms(ms));
    const double t = ms * 1e-3;
    const double ramp = ms < 41'200 ? std::min({t / 5, 1.0, std::max(0.0, (45 - t) / 5)}) : 0;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const bool steady = kinds[i].name == std::string("fan") || kinds[i].name == std::string("carrier");
      rec.columns[i].values.push_back(kinds[i].scale * (steady ? 1 : ramp) +
                                      kinds[i].wobble * std::sin(t * (20 + static_cast<double>(i))));
    }
  }
  rec.states = {{"fan", "running", {{at_ms(0), "off"}, {at_ms(100), "on"}, {at_ms(41'200), "off"}}, 0},
                {"fan", "alarm", {{at_ms(0), "none"}, {at_ms(41'200), "E.OV3"}, {at_ms(50'000), "none"}}, 0},
                {"fan", "mode", {{at_ms(0), "PU"}, {at_ms(40), "NET"}}, 0}};
  StateTrace blinking{"fan", "led", {}, 0};
  for (int ms = 0; ms < 60'000; ms += 50) blinking.changes.push_back({at_ms(ms), ms % 100 == 0 ? "on" : "off"});
  rec.states.push_back(blinking);
  r.events = {
      {at_ms(0), Event::Kind::kAction, "fan", "power on", 10},
      {at_ms(100), Event::Kind::kAction, "fan", "run: forward", 12},
      {at_ms(5100), Event::Kind::kState, "fan", "at reference", 0},
      {at_ms(40'000), Event::Kind::kAction, "fan", "stop", 15},
      {at_ms(41'200), Event::Kind::kTrip, "fan", "trip E.OV3: DC link 802 V at 41.200 s, deceleration 0.5 s", 0},
      {at_ms(50'000), Event::Kind::kAction, "fan", "reset", 17},
      {at_ms(55'000), Event::Kind::kNote, "", "end of the story", 18}};
  r.checks[0].at = at_ms(5100);
  r.checks[1].at = at_ms(41'300);
  r.checks[1].events_before = 5;
  for (std::size_t i = 0; i < frames; ++i) {
    WireRecord f = wire(0, WireRecord::Kind::kCanFrame, "line_can", i % 2 == 0 ? "master" : "fan",
                        i % 2 == 0 ? 0x205 : 0x185, {0x0F, 0, 0x88, 0x13, static_cast<std::uint8_t>(i), 0, 0, 0});
    f.at = instant_from_ns(static_cast<std::int64_t>(i) * 60'000'000'000 / static_cast<std::int64_t>(frames));
    rec.wire.push_back(f);
  }
  return r;
}

}  // namespace vinv::scenario
