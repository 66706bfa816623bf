#include "motor_model/plant/load.hpp"

#include <algorithm>
#include <limits>

namespace vinv::plant {

void set_load(LoadModel& model, const LoadSettings& load, const LossSettings& losses, double motor_inertia_kg_m2) {
  model.inertia = motor_inertia_kg_m2 + load.inertia_kg_m2;
  model.inverse_inertia = 1 / model.inertia;
  model.viscous_nm_s = losses.viscous_nm_s;
  model.coulomb_nm = losses.coulomb_nm;
  model.constant_nm = load.constant_nm;
  model.linear_nm_s = load.linear_nm_s;
  model.quadratic_nm_s2 = load.quadratic_nm_s2;
  model.hoist_nm = load.hoist_nm;
}

ShaftMode mode_for(const LoadSettings& load, const LossSettings& losses, double omega_mech) {
  if (losses.coulomb_nm == 0 && load.constant_nm == 0 && load.table.empty()) return ShaftMode::kFree;
  if (omega_mech > 0) return ShaftMode::kForward;
  return omega_mech < 0 ? ShaftMode::kReverse : ShaftMode::kHeld;
}

bool same_load(const LoadSettings& a, const LoadSettings& b) {
  const auto same_point = [](const LoadPoint& x, const LoadPoint& y) {
    return x.time_s == y.time_s && x.torque_nm == y.torque_nm;
  };
  return a.inertia_kg_m2 == b.inertia_kg_m2 && a.constant_nm == b.constant_nm && a.linear_nm_s == b.linear_nm_s &&
         a.quadratic_nm_s2 == b.quadratic_nm_s2 && a.hoist_nm == b.hoist_nm &&
         std::equal(a.table.begin(), a.table.end(), b.table.begin(), b.table.end(), same_point);
}

TableSegment table_segment(const LoadSettings& load, double time_s) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto& table = load.table;
  const auto next = std::upper_bound(table.begin(), table.end(), time_s,
                                     [](double t, const LoadPoint& point) { return t < point.time_s; });
  if (next == table.begin()) return {0, 0, next == table.end() ? kNever : next->time_s};
  const auto& from = *(next - 1);
  if (next == table.end()) return {from.torque_nm, 0, kNever};
  const double slope = (next->torque_nm - from.torque_nm) / (next->time_s - from.time_s);
  return {from.torque_nm + slope * (time_s - from.time_s), slope, next->time_s};
}

}  // namespace vinv::plant
