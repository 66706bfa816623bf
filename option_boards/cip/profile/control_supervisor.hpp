// The Control Supervisor object, class 0x29: state, run commands, fault reset. CIP Vol 1, 5-29 (AC/DC drive profile
// 6-7); FR-A7NE manual, 7.5; OPC-E11S-DEV manual, 4.7; 3G3AX-MX2-CRT-E manual, appendix D.
//
// What differs from board to board is data: which attributes exist is the board's table, how commands act is here.
#pragma once

#include <cstdint>
#include <optional>

#include "motor_model/port/drive_port.hpp"
#include "sim/base/archive.hpp"

namespace vinv::cip {

// Attribute 6.
enum class SupervisorState : std::uint8_t {
  kStartup = 1,
  kNotReady = 2,
  kReady = 3,
  kEnabled = 4,
  kStopping = 5,
  kFaultStop = 6,
  kFaulted = 7,
};

// started: the drive has been ready since power-on; before that it starts up, afterwards it is being reset.
inline SupervisorState supervisor_state(const port::DrivePort& drive, bool started) {
  if (!drive.ready()) return started ? SupervisorState::kNotReady : SupervisorState::kStartup;
  const port::Status status = drive.status();
  if (status.alarm) return SupervisorState::kFaulted;
  if (!status.running) return SupervisorState::kReady;
  if (status.fault_stop) return SupervisorState::kFaultStop;
  return status.stopping ? SupervisorState::kStopping : SupervisorState::kEnabled;
}

// Attributes 3 and 4 as a direction. kLevels: each attribute is a start signal of the drive, which knows what both
// mean. kEdges: the run/stop event matrix of the profile, where a rising edge starts and both at once do nothing new.
enum class RunStyle : std::uint8_t { kLevels, kEdges };

struct RunSignals {
  bool forward = false;
  bool reverse = false;
  friend constexpr bool operator==(const RunSignals&, const RunSignals&) = default;
  VINV_ARCHIVE(RunSignals, forward, reverse);
};

// The start signals among terminals.
constexpr RunSignals run_signals_of(port::NetTerminals terminals) {
  return {terminals.has(port::NetTerminal::kStf), terminals.has(port::NetTerminal::kStr)};
}

// The start signals that follow from Run1 and Run2 going from before to now; acting: the signals as they are.
constexpr RunSignals run_signals(RunStyle style, RunSignals before, RunSignals now, RunSignals acting) {
  if (style == RunStyle::kLevels) return now;
  if (!now.forward && !now.reverse) return {};
  const bool forward_rises = now.forward && !before.forward;
  const bool reverse_rises = now.reverse && !before.reverse;
  if (forward_rises && reverse_rises) return acting;
  if (now.forward && now.reverse) {
    // The second one to come acts only from standstill; nothing changes.
    return acting;
  }
  // One alone, by its own edge or because the other one fell (matrix rows 1->0, 1 and 1, 1->0).
  return now.forward ? RunSignals{true, false} : RunSignals{false, true};
}

// Attribute 12 and the Fault Reset bit of the output assemblies: acts when it goes from 0 to 1, and not again before it
// was 0.
class FaultResetEdge {
 public:
  // True: reset now.
  bool write(bool value) {
    const bool rises = value && !value_;
    value_ = value;
    return rises;
  }
  bool value() const { return value_; }

 private:
  bool value_ = false;
  VINV_ARCHIVE(FaultResetEdge, value_);
};

}  // namespace vinv::cip
