// The velocity mode's state machine. CiA DSP-402 v1.1, device control and velocity mode; OI-FR-E5NCO manual, 7.5.
//
// The states are the board's own, the DC link has voltage all the time. "Start", "Not ready to switch on" and "Fault
// reaction active" do not exist: the node comes up in Switch on disabled, an alarm leads to Fault at once.
// Unspecified: bits 4-6 of the controlword (ramp generator) are ignored; bit 8 halts; the halted motor ramps down.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::boards::oi_fr_e5nco {

enum class DriveState : std::uint8_t {
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFault,
};
VINV_ENUM_RANGE(DriveState, kSwitchOnDisabled, kFault);

// What a controlword asks of the inverter.
enum class DriveAction : std::uint8_t {
  kNone,
  kRun,        // or ramp to 0, as target velocity and halt bit say
  kRampDown,   // release the start signals: normal deceleration
  kCoast,      // shut the output off
  kQuickStop,  //
  kReset,      // inverter reset
};

// What the statusword reports beside the state.
struct DriveConditions {
  bool alarm = false;
  bool ready = false;            // the inverter has started up
  bool network_mode = false;     // commands of the network count
  bool running = false;          // the output is on
  bool up_to_frequency = false;  //
  bool overload = false;
};

class DriveProfile {
 public:
  DriveAction handle_controlword(std::uint16_t word);
  // The loss of the connection or the NMT state as 6007H treats it.
  DriveAction disable_voltage();
  DriveAction quick_stop();
  // The inverter refused what should have led to Operation enabled.
  void on_run_refused();
  // The inverter restarted: nothing is enabled any more.
  void on_restart() { state_ = DriveState::kSwitchOnDisabled; }
  // Fault follows the alarm; a quick stop ends at standstill.
  void follow(bool alarm, bool running);

  DriveState state() const { return state_; }
  std::uint16_t controlword() const { return controlword_; }
  bool halted() const;
  std::uint16_t statusword(const DriveConditions& conditions) const;

 private:
  DriveState state_ = DriveState::kSwitchOnDisabled;
  std::uint16_t controlword_ = 0;
  bool stop_began_ = false;  // Quick stop active: the motor has been seen turning, or a tick has passed
  VINV_ARCHIVE(DriveProfile, state_, controlword_, stop_began_);
};

}  // namespace vinv::boards::oi_fr_e5nco
