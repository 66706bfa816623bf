// One master's share of the inverter's dual-port RAM: it reads at will and sees its own write only. The inverter has
// one write mailbox (port::DrivePort); whoever posted collects the outcome, the other one finds it busy until then.
#pragma once

#include <cstdint>

#include "motor_model/port/drive_port.hpp"

namespace vinv::boards::oi_fr_e5nco {

enum class MailboxUser : std::uint8_t { kNobody, kModbus, kCanopen };

class MailboxShare final : public port::DrivePort {
 public:
  // drive and owner outlive the share; owner is common to all shares of one inverter and starts as kNobody.
  MailboxShare(port::DrivePort& drive, MailboxUser& owner, MailboxUser self)
      : drive_(drive), owner_(owner), self_(self) {}

  port::WriteOutcome post_write(Instant now, const port::WriteRequest& request) override {
    if (owner_ != MailboxUser::kNobody) return Unexpected(port::Refusal::kBusy);
    const port::WriteOutcome posted = drive_.post_write(now, request);
    if (posted) owner_ = self_;
    return posted;
  }
  bool write_pending() const override { return owner_ == self_ && drive_.write_pending(); }
  std::optional<port::WriteOutcome> take_outcome() override {
    if (owner_ != self_) return std::nullopt;
    auto outcome = drive_.take_outcome();
    // Not pending and no outcome: the inverter restarted and lost it.
    if (outcome || !drive_.write_pending()) owner_ = MailboxUser::kNobody;
    return outcome;
  }

  bool ready() const override { return drive_.ready(); }
  port::OperationMode operation_mode() const override { return drive_.operation_mode(); }
  port::Status status() const override { return drive_.status(); }
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned number) const override {
    return drive_.read_monitor(number);
  }
  Result<std::uint32_t, port::Refusal> read_parameter(port::ParameterId id) const override {
    return drive_.read_parameter(id);
  }
  port::AlarmHistory alarm_history() const override { return drive_.alarm_history(); }
  std::uint8_t active_alarm() const override { return drive_.active_alarm(); }
  port::NetTerminals start_signals() const override { return drive_.start_signals(); }
  std::uint32_t storage_failures() const override { return drive_.storage_failures(); }
  void set_communication_lost(bool lost) override { drive_.set_communication_lost(lost); }
  void set_option_failed(bool failed) override { drive_.set_option_failed(failed); }

 private:
  port::DrivePort& drive_;
  MailboxUser& owner_;
  MailboxUser self_;
};

}  // namespace vinv::boards::oi_fr_e5nco
