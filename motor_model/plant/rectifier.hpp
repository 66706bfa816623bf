// Diode rectifier behind the source resistance, averaged over a mains period; it cannot feed back.
//
// Three phases: an ideal source of sqrt(2) times the line voltage behind R. Two phases left: a single-phase bridge on
// the remaining line voltage, averaged over its half wave while the link voltage stands still,
//   i = 1/pi * integral of max(0, V_p sin(theta) - v) / R,
// so the loaded link falls well below the peak; the 100 Hz ripple itself is not simulated, only estimated
// (PlantMeasurements::dc_link_ripple_v). One phase or none: no current.
#pragma once

#include <cmath>
#include <numbers>

namespace vinv::plant {

struct Rectifier {
  double v_peak = 0;         // V, sqrt(2) * line voltage
  double conductance_s = 0;  // 1 / (source + pre-charge resistance)
  bool single_phase = false;
  bool live = false;  // at least two phases
};

struct RectifierFlow {
  double current_a = 0;  // into the link
  double mains_w = 0;
};

inline RectifierFlow single_phase_flow(const Rectifier& r, double v) {
  const double k = v / r.v_peak;
  if (k >= 1) return {};
  const double sine = k > -1 ? k : -1;
  const double cosine = std::sqrt(1 - sine * sine);
  const double half_conduction = std::numbers::pi / 2 - std::asin(sine);
  const double scale = r.conductance_s * r.v_peak / std::numbers::pi;
  return {2 * scale * (cosine - k * half_conduction),
          scale * r.v_peak * (half_conduction + sine * cosine - 2 * k * cosine)};
}

inline RectifierFlow rectifier_flow(const Rectifier& r, double v) {
  if (!r.live) return {};
  if (r.single_phase) return single_phase_flow(r, v);
  const double current = v < r.v_peak ? (r.v_peak - v) * r.conductance_s : 0.0;
  return {current, r.v_peak * current};
}

}  // namespace vinv::plant
