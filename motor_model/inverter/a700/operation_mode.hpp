// FR-A700 operation modes: who may change to which mode, and which one follows power-on. FR-A7NE manual 4.3.2 (Pr.79,
// Pr.340); X12, X16, X65, X66 typical for the family. Pure functions.
#pragma once

#include <optional>

#include "motor_model/inverter/mitsubishi/mode_request.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter::a700 {

using mitsubishi::ModeRequest;

struct ModeSituation {
  int raw_pr79 = 0;
  int raw_pr340 = 0;           // as it was at power-on or reset
  bool interlock_off = false;  // X12 (without it MRS) on while Pr.79 = 7: the mode may be chosen
  // Signals that choose the mode, where a terminal has them.
  std::optional<bool> x16{};  // on external, off PU
  std::optional<bool> x65{};  // on PU, off NET
  std::optional<bool> x66{};  // on NET, off external
  bool stopped = true;        // output off
  bool start_signal = false;  // any start command of any source
};

// Mode after power-on or reset.
port::OperationMode start_mode(const ModeSituation& situation);

// A refusal leaves the mode as it is.
Result<port::OperationMode, port::Refusal> request_mode(port::OperationMode now, ModeRequest request,
                                                        const ModeSituation& situation);

// What Pr.79 and its signals make of the mode without any request; the same mode where they leave a choice.
port::OperationMode follow_settings(port::OperationMode now, const ModeSituation& situation);

}  // namespace vinv::inverter::a700
