#include "option_boards/boards/oi_fr_e5nco/drive_profile.hpp"

#include <utility>

namespace vinv::boards::oi_fr_e5nco {
namespace {

enum ControlBit : std::uint16_t {
  kSwitchOn = 1u << 0,
  kEnableVoltage = 1u << 1,
  kNoQuickStop = 1u << 2,
  kEnableOperation = 1u << 3,
  kFaultReset = 1u << 7,
  kHalt = 1u << 8,
};

enum StatusBit : std::uint16_t {
  kVoltageEnabled = 1u << 4,
  kWarning = 1u << 7,
  kRemote = 1u << 9,
  kTargetReached = 1u << 10,
};

// Bits 0-3, 5 and 6 of the statusword.
std::uint16_t state_bits(DriveState state) {
  switch (state) {
    case DriveState::kSwitchOnDisabled: return 0x40;
    case DriveState::kReadyToSwitchOn: return 0x21;
    case DriveState::kSwitchedOn: return 0x23;
    case DriveState::kOperationEnabled: return 0x27;
    case DriveState::kQuickStopActive: return 0x07;
    case DriveState::kFault: return 0x08;
  }
  return 0;
}

}  // namespace

bool DriveProfile::halted() const { return (controlword_ & kHalt) != 0; }

DriveAction DriveProfile::handle_controlword(std::uint16_t word) {
  const std::uint16_t before = std::exchange(controlword_, word);
  const auto has = [word](ControlBit bit) { return (word & bit) != 0; };
  if (state_ == DriveState::kFault) {
    const bool edge = has(kFaultReset) && (before & kFaultReset) == 0;
    return edge ? DriveAction::kReset : DriveAction::kNone;
  }
  if (!has(kEnableVoltage)) return disable_voltage();
  if (!has(kNoQuickStop)) return quick_stop();
  if (!has(kSwitchOn)) {  // shutdown
    if (state_ == DriveState::kQuickStopActive) return DriveAction::kNone;
    // Transition 8 takes the power from a turning motor.
    const bool turning = state_ == DriveState::kOperationEnabled;
    state_ = DriveState::kReadyToSwitchOn;
    return turning ? DriveAction::kCoast : DriveAction::kNone;
  }
  const bool enable = has(kEnableOperation);
  switch (state_) {
    case DriveState::kReadyToSwitchOn:
    case DriveState::kSwitchedOn:
      // Switch on and enable operation in one controlword passes both transitions.
      state_ = enable ? DriveState::kOperationEnabled : DriveState::kSwitchedOn;
      return enable ? DriveAction::kRun : DriveAction::kNone;
    case DriveState::kOperationEnabled:
      if (enable) return DriveAction::kRun;
      state_ = DriveState::kSwitchedOn;
      return DriveAction::kRampDown;
    default: return DriveAction::kNone;
  }
}

DriveAction DriveProfile::disable_voltage() {
  if (state_ == DriveState::kFault) return DriveAction::kNone;
  const DriveState before = std::exchange(state_, DriveState::kSwitchOnDisabled);
  const bool turning = before == DriveState::kOperationEnabled || before == DriveState::kQuickStopActive;
  return turning ? DriveAction::kCoast : DriveAction::kNone;
}

DriveAction DriveProfile::quick_stop() {
  switch (state_) {
    case DriveState::kOperationEnabled:
      state_ = DriveState::kQuickStopActive;
      stop_began_ = false;
      return DriveAction::kQuickStop;
    case DriveState::kReadyToSwitchOn:
    case DriveState::kSwitchedOn: state_ = DriveState::kSwitchOnDisabled; return DriveAction::kNone;
    default: return DriveAction::kNone;
  }
}

void DriveProfile::on_run_refused() {
  if (state_ == DriveState::kOperationEnabled) state_ = DriveState::kSwitchedOn;
}

void DriveProfile::follow(bool alarm, bool running) {
  if (alarm) {
    state_ = DriveState::kFault;
  } else if (state_ == DriveState::kFault) {
    state_ = DriveState::kSwitchOnDisabled;
  } else if (state_ == DriveState::kQuickStopActive) {
    // The state lasts at least until the next tick has shown whether the motor turns.
    if (stop_began_ && !running) state_ = DriveState::kSwitchOnDisabled;
    stop_began_ = true;
  }
}

std::uint16_t DriveProfile::statusword(const DriveConditions& c) const {
  std::uint16_t word = state_bits(state_);
  if (c.ready) word |= kVoltageEnabled;
  if (c.overload) word |= kWarning;
  if (c.network_mode) word |= kRemote;
  // A halted motor has reached its target at standstill.
  const bool reached = halted() ? !c.running : c.up_to_frequency;
  if (state_ == DriveState::kOperationEnabled && reached) word |= kTargetReached;
  return word;
}

}  // namespace vinv::boards::oi_fr_e5nco
