#include "motor_model/inverter/a700/operation_mode.hpp"

namespace vinv::inverter::a700 {
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
};

// Pr.340 = 10 and 12: NET takes the place of external operation. Not with Pr.79 = 7 ("same as when Pr.340 = 0").
bool without_external(const ModeSituation& s) {
  return (s.raw_pr340 == 10 || s.raw_pr340 == 12) && s.raw_pr79 != kInterlock;
}

bool reachable(OperationMode mode, const ModeSituation& s) {
  switch (s.raw_pr79) {
    case kPuOnly: return mode == OperationMode::kPu;
    case kCombined1: return mode == OperationMode::kCombined1;
    case kCombined2: return mode == OperationMode::kCombined2;
    case kExternalOnly:
      return mode == OperationMode::kNetwork || (mode == OperationMode::kExternal && !without_external(s));
    case kInterlock:
      if (!s.interlock_off) return mode == OperationMode::kExternal;
      break;
    default: break;
  }
  if (mode == OperationMode::kExternal) return !without_external(s);
  return mode == OperationMode::kPu || mode == OperationMode::kNetwork;
}

OperationMode home(const ModeSituation& s) {
  return without_external(s) ? OperationMode::kNetwork : OperationMode::kExternal;
}

// X66 goes before X65, and both before X16. Empty: no terminal has one that can act.
std::optional<OperationMode> by_signals(const ModeSituation& s) {
  if (s.x66 && !without_external(s)) return *s.x66 ? OperationMode::kNetwork : OperationMode::kExternal;
  if (s.x65) return *s.x65 ? OperationMode::kPu : OperationMode::kNetwork;
  if (s.x16 && !without_external(s)) return *s.x16 ? OperationMode::kExternal : OperationMode::kPu;
  return std::nullopt;
}

bool may_change_now(const ModeSituation& s) {
  return s.raw_pr79 == kSwitchWhileRunning || (s.stopped && !s.start_signal);
}

}  // namespace

OperationMode start_mode(const ModeSituation& s) {
  switch (s.raw_pr79) {
    case kPuOnly: return OperationMode::kPu;
    case kCombined1: return OperationMode::kCombined1;
    case kCombined2: return OperationMode::kCombined2;
    case kInterlock:
      return (s.raw_pr340 == 1 || s.raw_pr340 == 2) && s.interlock_off ? OperationMode::kNetwork
                                                                       : OperationMode::kExternal;
    default: break;
  }
  return s.raw_pr340 != 0 ? OperationMode::kNetwork : OperationMode::kExternal;
}

Result<OperationMode, Refusal> request_mode(OperationMode now, ModeRequest request, const ModeSituation& s) {
  OperationMode wanted = now;
  switch (request) {
    case ModeRequest::kNetworkOn:
      wanted = OperationMode::kNetwork;
      // PU and NET are exchanged through external operation, or while running with Pr.79 = 6.
      if (now == OperationMode::kPu && s.raw_pr79 != kSwitchWhileRunning) {
        return Unexpected(Refusal::kModeChangeRefused);
      }
      break;
    case ModeRequest::kNetworkOff:
      wanted = OperationMode::kExternal;
      // The network leaves its own mode only, and PU operation where it may set that itself.
      if (now == OperationMode::kPu && s.raw_pr79 != kSwitchWhileRunning) {
        return Unexpected(Refusal::kModeChangeRefused);
      }
      break;
    case ModeRequest::kPanelByNetwork:
      if (s.raw_pr79 != kSwitchWhileRunning) return Unexpected(Refusal::kModeChangeRefused);
      wanted = OperationMode::kPu;
      break;
    case ModeRequest::kPanelKey:
      if (now == OperationMode::kPu) {
        wanted = home(s);
      } else if (now == home(s)) {
        wanted = OperationMode::kPu;
      } else {
        return Unexpected(Refusal::kModeChangeRefused);
      }
      break;
  }
  if (wanted == now) return now;
  if (!reachable(wanted, s) || !may_change_now(s)) return Unexpected(Refusal::kModeChangeRefused);
  if (const auto fixed = by_signals(s); fixed && *fixed != wanted) return Unexpected(Refusal::kModeChangeRefused);
  return wanted;
}

OperationMode follow_settings(OperationMode now, const ModeSituation& s) {
  // Taking away the interlock ends PU and NET operation at once; everything else waits for standstill.
  if (s.raw_pr79 == kInterlock && !s.interlock_off && (now == OperationMode::kPu || now == OperationMode::kNetwork)) {
    return OperationMode::kExternal;
  }
  if (!may_change_now(s)) return now;
  if (const auto fixed = by_signals(s); fixed && reachable(*fixed, s)) return *fixed;
  if (reachable(now, s)) return now;
  for (OperationMode mode : {home(s), OperationMode::kPu, OperationMode::kCombined1, OperationMode::kCombined2}) {
    if (reachable(mode, s)) return mode;
  }
  return now;
}

}  // namespace vinv::inverter::a700
