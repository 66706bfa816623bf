// DC link: capacitor, control supply and bleeder, brake resistor. Currents out of the link at voltage v.
#pragma once

#include "motor_model/plant/power_plant.hpp"

namespace vinv::plant {

struct DcLink {
  double inverse_capacitance = 0;  // 1/F; 0 holds the voltage, for traces with an ideal source
  double brake_conductance_s = 0;  // 0: no resistor fitted
  double standby_w = 0;            // at nominal voltage: control supply and bleeder together
  double nominal_v = 1;            // sqrt(2) * nominal mains
  double inverse_nominal_v2 = 1;

  DcLink() = default;
  DcLink(const DcLinkSettings& settings, double standby, double nominal)
      : inverse_capacitance(1 / settings.capacitance_f),
        brake_conductance_s(settings.brake_resistance_ohm > 0 ? 1 / settings.brake_resistance_ohm : 0),
        standby_w(standby),
        nominal_v(nominal),
        inverse_nominal_v2(1 / (nominal * nominal)) {}
};

// The control supply is a switching converter: constant power down to 40 % of nominal, stopped below 30 %. Balancing
// resistors take the rest of the charge, over minutes. Shares and levels: typical for the family.
inline constexpr double kBleederShare = 0.03;
inline constexpr double kSupplyStopsFraction = 0.3;
inline constexpr double kSupplyFullFraction = 0.4;

inline double standby_power(const DcLink& link, double v) {
  double supply = 1 - kBleederShare;
  const double x = (v / link.nominal_v - kSupplyStopsFraction) / (kSupplyFullFraction - kSupplyStopsFraction);
  if (x < 1) supply = x > 0 ? supply * x * x * (3 - 2 * x) : 0;
  return link.standby_w * (supply + kBleederShare * v * v * link.inverse_nominal_v2);
}

// A constant-power consumer turns into a resistor below a tenth of nominal: no consumer drains an empty capacitor.
inline double sustained_fraction(const DcLink& link, double v) {
  const double x2 = 100 * v * v * link.inverse_nominal_v2;
  return x2 < 1 ? x2 : 1;
}

}  // namespace vinv::plant
