// One master's share of the inverter's dual-port RAM: it reads at will and sees its own write only. The inverter has
// one write mailbox (port::DrivePort) for CANopen and Modbus: what one of them posts while the other's write is there
// waits, and is the next.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "motor_model/port/drive_port.hpp"
#include "sim/base/archive.hpp"

namespace vinv::boards::oi_fr_e5nco {

enum class MailboxUser : std::uint8_t { kModbus, kCanopen };
VINV_ENUM_RANGE(MailboxUser, kModbus, kCanopen);

// Who has the mailbox and what waits for it; common to the shares of one inverter.
struct Mailbox {
  struct Waiting {
    Instant since{};
    port::WriteRequest request;
    VINV_ARCHIVE(Waiting, since, request);
  };
  std::optional<MailboxUser> owner;
  std::array<std::optional<Waiting>, 2> waiting{};  // by user
  VINV_ARCHIVE(Mailbox, owner, waiting);
};

class MailboxShare final : public port::DrivePort {
 public:
  // drive and mailbox outlive the share.
  MailboxShare(port::DrivePort& drive, Mailbox& mailbox, MailboxUser self)
      : drive_(drive), mailbox_(mailbox), self_(self) {}

  port::WriteOutcome post_write(Instant now, const port::WriteRequest& request) override {
    if (mailbox_.owner == self_ || slot(self_)) return Unexpected(port::Refusal::kBusy);
    if (!mailbox_.owner) return post(self_, now, request);
    if (!drive_.ready()) return Unexpected(port::Refusal::kNotReady);
    slot(self_) = Mailbox::Waiting{now, request};
    return {};
  }
  bool write_pending() const override {
    return mailbox_.waiting[index(self_)].has_value() || (mailbox_.owner == self_ && drive_.write_pending());
  }
  std::optional<port::WriteOutcome> take_outcome() override {
    if (!mailbox_.owner) {
      // Its own write waited, and the mailbox became free while the inverter could not take it.
      if (const auto waiting = std::exchange(slot(self_), std::nullopt)) {
        if (auto posted = post(self_, waiting->since, waiting->request); !posted) return posted;
      }
    }
    if (mailbox_.owner != self_) return std::nullopt;
    auto outcome = drive_.take_outcome();
    // Not pending and no outcome: the inverter restarted and lost it.
    if (outcome || !drive_.write_pending()) {
      mailbox_.owner.reset();
      auto& next = slot(other());
      if (next && post(other(), next->since, next->request)) next.reset();
    }
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
  static std::size_t index(MailboxUser user) { return static_cast<std::size_t>(user); }
  std::optional<Mailbox::Waiting>& slot(MailboxUser user) { return mailbox_.waiting[index(user)]; }
  MailboxUser other() const { return self_ == MailboxUser::kModbus ? MailboxUser::kCanopen : MailboxUser::kModbus; }
  port::WriteOutcome post(MailboxUser user, Instant now, const port::WriteRequest& request) {
    const port::WriteOutcome posted = drive_.post_write(now, request);
    if (posted) mailbox_.owner = user;
    return posted;
  }

  port::DrivePort& drive_;
  Mailbox& mailbox_;
  MailboxUser self_;
};

}  // namespace vinv::boards::oi_fr_e5nco
