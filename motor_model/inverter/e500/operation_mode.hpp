// FR-E500 operation modes with a network option: who may change to which mode, and which one follows power-on.
// OI-FR-E5NCO manual 4.1, 4.2; Pr.79 and Pr.340 typical for the family. Pure functions.
#pragma once

#include "motor_model/inverter/mitsubishi/mode_request.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/result.hpp"

namespace vinv::inverter::e500 {

using mitsubishi::ModeRequest;

struct ModeSituation {
  int raw_pr79 = 0;
  int raw_pr340 = 0;
  bool interlock_off = false;  // MRS on while Pr.79 = 7: PU operation is permitted
  bool x16 = false;            // Pr.79 = 8: on is external operation
  bool option_fitted = true;
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

}  // namespace vinv::inverter::e500
