#include "motor_model/drive/power_failure.hpp"

namespace vinv::drive {

void LinkSupervision::observe(const DriveSettings& settings, const Sensors& sensors) {
  if (!sensors.control_power || sensors.under_voltage || sensors.dc_link_v < settings.under_voltage_v) low_ = true;
  const double clear_v = std::max(settings.under_voltage_clear_v, settings.under_voltage_v);
  if (sensors.control_power && sensors.dc_link_v >= clear_v) low_ = false;
}

void PowerFailure::begin() {
  end();
  phase_ = Phase::kDip;
}

void PowerFailure::end() { *this = PowerFailure{}; }

PowerFailure::Verdict PowerFailure::step(double dt_s, const DriveSettings& settings, bool link_low, bool start_on) {
  if (!start_on) stop_seen_ = true;
  if (phase_ == Phase::kDip) {
    if (!link_low) {
      end();
      return Verdict::kResume;
    }
    if (dip_.step(dt_s, true, settings.power_failure_detect_s)) phase_ = Phase::kFailed;
    return Verdict::kOff;
  }
  if (phase_ == Phase::kNone) return Verdict::kStopped;

  if (link_low) {
    waited_.clear();
    return Verdict::kOff;
  }
  const bool over = settings.restart_enabled ? !start_on : stop_seen_;
  if (over) {
    end();
    return Verdict::kStopped;
  }
  if (!settings.restart_enabled || !waited_.step(dt_s, true, settings.restart_coast_s)) return Verdict::kOff;
  end();
  return Verdict::kRestart;
}

}  // namespace vinv::drive
