// A random day of an FR-E500, as a list of actions fixed by its seed: keys, terminals, noise on the analog inputs,
// network writes, parameters, loads, mains dips, faults, resets, power cycles. The same list can be played to many
// inverters, in pieces; what each answered goes into a trace.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "sim/base/random.hpp"

namespace vinv::inverter::test {

// A hash per tick of all that can be seen from outside.
class Trace {
 public:
  void add(const void* data, std::size_t size) {
    hash_ = hash_ * 31 + snapshot_checksum({static_cast<const std::uint8_t*>(data), size});
  }
  void add(std::string_view text) { add(text.data(), text.size()); }
  void add(double value) { add(&value, sizeof value); }
  void add(const Outcome& outcome) { add(outcome ? "accepted" : outcome.error()); }
  void add(const port::WriteOutcome& outcome) { add(outcome ? -1.0 : static_cast<double>(outcome.error())); }
  std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

// What can be seen without changing anything.
inline void look(Inverter& inverter, int tick, Trace& trace) {
  const port::DrivePort& port = inverter.port();
  for (const SignalValue& s : inverter.signals()) trace.add(s.value);
  for (const auto& [name, on] : inverter.terminals()) trace.add(on ? 1.0 : 0.0);
  const port::Status s = port.status();
  trace.add(s.running + 2 * s.forward + 4 * s.reverse + 8 * s.up_to_frequency + 16 * s.overload + 32 * s.power_failure +
            64 * s.frequency_detected + 128 * s.alarm + 256 * s.ready + 512 * port.ready() + 1024 * inverter.powered() +
            2048 * port.write_pending() + 4096.0 * static_cast<int>(port.operation_mode()));
  for (unsigned monitor : {1u, 2u, 3u}) trace.add(port.read_monitor(monitor).value_or(std::uint16_t{0}));
  // All parameters in turn.
  const port::ParameterId id{static_cast<std::uint16_t>(tick % 350), 0};
  trace.add(port.read_parameter(id).value_or(~0u));
  const port::AlarmHistory history = port.alarm_history();
  trace.add(history.data(), history.size());
  trace.add(port.active_alarm() + 256.0 * port.start_signals().bits + 1e6 * port.storage_failures());
  trace.add(inverter.display());
  trace.add(inverter.alarm_name());
  trace.add(inverter.alarm_cause());
  const plant::EnergyCounters& e = inverter.plant().energy();
  trace.add(e.from_mains_j + e.stator_copper_j + e.inverter_j + e.brake_j + e.friction_j + e.load_j);
  trace.add(inverter.plant().stored_energy_j());
}

inline void observe(Inverter& inverter, int tick, Trace& trace) {
  look(inverter, tick, trace);
  // A slow board: snapshots meet requests and outcomes in the mailbox.
  if (tick % 7 == 0) {
    if (const auto outcome = inverter.port().take_outcome()) trace.add(*outcome);
  }
  if (inverter.take_eeprom_changed()) trace.add(inverter.eeprom_text());
}

class RandomStory {
 public:
  static constexpr int kFirstTick = 5000;  // time does not start at zero
  static constexpr int kChapterTicks = 3000;

  RandomStory(std::uint64_t seed, int ticks) : random_(seed), actions_(static_cast<std::size_t>(ticks)) {
    at(0, [](Inverter& i, Trace&) { i.set_power(true); });
    for (int tick = 450; tick < ticks; ++tick) {
      if (tick % kChapterTicks == 450) begin_chapter(tick);
      if (tick % 3 == 0 && tick / kChapterTicks % 2 == 1) noise(tick);
      if (chance(0.012)) choose(tick);
    }
  }

  int ticks() const { return static_cast<int>(actions_.size()); }

  // The tick with all that happens before it.
  void play(Inverter& inverter, int tick, Trace& trace) const {
    for (const Action& action : actions_[static_cast<std::size_t>(tick)]) action(inverter, trace);
    inverter.tick(instant_from_ns((kFirstTick + tick) * 1'000'000LL));
    observe(inverter, tick, trace);
  }

 private:
  using Action = std::function<void(Inverter&, Trace&)>;

  bool chance(double p) { return random_.uniform() < p; }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  template <class T, std::size_t kSize>
  const T& one_of(const T (&choices)[kSize]) {
    return choices[random_.below(kSize)];
  }
  void at(int tick, Action action) {
    if (tick < ticks()) actions_[static_cast<std::size_t>(tick)].push_back(std::move(action));
  }

  // Puts right what went wrong, and runs in one of the operation modes.
  void begin_chapter(int tick) {
    for (const char* name : {"STF", "STR", "RH", "RM", "RL", "MRS", "RES"}) terminal(tick, name, false);
    at(tick, [](Inverter& i, Trace& t) {
      i.set_power(true);
      i.set_mains({});
      i.set_shaft_locked(false);
      t.add(i.press_key(PanelKey::kStopReset));
    });
    post(tick + 1, {.kind = port::WriteRequest::Kind::kCommand});
    post(tick + 10, {.kind = port::WriteRequest::Kind::kOperationMode, .value = 0});
    tick += 300;
    if (chance(0.5)) {
      terminal(tick, "RES", true);
      terminal(tick + 30, "RES", false);
      tick += 1050;
    }
    const bool cleared = chance(0.3);
    const double mode = static_cast<double>(random_.below(3) == 0 ? 3 + random_.below(2) : 0);
    const double hz = between(5, 60);
    const double ramp_s = chance(0.3) ? 0.1 : 0.7;
    const bool tunes = chance(0.15);
    const bool coasts = chance(0.2);
    const bool dips = chance(0.3);
    at(tick, [cleared, mode, hz, ramp_s, tunes, coasts, dips](Inverter& i, Trace& t) {
      t.add(i.set_parameter("Pr.77", 2));
      if (cleared) t.add(i.set_parameter("ALLC", 1));
      t.add(i.set_parameter("Pr.79", mode));
      t.add(i.set_parameter("Pr.7", ramp_s));
      t.add(i.set_parameter("Pr.8", ramp_s));
      t.add(i.set_analog("2", hz / 12));
      if (coasts) t.add(i.set_parameter("Pr.250", 0.2));
      if (dips) t.add(i.set_parameter("Pr.57", 0.1));
      if (tunes) t.add(i.set_parameter("Pr.80", 1.5));
      if (tunes) t.add(i.set_parameter("Pr.96", 1));
    });
    if (dips) {
      at(tick + 900, [](Inverter& i, Trace&) { i.set_mains({.voltage_v_rms = 0}); });
      at(tick + 960, [](Inverter& i, Trace&) { i.set_mains({}); });
    }
    tick += 5;
    switch (random_.below(3)) {
      case 0: return terminal(tick, chance(0.7) ? "STF" : "STR", true);
      case 1: {
        const bool jog = chance(0.5);
        at(tick, [hz, jog](Inverter& i, Trace& t) {
          if (i.port().operation_mode() != port::OperationMode::kPu) t.add(i.press_key(PanelKey::kPuExt));
          t.add(i.set_panel_frequency(hz));
          for (int n = 0; jog && n < 3 && i.display() != "JOG"; ++n) t.add(i.press_key(PanelKey::kMode));
        });
        return at(tick + 50, [](Inverter& i, Trace& t) { t.add(i.press_key(PanelKey::kFwd)); });
      }
      default: {
        port::WriteRequest run{.kind = port::WriteRequest::Kind::kCommand};
        run.terminals.set(chance(0.7) ? port::NetTerminal::kStf : port::NetTerminal::kStr, true);
        post(tick, {.kind = port::WriteRequest::Kind::kOperationMode, .value = 1});
        post(tick + 2, {.kind = port::WriteRequest::Kind::kFrequency, .value = static_cast<std::uint32_t>(hz * 100)});
        return post(tick + 4, run);
      }
    }
  }

  void noise(int tick) {
    const double v = between(2, 4);
    at(tick, [v](Inverter& i, Trace& t) {
      t.add(i.set_analog("2", v));
      t.add(i.set_analog("4", 4 * v));
    });
  }

  void terminal(int tick, const char* name, bool on) {
    at(tick, [name, on](Inverter& i, Trace& t) { t.add(i.set_terminal(name, on)); });
  }

  void post(int tick, const port::WriteRequest& request) {
    at(tick, [request](Inverter& i, Trace& t) { t.add(i.port().post_write(Instant{}, request)); });
  }

  void parameter(int tick) {
    struct Setting {
      const char* name;
      double value;
    };
    static constexpr Setting kSettings[] = {
        {"Pr.7", 0.3},   {"Pr.7", 1.5},    {"Pr.8", 0.1},   {"Pr.8", 0.8},  {"Pr.29", 0},     {"Pr.29", 1},
        {"Pr.29", 2},    {"Pr.22", 120},   {"Pr.22", 150},  {"Pr.22", 0},   {"Pr.60", 0},     {"Pr.60", 1},
        {"Pr.60", 11},   {"Pr.57", 0},     {"Pr.57", 9999}, {"Pr.57", 0.2}, {"Pr.58", 0.3},   {"Pr.79", 0},
        {"Pr.79", 3},    {"Pr.79", 4},     {"Pr.79", 6},    {"Pr.340", 1},  {"Pr.340", 0},    {"Pr.339", 1},
        {"Pr.339", 0},   {"Pr.338", 1},    {"Pr.338", 0},   {"Pr.128", 20}, {"Pr.128", 21},   {"Pr.128", 0},
        {"Pr.59", 1},    {"Pr.59", 2},     {"Pr.59", 0},    {"Pr.67", 3},   {"Pr.67", 102},   {"Pr.67", 0},
        {"Pr.68", 0.2},  {"Pr.75", 14},    {"Pr.75", 2},    {"Pr.80", 1.5}, {"Pr.80", 9999},  {"Pr.96", 1},
        {"Pr.96", 0},    {"Pr.72", 14},    {"Pr.72", 1},    {"Pr.245", 4},  {"Pr.245", 9999}, {"Pr.250", 9999},
        {"Pr.250", 0.2}, {"Pr.250", 8888}, {"Pr.77", 0},    {"Pr.77", 2},   {"Pr.244", 1},    {"Pr.44", 0.4},
        {"Pr.183", 3},   {"Pr.182", 5},    {"Pr.182", 2},   {"Pr.183", 6},  {"Pr.52", 100},   {"Pr.173", 7},
        {"Pr.10", 5},    {"Pr.11", 0.4},   {"Pr.9", 0.8},   {"Pr.9", 3.6},  {"Pr.37", 0},     {"Pr.160", 0},
        {"Pr.342", 1},   {"Pr.342", 0},    {"Pr.171", 0},   {"Pr.CL", 1},   {"Pr.156", 0},    {"Pr.156", 16},
        {"Pr.31", 20},   {"Pr.32", 30},    {"Pr.74", 4},    {"Pr.17", 2},   {"Pr.17", 0},     {"Pr.129", 50},
        {"Pr.30", 1},    {"Pr.70", 10},    {"Pr.251", 1},   {"Pr.150", 80}, {"Pr.19", 8888},  {"Pr.65", 1}};
    const Setting s = one_of(kSettings);
    at(tick, [s](Inverter& i, Trace& t) { t.add(i.set_parameter(s.name, s.value)); });
  }

  void network(int tick) {
    using Kind = port::WriteRequest::Kind;
    switch (random_.below(12)) {
      case 0: return post(tick, {.kind = Kind::kOperationMode, .value = 0});
      case 1:
      case 2: return post(tick, {.kind = Kind::kOperationMode, .value = 1});
      case 3: return post(tick, {.kind = Kind::kParameter, .parameter = {4, 0}, .value = 3000});
      case 4: return post(tick, {.kind = Kind::kParameter, .parameter = {7, 0}, .value = 7});
      case 5: return post(tick, {.kind = Kind::kAnalogReference, .value = 128});
      case 6: return post(tick, {.kind = chance(0.2) ? Kind::kClearAlarmHistory : Kind::kResetInverter});
      case 7:
        at(tick, [](Inverter& i, Trace&) { i.port().set_communication_lost(true); });
        return at(tick + 90, [](Inverter& i, Trace&) { i.port().set_communication_lost(false); });
      case 8: return post(tick, {.kind = Kind::kFrequency, .value = static_cast<std::uint32_t>(random_.below(6000))});
      default: {
        port::WriteRequest request{.kind = Kind::kCommand};
        request.terminals.bits = static_cast<std::uint16_t>(random_.below(2) + 1) << 1;  // STF or STR
        if (chance(0.2)) request.terminals.bits = static_cast<std::uint16_t>(random_.below(1024));
        post(tick, {.kind = Kind::kFrequency, .value = 4000});
        return post(tick + 4, request);
      }
    }
  }

  void surroundings(int tick) {
    const int span = 20 + static_cast<int>(random_.below(400));
    switch (random_.below(7)) {
      case 0: {
        plant::LoadSettings load;
        load.inertia_kg_m2 = between(0, 0.1);
        load.constant_nm = between(0, 12);
        if (chance(0.3)) load.hoist_nm = between(-4, 4);
        const double start_s = tick * 1e-3;
        if (chance(0.4)) load.table = {{start_s, 0}, {start_s + 0.25, between(0, 30)}, {start_s + 0.6, 2}};
        return at(tick, [load](Inverter& i, Trace&) { i.set_load(load); });
      }
      case 1:
        at(tick, [](Inverter& i, Trace&) { i.set_shaft_locked(true); });
        return at(tick + span, [](Inverter& i, Trace&) { i.set_shaft_locked(false); });
      case 2:
      case 3: {
        // Short dips, and failures that take the control down.
        const bool fails = chance(0.4);
        plant::MainsState mains{.voltage_v_rms = fails ? 0 : between(0, 420)};
        at(tick, [mains](Inverter& i, Trace&) { i.set_mains(mains); });
        return at(tick + (fails ? 6 * span : span), [](Inverter& i, Trace&) { i.set_mains({}); });
      }
      case 4: {
        plant::MainsState mains;
        mains.phase_present[random_.below(3)] = false;
        at(tick, [mains](Inverter& i, Trace&) { i.set_mains(mains); });
        return at(tick + span, [](Inverter& i, Trace&) { i.set_mains({}); });
      }
      case 5: {
        const double ambient = between(0, 60);
        return at(tick, [ambient](Inverter& i, Trace&) { i.set_ambient(ambient); });
      }
      default:
        at(tick, [](Inverter& i, Trace&) { i.set_power(false); });
        return at(tick + 4 * span, [](Inverter& i, Trace&) { i.set_power(true); });
    }
  }

  void fault(int tick) {
    static constexpr const char* kCauses[] = {"earth_fault", "output_phase_open", "brake_transistor", "eeprom_write",
                                              "option",      "external_thermal",  "pu_disconnected"};
    if (chance(0.3)) {
      static constexpr const char* kAlarms[] = {"E.OC1", "E.OV3", "E.THM", "E.PE", "E.OPT", "E.CPU"};
      const char* name = one_of(kAlarms);
      return at(tick, [name](Inverter& i, Trace& t) { t.add(i.inject_fault(name, true)); });
    }
    const char* name = one_of(kCauses);
    at(tick, [name](Inverter& i, Trace& t) { t.add(i.inject_fault(name, true)); });
    at(tick + 80, [name](Inverter& i, Trace& t) { t.add(i.inject_fault(name, false)); });
  }

  void eeprom(int tick) {
    if (chance(0.3)) return at(tick, [](Inverter& i, Trace& t) { t.add(i.load_eeprom("no EEPROM")); });
    at(tick, [](Inverter& i, Trace& t) { t.add(i.load_eeprom(i.eeprom_text())); });
  }

  void choose(int tick) {
    static constexpr const char* kStarts[] = {"STF", "STR", "STF", "RH", "RM", "RL"};
    static constexpr PanelKey kKeys[] = {PanelKey::kFwd,   PanelKey::kRev,  PanelKey::kFwd,  PanelKey::kStopReset,
                                         PanelKey::kPuExt, PanelKey::kUp,   PanelKey::kDown, PanelKey::kMode,
                                         PanelKey::kSet,   PanelKey::kMode, PanelKey::kFwd};
    const double what = random_.uniform();
    if (what < 0.25) return terminal(tick, one_of(kStarts), chance(0.6));
    if (what < 0.45) {
      const PanelKey key = one_of(kKeys);
      return at(tick, [key](Inverter& i, Trace& t) { t.add(i.press_key(key)); });
    }
    if (what < 0.5) {
      const double hz = between(0, 60);
      return at(tick, [hz](Inverter& i, Trace& t) { t.add(i.set_panel_frequency(hz)); });
    }
    if (what < 0.64) return parameter(tick);
    if (what < 0.8) return network(tick);
    if (what < 0.9) return surroundings(tick);
    if (what < 0.92) return fault(tick);
    if (what < 0.925) return eeprom(tick);
    if (what < 0.945) {
      terminal(tick, "MRS", true);
      return terminal(tick + 150, "MRS", false);
    }
    // Alarms do not last: somebody resets.
    terminal(tick, "RES", true);
    terminal(tick + 60, "RES", false);
  }

  Random random_;
  std::vector<std::vector<Action>> actions_;
};

}  // namespace vinv::inverter::test
