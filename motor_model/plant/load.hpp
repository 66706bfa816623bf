// One-mass load with dry friction. Positive torque opposes forward rotation.
//
// Dry torque (friction, constant load, time table) opposes rotation with full strength and holds a standing shaft as
// long as the other torques stay below it. The shaft is therefore in one of four modes, changed only at roots of the
// integration: a sign function inside the right-hand side would chatter at standstill.
#pragma once

#include <cmath>
#include <cstdint>

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

enum class ShaftMode : std::uint8_t {
  kFree,     // no dry torque
  kForward,  // sliding
  kReverse,
  kHeld,  // standing, held by dry torque
};
VINV_ENUM_RANGE(ShaftMode, kFree, kHeld);

struct LoadModel {
  double inverse_inertia = 0;  // motor and load, 1/(kg m^2)
  double inertia = 0;
  double viscous_nm_s = 0;  // motor friction
  double coulomb_nm = 0;
  double constant_nm = 0;
  double linear_nm_s = 0;
  double quadratic_nm_s2 = 0;
  double hoist_nm = 0;
  // Time table, this segment: torque at t_ref and slope.
  double table_nm = 0;
  double table_nm_per_s = 0;
  double table_t_ref = 0;
  ShaftMode mode = ShaftMode::kFree;
  bool locked = false;  // by the user: speed does not change at all
};

struct ShaftTorques {
  double friction_nm = 0;
  double load_nm = 0;
};

inline double sliding_sign(ShaftMode mode) {
  return mode == ShaftMode::kForward ? 1.0 : mode == ShaftMode::kReverse ? -1.0 : 0.0;
}

// Dry torque of the driven machine at t (solver time); may be negative where the table drives the shaft.
inline double dry_load(const LoadModel& l, double t) {
  return l.constant_nm + l.table_nm + l.table_nm_per_s * (t - l.table_t_ref);
}

inline ShaftTorques shaft_torques(const LoadModel& l, double t, double omega_mech) {
  const double sign = sliding_sign(l.mode);
  return {l.viscous_nm_s * omega_mech + sign * l.coulomb_nm,
          (l.linear_nm_s + l.quadratic_nm_s2 * std::abs(omega_mech)) * omega_mech + l.hoist_nm + sign * dry_load(l, t)};
}

// What holds a standing shaft: a little more than the sliding torque, so that a shaft that breaks away accelerates in
// that direction; and never quite nothing, because breaking away is a root, which must rise from below zero.
inline constexpr double kBreakaway = 1.001;
inline constexpr double kLeastHoldingNm = 1e-6;
inline double holding_torque(const LoadModel& l, double t) {
  const double dry = kBreakaway * (l.coulomb_nm + dry_load(l, t));
  return dry > kLeastHoldingNm ? dry : kLeastHoldingNm;
}

// Copies settings; the mode follows from the speed.
void set_load(LoadModel& model, const LoadSettings& load, const LossSettings& losses, double motor_inertia_kg_m2);
ShaftMode mode_for(const LoadSettings& load, const LossSettings& losses, double omega_mech);
bool same_load(const LoadSettings& a, const LoadSettings& b);

// Torque of the table at a time since start, linear between points, held at the end, 0 before the first.
struct TableSegment {
  double torque_nm = 0;  // at time_s
  double slope_nm_per_s = 0;
  double end_s = 0;  // next point, infinity after the last
};
TableSegment table_segment(const LoadSettings& load, double time_s);

}  // namespace vinv::plant
