#include "motor_model/inverter/a700/communication_error.hpp"

namespace vinv::inverter::a700 {

void CommunicationError::reset() {
  const bool lost = last_lost_;
  *this = CommunicationError{};
  last_lost_ = lost;
}

CommunicationError::Alarm CommunicationError::step(double dt_s, const Input& in) {
  occurred_ = in.line_lost && !last_lost_;
  last_lost_ = in.line_lost;
  shown_ = false;
  const bool recognised = lost_.step(dt_s, in.line_lost && in.line_acts, in.wait_s);
  const bool decelerates = in.stop_mode == 1 || in.stop_mode == 2;

  // The option's own error goes before the line's and does not end by itself.
  if (in.option_failed && phase_ != Phase::kOptionStops && phase_ != Phase::kRaised) {
    phase_ = Phase::kOptionStops;
    if (!decelerates) {
      phase_ = Phase::kRaised;
      return Alarm::kOption;
    }
  }
  switch (phase_) {
    case Phase::kOptionStops:
      if (in.running) return Alarm::kNone;
      phase_ = Phase::kRaised;
      return Alarm::kOption;
    case Phase::kRaised:
      // The alarm stays until a reset; without one in force the cause is judged anew.
      phase_ = Phase::kGood;
      return Alarm::kNone;
    case Phase::kGood:
      if (!recognised || in.stop_mode == 3) return Alarm::kNone;
      if (!decelerates) {
        phase_ = Phase::kRaised;
        return Alarm::kLine;
      }
      phase_ = Phase::kLineStops;
      break;
    case Phase::kLineStops: break;
  }
  // With 2 the drive goes on from where it is as soon as the line is back, and where the line no longer matters.
  if (in.stop_mode == 2) {
    if (!in.line_lost || !in.line_acts) {
      phase_ = Phase::kGood;
    } else {
      shown_ = !in.running;
    }
    return Alarm::kNone;
  }
  if (in.running) return Alarm::kNone;
  phase_ = Phase::kRaised;
  return Alarm::kLine;
}

}  // namespace vinv::inverter::a700
