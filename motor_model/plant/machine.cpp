#include "motor_model/plant/machine.hpp"

namespace vinv::plant {

MachineModel::MachineModel(const MachineParameters& machine)
    : R_s(machine.R_s_ohm),
      R_r(machine.R_r_ohm),
      L_s(machine.L_ls_h + machine.L_m_h),
      L_r(machine.L_lr_h + machine.L_m_h),
      L_m(machine.L_m_h),
      pole_pairs(machine.pole_pairs) {
  // L_s L_r - L_m^2 written without the difference of two large numbers.
  const double determinant = machine.L_ls_h * machine.L_lr_h + machine.L_m_h * (machine.L_ls_h + machine.L_lr_h);
  L_sigma = determinant / L_r;
  gamma_s = L_r / determinant;
  gamma_r = L_s / determinant;
  gamma_m = L_m / determinant;
}

}  // namespace vinv::plant
