// Instantaneous power failure (E500 Pr.57, 58), judged by the DC link: the output goes off without an alarm, and the
// drive restarts the coasting motor by itself or waits for a new start edge.
#pragma once

#include <algorithm>

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

// Whether the DC link can feed the output: low below the under-voltage level, good again above the clear level.
class LinkSupervision {
 public:
  void observe(const DriveSettings& settings, const Sensors& sensors);
  bool low() const { return low_; }

 private:
  bool low_ = true;  // until it has been charged
  VINV_ARCHIVE(LinkSupervision, low_);
};

class PowerFailure {
 public:
  enum class Verdict : std::uint8_t {
    kOff,      // output stays off
    kResume,   // the dip was too short to matter: go on as before
    kRestart,  // catch the coasting motor
    kStopped,  // over; a start is a new start
  };

  // The link fell while the output was on.
  void begin();
  // One tick with the output off. start_on: a direction is commanded.
  Verdict step(double dt_s, const DriveSettings& settings, bool link_low, bool start_on);
  void end();

  bool failed() const { return phase_ == Phase::kFailed; }  // IPF
  bool waiting() const { return phase_ == Phase::kFailed && waited_.held_s() > 0; }

 private:
  enum class Phase : std::uint8_t { kNone, kDip, kFailed };
  friend VINV_ENUM_RANGE(Phase, kNone, kFailed);
  Phase phase_ = Phase::kNone;
  bool stop_seen_ = false;
  OnDelay dip_;
  OnDelay waited_;
  VINV_ARCHIVE(PowerFailure, phase_, stop_seen_, dip_, waited_);
};

// Voltage factor after a restart: from nothing to full over the cushion time, by way of a point in between.
class RestartCushion {
 public:
  void begin() {
    factor_ = 0;
    elapsed_s_ = 0;
  }
  void end() { factor_ = 1; }
  bool rising() const { return factor_ < 1; }
  double step(double dt_s, const DriveSettings& s) {
    const double first_s = s.restart_first_cushion_s;
    const double first = s.restart_first_voltage_percent / 100;
    elapsed_s_ += dt_s;
    if (elapsed_s_ <= first_s) {
      factor_ = first * elapsed_s_ / first_s;
      return factor_;
    }
    const double left_s = s.restart_cushion_s - first_s;
    factor_ = left_s > dt_s ? std::min(1.0, std::max(factor_, first) + dt_s * (1 - first) / left_s) : 1.0;
    return factor_;
  }

 private:
  double factor_ = 1;
  double elapsed_s_ = 0;
  VINV_ARCHIVE(RestartCushion, factor_, elapsed_s_);
};

}  // namespace vinv::drive
