#include "motor_model/drive/brake_sequence.hpp"

namespace vinv::drive {
namespace {

constexpr double kReached_hz = 0.01;

}  // namespace

void BrakeSequence::enter(Phase phase) {
  phase_ = phase;
  torque_.clear();
  settled_.clear();
  patience_.clear();
}

BrakeSequence::Decision BrakeSequence::step(double dt_s, const BrakeSequenceSettings& s, const Input& in) {
  if (phase_ == Phase::kClosed && in.start) enter(Phase::kTorque);
  switch (phase_) {
    case Phase::kClosed:
      // After a stop the brake must report that it is closed.
      if (s.completion && patience_.step(dt_s, in.open, kPatience_s)) return {.fault = Fault::kNotClosed};
      return {};
    case Phase::kTorque:
      if (!in.start) {
        enter(Phase::kClosed);
        return {};
      }
      if (torque_.step(dt_s, in.output_hz + kReached_hz >= s.open_hz && in.current_percent >= s.open_current_percent,
                       s.open_current_s)) {
        bof_ = true;
        enter(Phase::kOpening);
      } else if (patience_.step(dt_s, true, kPatience_s)) {
        return {.fault = Fault::kNotAsked};
      }
      return {.run = true, .most_hz = s.open_hz};
    case Phase::kOpening: {
      const bool open = !s.completion || in.open;
      if (patience_.step(dt_s, !open, kPatience_s)) return {.fault = Fault::kNotOpened};
      if (!settled_.step(dt_s, open, s.start_s)) return {.run = true, .most_hz = s.open_hz};
      enter(Phase::kOpen);
      return {.run = in.start};
    }
    case Phase::kOpen:
      if (s.completion && !in.open) return {.fault = Fault::kClosed};
      if (in.start) return {.run = true};
      if (in.output_hz > s.close_hz) return {};
      bof_ = false;
      enter(Phase::kClosing);
      [[fallthrough]];
    case Phase::kClosing: {
      const bool closed = !s.completion || !in.open;
      if (patience_.step(dt_s, !closed, kPatience_s)) return {.fault = Fault::kNotClosed};
      if (!settled_.step(dt_s, closed, s.stop_s)) return {.run = true, .most_hz = s.close_hz};
      enter(Phase::kClosed);
      return {};
    }
  }
  return {};
}

}  // namespace vinv::drive
