// An inverter on a test bench, an FR-E500 unless told otherwise: makes one, lets time pass tick by tick, plays panel and network master.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "motor_model/inverter/inverter.hpp"

namespace vinv::inverter::test {

inline InverterConfig config_for(std::string model, std::string_view machine) {
  InverterConfig c;
  c.model = std::move(model);
  c.motor = *plant::find_machine(machine);
  return c;
}

inline InverterConfig config_1k5() { return config_for("FR-E540-1.5K", "iec4p_1k5kW_400V"); }

class Bench {
 public:
  explicit Bench(const InverterConfig& config = config_1k5(), std::string_view family = "fr-e500") {
    auto made = make_inverter(family, config);
    EXPECT_TRUE(made.has_value()) << (made ? "" : made.error());
    inverter_ = std::move(made).value();
  }

  Inverter& operator*() { return *inverter_; }
  Inverter* operator->() { return inverter_.get(); }
  port::DrivePort& port() { return inverter_->port(); }
  Instant now() const { return now_; }
  void set_now(Instant now) { now_ = now; }
  double now_s() const { return to_seconds(now_); }

  void tick() {
    inverter_->tick(now_);
    now_ += Inverter::kControlPeriod;
  }
  void run(double seconds) {
    const auto ticks = std::lround(seconds / 1e-3);
    for (long i = 0; i < ticks; ++i) tick();
  }
  // False if it does not happen in time.
  bool run_until(const std::function<bool()>& done, double within_s) {
    const auto ticks = std::lround(within_s / 1e-3);
    for (long i = 0; i < ticks && !done(); ++i) tick();
    return done();
  }
  Bench& power_on() {
    inverter_->set_power(true);
    EXPECT_TRUE(run_until([this] { return port().ready(); }, 2.0));
    return *this;
  }
  void power_cycle() {
    inverter_->set_power(false);
    EXPECT_TRUE(run_until([this] { return !inverter_->powered(); }, 60.0));
    power_on();
  }

  // --- network master ---
  port::WriteOutcome write(const port::WriteRequest& request) {
    if (const auto posted = port().post_write(now_, request); !posted) return posted;
    tick();
    const auto outcome = port().take_outcome();
    EXPECT_TRUE(outcome.has_value());
    return outcome ? *outcome : port::WriteOutcome(Unexpected(port::Refusal::kBusy));
  }
  port::WriteOutcome net(bool on = true) {
    return write({.kind = port::WriteRequest::Kind::kOperationMode, .value = on ? 1u : 0u});
  }
  port::WriteOutcome write_parameter(unsigned number, std::uint32_t raw, unsigned sub = 0) {
    return write({.kind = port::WriteRequest::Kind::kParameter,
                  .parameter = {static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)},
                  .value = raw});
  }
  port::WriteOutcome command(std::initializer_list<port::NetTerminal> on) {
    port::WriteRequest request{.kind = port::WriteRequest::Kind::kCommand};
    for (port::NetTerminal t : on) request.terminals.set(t, true);
    return write(request);
  }
  port::WriteOutcome frequency(double hz) {
    return write(
        {.kind = port::WriteRequest::Kind::kFrequency, .value = static_cast<std::uint32_t>(std::lround(hz * 100))});
  }
  port::WriteOutcome reset() { return write({.kind = port::WriteRequest::Kind::kResetInverter}); }
  std::uint32_t raw(unsigned number, unsigned sub = 0) {
    return port().read_parameter({static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)}).value_or(~0u);
  }
  double output_hz() { return port().read_monitor(1).value_or(std::uint16_t{0}) / 100.0; }
  double output_a() { return port().read_monitor(2).value_or(std::uint16_t{0}) / 100.0; }
  double output_v() { return port().read_monitor(3).value_or(std::uint16_t{0}) / 10.0; }

  // --- person at the drive ---
  void preset(const std::string& name, double value) {
    const auto ok = inverter_->preset_parameter(name, value);
    ASSERT_TRUE(ok.has_value()) << ok.error();
  }
  void terminal(std::string_view name, bool on = true) { ASSERT_TRUE(inverter_->set_terminal(name, on).has_value()); }
  void key(PanelKey k) {
    const auto ok = inverter_->press_key(k);
    ASSERT_TRUE(ok.has_value()) << ok.error();
  }
  void pu() {
    key(PanelKey::kPuExt);
    ASSERT_EQ(port().operation_mode(), port::OperationMode::kPu);
  }
  double signal(std::string_view name) {
    for (const SignalValue& s : inverter_->signals()) {
      if (s.name == name) return s.value;
    }
    ADD_FAILURE() << "no signal " << name;
    return 0;
  }
  bool output(std::string_view terminal) {
    for (const auto& [name, on] : inverter_->terminals()) {
      if (name == terminal) return on;
    }
    ADD_FAILURE() << "no terminal " << terminal;
    return false;
  }
  bool alarm(std::string_view name) { return inverter_->alarm_name() == name; }

 private:
  std::unique_ptr<Inverter> inverter_;
  Instant now_ = instant_from_ns(5'000'000'000);
};

inline testing::AssertionResult refused(const port::WriteOutcome& outcome, port::Refusal why) {
  if (outcome) return testing::AssertionFailure() << "accepted";
  if (outcome.error() != why)
    return testing::AssertionFailure() << "refused with reason " << static_cast<int>(outcome.error());
  return testing::AssertionSuccess();
}

// Short ramps, so that a second shows what a command does.
inline Bench fast(std::initializer_list<std::pair<std::string, double>> presets = {}) {
  Bench b;
  b.preset("Pr.7", 0.2);
  b.preset("Pr.8", 0.2);
  for (const auto& [name, value] : presets) b.preset(name, value);
  b.power_on();
  return b;
}
inline bool runs_at(Bench& b, double hz) {
  b.run(1.2);
  return b.port().status().running && std::abs(b.output_hz() - hz) < 0.02;
}
inline bool stands(Bench& b) {
  b.run(1.5);
  return !b.port().status().running;
}

}  // namespace vinv::inverter::test
