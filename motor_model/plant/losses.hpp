// Iron loss over frequency and flux: half hysteresis (linear in frequency), half eddy currents (square), both with
// the square of the stator flux. Reference: LossSettings::iron_loss_w_at_rated at rated voltage and frequency.
#pragma once

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

// W per Wb^2 of |psi_s|^2 at this frequency (either sign).
double iron_loss_coefficient(const MachineParameters& machine, const LossSettings& losses, double frequency_hz);

// Of the apparent output power, at this carrier.
double inverter_loss_fraction(const LossSettings& losses, double carrier_hz);

}  // namespace vinv::plant
