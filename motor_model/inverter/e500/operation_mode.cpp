#include "motor_model/inverter/e500/operation_mode.hpp"

namespace vinv::inverter::e500 {
namespace {

using port::OperationMode;
using port::Refusal;

enum Pr79 : int {
  kSwitchable = 0,
  kPuOnly = 1,
  kExternalOnly = 2,
  kCombined1 = 3,
  kCombined2 = 4,
  kSwitchWhileRunning = 6,
  kInterlock = 7,
  kX16 = 8,
};

bool network_reachable(const ModeSituation& s) {
  if (!s.option_fitted) return false;
  switch (s.raw_pr79) {
    case kSwitchable:
    case kExternalOnly:
    case kSwitchWhileRunning: return true;
    case kInterlock: return s.interlock_off;
    default: return false;  // Unspecified: with Pr.79 = 8 signal X16 alone decides between PU and external.
  }
}

bool panel_reachable(const ModeSituation& s) {
  return s.raw_pr79 == kSwitchable || s.raw_pr79 == kSwitchWhileRunning ||
         (s.raw_pr79 == kInterlock && s.interlock_off);
}

}  // namespace

OperationMode start_mode(const ModeSituation& s) {
  switch (s.raw_pr79) {
    case kPuOnly: return OperationMode::kPu;
    case kCombined1: return OperationMode::kCombined1;
    case kCombined2: return OperationMode::kCombined2;
    case kX16: return s.x16 ? OperationMode::kExternal : OperationMode::kPu;
    default: break;
  }
  return s.raw_pr340 != 0 && network_reachable(s) ? OperationMode::kNetwork : OperationMode::kExternal;
}

Result<OperationMode, Refusal> request_mode(OperationMode now, ModeRequest request, const ModeSituation& s) {
  OperationMode wanted = now;
  switch (request) {
    case ModeRequest::kNetworkOn:
      if (now == OperationMode::kNetwork) return now;
      // PU and network are exchanged through external operation only.
      if (now != OperationMode::kExternal || !network_reachable(s)) return Unexpected(Refusal::kModeChangeRefused);
      wanted = OperationMode::kNetwork;
      break;
    case ModeRequest::kNetworkOff:
      if (now != OperationMode::kNetwork) return now;
      wanted = OperationMode::kExternal;
      break;
    case ModeRequest::kPanelByNetwork: return Unexpected(Refusal::kModeChangeRefused);
    case ModeRequest::kPanelKey:
      if (now != OperationMode::kExternal && now != OperationMode::kPu) return Unexpected(Refusal::kModeChangeRefused);
      if (!panel_reachable(s)) return Unexpected(Refusal::kModeChangeRefused);
      wanted = now == OperationMode::kPu ? OperationMode::kExternal : OperationMode::kPu;
      break;
  }
  if (s.raw_pr79 != kSwitchWhileRunning && (!s.stopped || s.start_signal)) {
    return Unexpected(Refusal::kModeChangeRefused);
  }
  return wanted;
}

OperationMode follow_settings(OperationMode now, const ModeSituation& s) {
  // Taking away the interlock ends PU operation at once; everything else waits for standstill.
  if (s.raw_pr79 == kInterlock && !s.interlock_off && now == OperationMode::kPu) return OperationMode::kExternal;
  if (!s.stopped || s.start_signal) return now;
  switch (s.raw_pr79) {
    case kPuOnly: return OperationMode::kPu;
    case kCombined1: return OperationMode::kCombined1;
    case kCombined2: return OperationMode::kCombined2;
    case kX16: return s.x16 ? OperationMode::kExternal : OperationMode::kPu;
    case kExternalOnly: return now == OperationMode::kNetwork ? now : OperationMode::kExternal;
    case kInterlock:
      if (!s.interlock_off) return OperationMode::kExternal;
      break;
    default: break;
  }
  const bool combined = now == OperationMode::kCombined1 || now == OperationMode::kCombined2;
  return combined ? OperationMode::kExternal : now;
}

}  // namespace vinv::inverter::e500
