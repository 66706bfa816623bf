#include "motor_model/drive/detection_outputs.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

constexpr double kResolution_hz = 1e-6;

}  // namespace

void DetectionOutputs::step(double dt_s, const DriveSettings& settings, const Input& in) {
  // By the ramp, not by the compensated output: slip compensation must not end "up to frequency" at low speed.
  const double band_hz = std::abs(in.set_frequency_hz) * settings.up_to_frequency_percent / 100 + kResolution_hz;
  up_to_frequency_ = in.running && std::abs(in.ramp_frequency_hz - in.set_frequency_hz) <= band_hz;

  const double output = in.output_frequency_hz;
  frequency_detected_ = in.running && (output >= 0 ? output + kResolution_hz >= settings.detect_forward_hz
                                                   : -output + kResolution_hz >= settings.detect_reverse_hz);

  const double percent = settings.rated_current_a_rms > 0 ? in.current_a_rms / settings.rated_current_a_rms * 100 : 0;
  const bool held_to_the_next_start = settings.current_detect_hold_s < 0 && current_detected_;
  if (current_.step(dt_s, in.running && percent >= settings.current_detect_percent, settings.current_detect_s)) {
    current_hold_s_ = settings.current_detect_hold_s;
    current_detected_ = true;
  } else {
    current_hold_s_ = std::max(current_hold_s_ - dt_s, 0.0);
    const bool starts = in.running && !was_running_;
    current_detected_ = current_hold_s_ > 0 || (held_to_the_next_start && !starts);
  }
  was_running_ = in.running;
  // Unspecified: Y13 at standstill. On, because no current flows.
  zero_current_ = zero_.step(dt_s, percent <= settings.zero_current_percent, settings.zero_current_s);
}

}  // namespace vinv::drive
