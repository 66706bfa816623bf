// An inverter as a board sees it, with tables of its own: parameters, monitors, modes and a mailbox that decides after
// a number of ticks. It follows the rules of port::DrivePort and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "motor_model/port/drive_port.hpp"

namespace vinv::test {

class FakeDrive final : public port::DrivePort {
 public:
  using Kind = port::WriteRequest::Kind;
  struct Parameter {
    std::uint32_t value = 0, min = 0, max = 0xffff;
    bool read_only = false;
    bool writable_while_running = false;
  };

  // What tests set.
  std::map<std::uint16_t, Parameter> parameters{
      {0, {60, 0, 300}},   {1, {12000, 0, 12000}}, {7, {50, 0, 36000}},    {144, {4, 0, 110}},
      {345, {25, 0, 255}}, {347, {4, 0, 255}},     {342, {0, 0, 1, true}}, {4, {5000, 0, 40000, false, true}}};
  std::map<std::pair<std::uint16_t, std::uint8_t>, Parameter> calibration;  // parameters of two words
  std::map<unsigned, std::uint16_t> monitors{{1, 0}, {2, 0}, {3, 0}};
  port::AlarmHistory history{};
  port::Status status_now{};
  port::OperationMode mode = port::OperationMode::kExternal;
  bool is_ready = true;
  bool parameters_readable = true;
  bool write_disabled = false;          // Pr.77 = 1
  std::uint32_t max_frequency = 40000;  // 0.01 Hz
  unsigned ticks_to_decide = 1;
  unsigned dead_ticks_after_reset = 100;
  std::optional<port::Refusal> refuse_decision;  // instead of the decision
  std::optional<port::Refusal> refuse_post;
  port::NetTerminals signals_on;   // start signals of any source
  bool storage_fails = false;      // accepted parameter writes cannot be stored
  port::DriveFacts facts_now;
  bool jogs = false;
  bool reset_needs_alarm = false;  // Pr.75, for resets that ask
  std::uint16_t set_frequency = 0;  // of the network, 0.01 Hz

  // What tests look at.
  std::vector<port::WriteRequest> posted;
  std::vector<port::WriteRequest> executed;
  bool communication_lost = false, option_failed = false;

  // A control tick of 1 ms.
  void tick() {
    if (dead_ticks_ > 0 && --dead_ticks_ == 0) is_ready = true;
    if (!request_ || outcome_ || ++waited_ < ticks_to_decide) return;
    outcome_ = refuse_decision ? port::WriteOutcome(Unexpected(*refuse_decision)) : decide(*request_);
    if (*outcome_) executed.push_back(*request_);
    if (*outcome_ && storage_fails && stores(request_->kind)) ++storage_failures_;
  }
  // The supply went or the inverter restarted: the mailbox is empty.
  void lose_mailbox() {
    request_.reset();
    outcome_.reset();
  }

  bool ready() const override { return is_ready; }
  port::OperationMode operation_mode() const override { return mode; }
  port::Status status() const override { return status_now; }
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned number) const override {
    const auto found = monitors.find(number);
    if (found == monitors.end()) return Unexpected(port::Refusal::kNoSuchItem);
    return found->second;
  }
  Result<std::uint32_t, port::Refusal> read_parameter(port::ParameterId id) const override {
    if (!parameters_readable) return Unexpected(port::Refusal::kNotReady);
    const Parameter* found = find(id);
    if (found == nullptr) return Unexpected(port::Refusal::kNoSuchItem);
    return found->value;
  }
  port::AlarmHistory alarm_history() const override { return history; }
  std::uint8_t active_alarm() const override { return status_now.alarm ? history[0] : std::uint8_t{0}; }

  port::NetTerminals start_signals() const override { return signals_on; }
  std::uint32_t storage_failures() const override { return storage_failures_; }
  bool jog_operation() const override { return jogs; }
  port::DriveFacts facts() const override { return facts_now; }
  std::uint16_t network_frequency() const override { return set_frequency; }

  port::WriteOutcome post_write(Instant, const port::WriteRequest& request) override {
    if (refuse_post) return Unexpected(*refuse_post);
    if (request_) return Unexpected(port::Refusal::kBusy);
    if (!is_ready) return Unexpected(port::Refusal::kNotReady);
    posted.push_back(request);
    request_ = request;
    waited_ = 0;
    return {};
  }
  bool write_pending() const override { return request_.has_value(); }
  std::optional<port::WriteOutcome> take_outcome() override {
    if (!outcome_) return std::nullopt;
    const std::optional<port::WriteOutcome> taken = outcome_;
    lose_mailbox();
    return taken;
  }
  void set_communication_lost(bool lost) override { communication_lost = lost; }
  void set_option_failed(bool failed) override { option_failed = failed; }

 private:
  static bool stores(Kind kind) {
    return kind == Kind::kParameter || kind == Kind::kRestoreDefaults || kind == Kind::kClearAlarmHistory ||
           kind == Kind::kStoredFrequency;
  }
  const Parameter* find(port::ParameterId id) const {
    if (const auto word = parameters.find(id.number); word != parameters.end() && id.sub == 0) return &word->second;
    const auto one_of_two = calibration.find({id.number, id.sub});
    return one_of_two == calibration.end() ? nullptr : &one_of_two->second;
  }
  port::WriteOutcome decide(const port::WriteRequest& request) {
    using port::Refusal;
    if (request.kind == Kind::kOperationMode) {
      if (status_now.running) return Unexpected(Refusal::kModeChangeRefused);
      constexpr port::OperationMode kModes[] = {port::OperationMode::kExternal, port::OperationMode::kNetwork,
                                                port::OperationMode::kPu};
      if (request.value > 2) return Unexpected(Refusal::kOutOfRange);
      mode = kModes[request.value];
      return {};
    }
    if (request.kind == Kind::kErrorReset) {
      if (!status_now.alarm) return Unexpected(Refusal::kNotFaulted);
      status_now.alarm = false;
      return {};
    }
    if (mode != port::OperationMode::kNetwork) return Unexpected(Refusal::kWrongMode);
    switch (request.kind) {
      case Kind::kFrequency:
      case Kind::kStoredFrequency:
        if (request.value > max_frequency) return Unexpected(Refusal::kOutOfRange);
        set_frequency = static_cast<std::uint16_t>(request.value);
        return {};
      case Kind::kParameter: return write_parameter(request);
      case Kind::kClearAlarmHistory: history = {}; return {};
      case Kind::kResetInverter:
        if (request.value == 1 && reset_needs_alarm && !status_now.alarm) return Unexpected(Refusal::kNotFaulted);
        is_ready = false;
        dead_ticks_ = dead_ticks_after_reset;
        return {};
      default: return {};
    }
  }
  port::WriteOutcome write_parameter(const port::WriteRequest& request) {
    using port::Refusal;
    const Parameter* found = find(request.parameter);
    if (found == nullptr) return Unexpected(Refusal::kNoSuchItem);
    auto& parameter = const_cast<Parameter&>(*found);
    if (parameter.read_only) return Unexpected(Refusal::kReadOnly);
    if (write_disabled) return Unexpected(Refusal::kWriteDisabled);
    if (status_now.running && !parameter.writable_while_running) return Unexpected(Refusal::kRunning);
    if (request.value < parameter.min || request.value > parameter.max) return Unexpected(Refusal::kOutOfRange);
    parameter.value = request.value;
    return {};
  }

  std::optional<port::WriteRequest> request_;
  std::optional<port::WriteOutcome> outcome_;
  std::uint32_t storage_failures_ = 0;
  unsigned waited_ = 0;
  unsigned dead_ticks_ = 0;
};

}  // namespace vinv::test
