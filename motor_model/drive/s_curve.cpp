#include "motor_model/drive/s_curve.hpp"

#include <cmath>
#include <numbers>

namespace vinv::drive {

double s_curve_a_time_s(double frequency_hz, double total_s, double base_hz) {
  const double x = frequency_hz / base_hz;
  if (x <= 0) return 0;
  if (x <= 0.125) return total_s * std::sqrt(x * 32.0 / 81.0);
  if (x <= 1) return total_s * (1.0 / 9.0 + x * 8.0 / 9.0);
  return total_s * (x * x * 4.0 / 9.0 + 5.0 / 9.0);
}

double s_curve_a_frequency_hz(double time_s, double total_s, double base_hz) {
  const double x = time_s / total_s;
  if (x <= 0) return 0;
  if (x <= 2.0 / 9.0) return base_hz * x * x * 81.0 / 32.0;
  if (x <= 1) return base_hz * (x - 1.0 / 9.0) * 9.0 / 8.0;
  return base_hz * std::sqrt((x - 5.0 / 9.0) * 9.0 / 4.0);
}

double s_curve_b_remaining(double progress) { return 0.5 * (1 + std::cos(std::numbers::pi * progress)); }

double s_curve_c_remaining(double progress, double share) {
  if (progress > 0.5) return 1 - s_curve_c_remaining(1 - progress, share);
  const double done = share > 0 && progress < share ? progress * progress / (2 * share) : progress - share / 2;
  return 1 - done / (1 - share);
}

SCurveD s_curve_d_of(double straight_s, double begin_s, double end_s) {
  const double rounded_s = (begin_s + end_s) / 2;
  if (straight_s <= 0 || rounded_s <= 0) return {straight_s, 0, 0};
  if (straight_s >= rounded_s) {
    const double total = straight_s + rounded_s;
    return {total, begin_s / total, end_s / total};
  }
  // The rate does not reach its full value: both ends shrink alike.
  const double scale = std::sqrt(straight_s / rounded_s);
  return {2 * rounded_s * scale, begin_s / (2 * rounded_s), end_s / (2 * rounded_s)};
}

double s_curve_d_remaining(double progress, const SCurveD& c) {
  const double most = 1 / (1 - (c.begin_share + c.end_share) / 2);  // rate between the ends
  const double x = progress < 0 ? 0 : progress > 1 ? 1 : progress;
  const double left = 1 - x;
  if (left < c.end_share) return most * left * left / (2 * c.end_share);
  if (x < c.begin_share) return 1 - most * x * x / (2 * c.begin_share);
  return 1 - most * (x - c.begin_share / 2);
}

}  // namespace vinv::drive
