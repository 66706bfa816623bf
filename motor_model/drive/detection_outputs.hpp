// Detection outputs: SU, FU, Y12, Y13 (E500 Pr.41-43, 150-153).
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class DetectionOutputs {
 public:
  struct Input {
    bool running = false;
    double ramp_frequency_hz = 0;    // signed
    double output_frequency_hz = 0;  // signed, compensated
    double set_frequency_hz = 0;     // signed, after limits and jumps
    double current_a_rms = 0;
  };

  void step(double dt_s, const DriveSettings& settings, const Input& input);
  bool up_to_frequency() const { return up_to_frequency_; }
  bool frequency_detected() const { return frequency_detected_; }
  bool current_detected() const { return current_detected_; }
  bool zero_current() const { return zero_current_; }

 private:
  OnDelay current_;
  OnDelay zero_;
  double current_hold_s_ = 0;
  bool up_to_frequency_ = false;
  bool frequency_detected_ = false;
  bool current_detected_ = false;
  bool zero_current_ = false;
  bool was_running_ = false;
  VINV_ARCHIVE(DetectionOutputs, current_, zero_, current_hold_s_, up_to_frequency_, frequency_detected_,
               current_detected_, zero_current_, was_running_);
};

}  // namespace vinv::drive
