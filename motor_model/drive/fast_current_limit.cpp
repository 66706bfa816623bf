#include "motor_model/drive/fast_current_limit.hpp"

#include <algorithm>

#include "motor_model/drive/protections.hpp"

namespace vinv::drive {
namespace {

constexpr double kBelowTrip = 0.85;  // of the over-current level
constexpr double kLookAhead_ticks = 2;
constexpr double kRecovery_s = 0.05;  // from no voltage to full voltage

}  // namespace

void FastCurrentLimit::clear() {
  factor_ = 1;
  last_peak_a_ = 0;
}

double FastCurrentLimit::level_a_peak(const DriveSettings& settings) {
  return settings.fast_current_limit ? kBelowTrip * over_current_level_a_peak(settings) : 0;
}

double FastCurrentLimit::step(double dt_s, const DriveSettings& settings, double current_peak_a,
                              double active_current_a_rms) {
  const double limit = level_a_peak(settings);
  if (limit <= 0) {
    clear();
    return 1;
  }
  // Ahead of the sample: the vector rises within a few ticks, and the limit must act before the comparator does.
  const double rise = std::max(current_peak_a - last_peak_a_, 0.0);
  const double expected = current_peak_a + kLookAhead_ticks * rise;
  last_peak_a_ = current_peak_a;
  if (expected > limit && active_current_a_rms >= 0) {
    factor_ *= limit / expected;
  } else {
    factor_ = std::min(1.0, factor_ + dt_s / kRecovery_s);
  }
  return factor_;
}

}  // namespace vinv::drive
