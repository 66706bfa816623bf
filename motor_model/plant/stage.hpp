// Averaged inverter stage: the commanded voltage vector up to the linear range of the link, U <= Vdc / sqrt(3).
#pragma once

#include <numbers>

namespace vinv::plant {

inline constexpr double kStageLimit = std::numbers::inv_sqrt3;
inline constexpr double kDeadLinkV = 1.0;  // below it the stage gives out: keeps the link from going negative

// U / Vdc. The link current of the stage is 3/2 * modulation * i_sd.
inline double modulation(double commanded_peak_v, double v_dc) {
  if (v_dc < kDeadLinkV) return v_dc > 0 ? kStageLimit * v_dc / kDeadLinkV : 0;
  return commanded_peak_v < kStageLimit * v_dc ? commanded_peak_v / v_dc : kStageLimit;
}

}  // namespace vinv::plant
