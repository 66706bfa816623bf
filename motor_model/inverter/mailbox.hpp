// The write mailbox between option board and inverter: one request at a time, decided at a control tick, its outcome
// collected once (OI-FR-E5NCO manual, 8.3.4). Plain data.
#pragma once

#include <optional>

#include "motor_model/port/drive_port.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter {

class Mailbox {
 public:
  bool pending() const { return request_.has_value() || outcome_.has_value(); }
  port::WriteOutcome post(const port::WriteRequest& request) {
    if (pending()) return Unexpected(port::Refusal::kBusy);
    request_ = request;
    return {};
  }
  // For the control tick.
  const std::optional<port::WriteRequest>& request() const { return request_; }
  void decide(port::WriteOutcome outcome) {
    request_.reset();
    outcome_ = outcome;
  }
  std::optional<port::WriteOutcome> take() {
    auto taken = outcome_;
    outcome_.reset();
    return taken;
  }

 private:
  std::optional<port::WriteRequest> request_;
  std::optional<port::WriteOutcome> outcome_;
  VINV_ARCHIVE(Mailbox, request_, outcome_);
};

}  // namespace vinv::inverter
