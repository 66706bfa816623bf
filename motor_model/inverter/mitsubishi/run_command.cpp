#include "motor_model/inverter/mitsubishi/run_command.hpp"

namespace vinv::inverter::mitsubishi {

using drive::RunDirection;

StopSelection stop_selection(double pr250) {
  if (pr250 == 9999) return {};
  if (pr250 == 8888) return {.str_is_direction = true};
  if (pr250 >= 1000) return {.str_is_direction = true, .coasting = true, .coast_delay_s = pr250 - 1000};
  return {.coasting = true, .coast_delay_s = pr250};
}

RunDirection StartLatch::step(const StartSignals& in, bool str_is_direction) {
  const bool stf_edge = in.stf && !last_stf_;
  const bool str_edge = in.str && !last_str_;
  last_stf_ = in.stf;
  last_str_ = in.str;
  if (!in.stop_hold || (in.stf && in.str && !str_is_direction)) {
    held_stf_ = held_str_ = false;
  } else if (str_is_direction) {
    held_stf_ = held_stf_ || in.stf;
  } else if (stf_edge || (in.stf && !in.str && !held_str_)) {
    held_stf_ = true;
    held_str_ = false;
  } else if (str_edge || (in.str && !in.stf && !held_stf_)) {
    held_str_ = true;
    held_stf_ = false;
  }
  if (str_is_direction) {
    if (!in.stf && !held_stf_) return RunDirection::kStop;
    return in.str ? RunDirection::kReverse : RunDirection::kForward;
  }
  if (in.stf && in.str) return RunDirection::kStop;
  const bool forward = in.stf || held_stf_;
  const bool reverse = in.str || held_str_;
  if (forward == reverse) return RunDirection::kStop;
  return forward ? RunDirection::kForward : RunDirection::kReverse;
}

RunDirection permitted(RunDirection wanted, int raw_pr78) {
  if (raw_pr78 == 1 && wanted == RunDirection::kReverse) return RunDirection::kStop;
  if (raw_pr78 == 2 && wanted == RunDirection::kForward) return RunDirection::kStop;
  return wanted;
}

}  // namespace vinv::inverter::mitsubishi
