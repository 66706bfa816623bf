#include "motor_model/plant/losses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/plant/machine_steady.hpp"

namespace vinv::plant {

double iron_loss_coefficient(const MachineParameters& machine, const LossSettings& losses, double frequency_hz) {
  const double rated_flux =
      phase_peak(machine.rated_voltage_v_rms) / (2 * std::numbers::pi * machine.rated_frequency_hz);
  const double x = std::abs(frequency_hz) / machine.rated_frequency_hz;
  return losses.iron_loss_w_at_rated * 0.5 * (x + x * x) / (rated_flux * rated_flux);
}

double inverter_loss_fraction(const LossSettings& losses, double carrier_hz) {
  const double switching = losses.inverter_switching_share * carrier_hz / kReferenceCarrier_hz;
  return losses.inverter_loss_fraction * (1 - losses.inverter_switching_share + switching);
}

LossSettings typical_losses(const MachineParameters& machine) {
  // Core, windage and stray loss of four-pole IEC motors: 8 % of rated power at 0.4 kW, 5 % at 2.2 kW, 3 % at 15 kW
  // (about a third of the loss that IE3 efficiencies leave). 70 % of it is taken as iron, the rest as friction, half
  // of that dry. Inverter: 2 to 4 % of the output; standby 20 to 40 W with size.
  const double power = machine.rated_power_w;
  const double constant_w = power * std::clamp(0.05 * std::pow(power / 2200, -0.3), 0.005, 0.15);
  const double omega_mech = machine.rated_speed_rpm * std::numbers::pi / 30;
  const double friction_nm = 0.3 * constant_w / omega_mech;
  LossSettings out;
  out.iron_loss_w_at_rated = 0.7 * constant_w;
  out.inverter_loss_fraction = 0.03;
  // A tenth at 1 kHz: 14.5 kHz take 2.35 times the loss, which is why carriers above 2 kHz cost rated current.
  out.inverter_switching_share = 0.1;
  out.standby_w = std::clamp(20 + 20 * std::log(power / 400) / std::log(15000.0 / 400), 20.0, 40.0);
  out.viscous_nm_s = 0.5 * friction_nm / omega_mech;
  out.coulomb_nm = 0.5 * friction_nm;
  return out;
}

}  // namespace vinv::plant
