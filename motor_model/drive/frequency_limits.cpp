#include "motor_model/drive/frequency_limits.hpp"

#include <algorithm>

namespace vinv::drive {

double limited_reference_hz(const DriveSettings& settings, double set_frequency_hz) {
  double f = set_frequency_hz > 0 ? set_frequency_hz : 0;  // also for a reference that is not a number
  for (const FrequencyBand& band : settings.jump_bands) {
    if (f > band.low_hz && f < band.high_hz) f = band.jump_to_hz;
  }
  return std::max(0.0, std::min(std::max(f, settings.min_frequency_hz), settings.max_frequency_hz));
}

}  // namespace vinv::drive
