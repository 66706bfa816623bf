// Process control (E500 Pr.128-134): set point against measured value, both in percent; the output in percent is the
// personality's frequency source.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::drive {

enum class PidAction : std::uint8_t {
  kReverse,  // a measured value below the set point raises the output (heating, pressure); Pr.128 = 20
  kForward,  // ... lowers it (cooling); Pr.128 = 21
};
VINV_ENUM_RANGE(PidAction, kReverse, kForward);

struct PidSettings {
  PidAction action = PidAction::kReverse;
  double proportional_band_percent = 100;  // deviation that alone moves the output by 100 %; 0: no proportional part
  double integral_s = 1;                   // the integral repeats the proportional part in this time; 0: none
  double derivative_s = 0;                 // 0: none
  double output_min_percent = 0;
  double output_max_percent = 100;
  double upper_limit_percent = 1e9;   // of the measured value: FUP above it
  double lower_limit_percent = -1e9;  // FDN below it
};

class Pid {
 public:
  // One tick of control; returns the output in percent, within its limits.
  double step(double dt_s, const PidSettings& settings, double set_point_percent, double measured_percent);
  // While something else sets the output: takes over from there without a step when control begins.
  void track(double output_percent);
  void reset() { *this = Pid{}; }

  double output_percent() const { return output_; }
  double deviation_percent() const { return deviation_; }  // positive raises the output
  bool above_upper_limit() const { return fup_; }          // FUP
  bool below_lower_limit() const { return fdn_; }          // FDN

 private:
  double integral_ = 0;    // percent of output
  double derivative_ = 0;  // filtered rate of the measured value, percent/s
  double last_measured_ = 0;
  double output_ = 0;
  double deviation_ = 0;
  double last_gain_ = 0;
  double last_derivative_s_ = 0;
  PidAction last_action_ = PidAction::kReverse;
  bool started_ = false;
  bool tracking_ = false;
  bool fup_ = false;
  bool fdn_ = false;
  VINV_ARCHIVE(Pid, integral_, derivative_, last_measured_, output_, deviation_, last_gain_, last_derivative_s_,
               last_action_, started_, tracking_, fup_, fdn_);
};

}  // namespace vinv::drive
