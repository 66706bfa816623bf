// Refusals of machine, load and plant settings: the first thing that is wrong, as a sentence for a person.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "motor_model/plant/machine_steady.hpp"

namespace vinv::plant {

namespace {

using Refusal = std::optional<std::string>;

Refusal check_range(std::string_view what, double value, double low, double high, std::string_view unit) {
  if (std::isfinite(value) && value >= low && value <= high) return std::nullopt;
  return fmt::format("{} is {} {}; it must be between {} and {} {}", what, value, unit, low, high, unit);
}

Refusal first(std::initializer_list<Refusal> refusals) {
  for (const auto& refusal : refusals) {
    if (refusal) return refusal;
  }
  return std::nullopt;
}

Result<void, std::string> outcome(Refusal refusal) {
  if (refusal) return Unexpected(*std::move(refusal));
  return {};
}

Refusal check_machine_ranges(const MachineParameters& m) {
  const auto pairs = m.pole_pairs;
  if (pairs < 1 || pairs > 24) return fmt::format("pole_pairs is {}; it must be between 1 and 24", pairs);
  return first({
      check_range("R_s_ohm", m.R_s_ohm, 1e-5, 1000, "ohm"),
      check_range("R_r_ohm", m.R_r_ohm, 1e-5, 1000, "ohm"),
      check_range("L_ls_h", m.L_ls_h, 1e-6, 10, "H"),
      check_range("L_lr_h", m.L_lr_h, 1e-6, 10, "H"),
      check_range("L_m_h", m.L_m_h, 1e-5, 100, "H"),
      check_range("inertia_kg_m2", m.inertia_kg_m2, 1e-6, 1e5, "kg m2"),
      check_range("rated_power_w", m.rated_power_w, 1, 1e7, "W"),
      check_range("rated_voltage_v_rms", m.rated_voltage_v_rms, 10, 15000, "V"),
      check_range("rated_frequency_hz", m.rated_frequency_hz, 1, 1000, "Hz"),
      check_range("rated_current_a_rms", m.rated_current_a_rms, 0.01, 1e5, "A"),
      check_range("rated_speed_rpm", m.rated_speed_rpm, 1, 60000, "rpm"),
  });
}

// The parts fit each other: values that are each possible, but not of one machine.
Refusal check_machine_fits(const MachineParameters& m) {
  if (m.L_ls_h >= 0.5 * m.L_m_h || m.L_lr_h >= 0.5 * m.L_m_h) {
    return fmt::format(
        "leakage L_ls_h {} H, L_lr_h {} H must each be below half of the magnetising inductance L_m_h {} H", m.L_ls_h,
        m.L_lr_h, m.L_m_h);
  }
  const double synchronous_rpm = 60 * m.rated_frequency_hz / m.pole_pairs;
  if (m.rated_speed_rpm >= synchronous_rpm || m.rated_speed_rpm < 0.7 * synchronous_rpm) {
    return fmt::format(
        "rated_speed_rpm is {} rpm; with {} pole pairs at {} Hz it must be between {} and just below {} rpm",
        m.rated_speed_rpm, m.pole_pairs, m.rated_frequency_hz, 0.7 * synchronous_rpm, synchronous_rpm);
  }
  // Some published machines are rated by base values, a little above what their current can carry.
  const double apparent_w = 1.1 * std::numbers::sqrt3 * m.rated_voltage_v_rms * m.rated_current_a_rms;
  if (m.rated_power_w >= apparent_w) {
    return fmt::format(
        "rated_power_w is {} W; it must be below {:.0f} W, 1.1 times what {} A at {} V amount to (per-phase delta "
        "values must be converted to star)",
        m.rated_power_w, apparent_w, m.rated_current_a_rms, m.rated_voltage_v_rms);
  }
  const MachineModel model(m);
  const double omega = 2 * std::numbers::pi * m.rated_frequency_hz;
  const double voltage = phase_peak(m.rated_voltage_v_rms);
  const double no_load_a = steady_point(model, voltage, omega, 0).current_a_rms;
  if (no_load_a >= m.rated_current_a_rms) {
    return fmt::format(
        "no-load current is {:.3g} A at rated voltage and frequency; it must be below rated_current_a_rms {} A: L_m_h "
        "{} H is too small or rated_voltage_v_rms {} V too high (delta values?)",
        no_load_a, m.rated_current_a_rms, m.L_m_h, m.rated_voltage_v_rms);
  }
  const double rated_torque = m.rated_power_w / (m.rated_speed_rpm * std::numbers::pi / 30);
  const double breakdown = steady_point(model, voltage, omega, breakdown_slips(model, omega).motoring).torque_nm;
  if (breakdown <= 1.1 * rated_torque) {
    return fmt::format(
        "breakdown torque of the equivalent circuit is {:.3g} Nm; it must be above 1.1 times the rated torque {:.3g} "
        "Nm: resistances or leakages are too large for {} W",
        breakdown, rated_torque, m.rated_power_w);
  }
  return std::nullopt;
}

Refusal check_load(const LoadSettings& l) {
  auto refusal = first({
      check_range("load inertia_kg_m2", l.inertia_kg_m2, 0, 1e6, "kg m2"),
      check_range("load constant_nm (use hoist_nm for a torque with a direction)", l.constant_nm, 0, 1e7, "Nm"),
      check_range("load linear_nm_s", l.linear_nm_s, 0, 1e6, "Nm s"),
      check_range("load quadratic_nm_s2", l.quadratic_nm_s2, 0, 1e6, "Nm s2"),
      check_range("load hoist_nm", l.hoist_nm, -1e7, 1e7, "Nm"),
  });
  if (refusal) return refusal;
  for (std::size_t n = 0; n < l.table.size(); ++n) {
    const auto& point = l.table[n];
    const double earliest = n > 0 ? l.table[n - 1].time_s : 0;
    if (auto bad = first(
            {check_range(fmt::format("load table point {}: time_s", n + 1), point.time_s, earliest, 1e9, "s"),
             check_range(fmt::format("load table point {}: torque_nm", n + 1), point.torque_nm, -1e7, 1e7, "Nm")})) {
      return bad;
    }
    if (n >= 2 && l.table[n - 2].time_s == point.time_s) {
      return fmt::format("load table points {} to {} are all at {} s; a step takes two points, not more", n - 1, n + 1,
                         point.time_s);
    }
  }
  return std::nullopt;
}

Refusal check_losses(const PlantConfig& c) {
  const auto& l = c.losses;
  const double power = c.machine.rated_power_w;
  const double torque = power / (c.machine.rated_speed_rpm * std::numbers::pi / 30);
  const double omega = c.machine.rated_speed_rpm * std::numbers::pi / 30;
  return first({
      check_range("iron_loss_w_at_rated", l.iron_loss_w_at_rated, 0, 0.5 * power, "W"),
      check_range("inverter_loss_fraction", l.inverter_loss_fraction, 0, 0.5, ""),
      check_range("inverter_switching_share", l.inverter_switching_share, 0, 1, ""),
      check_range("standby_w", l.standby_w, 0, std::max(100.0, 0.5 * power), "W"),
      check_range("viscous_nm_s", l.viscous_nm_s, 0, torque / omega, "Nm s"),
      check_range("coulomb_nm", l.coulomb_nm, 0, torque, "Nm"),
  });
}

Refusal check_dc_link(const DcLinkSettings& d) {
  if (auto bad = first({
          check_range("capacitance_f", d.capacitance_f, 1e-6, 10, "F"),
          check_range("source_resistance_ohm", d.source_resistance_ohm, 1e-3, 1000, "ohm"),
          check_range("precharge_resistance_ohm", d.precharge_resistance_ohm, 0, 1e5, "ohm"),
          check_range("bypass_closes_fraction", d.bypass_closes_fraction, 0.1, 0.98, ""),
          check_range("bypass_opens_fraction", d.bypass_opens_fraction, 0, 0.97, ""),
      })) {
    return bad;
  }
  if (d.bypass_opens_fraction >= d.bypass_closes_fraction) {
    return fmt::format("bypass_opens_fraction is {}; it must be below bypass_closes_fraction {}",
                       d.bypass_opens_fraction, d.bypass_closes_fraction);
  }
  return d.brake_resistance_ohm == 0
             ? std::nullopt
             : check_range("brake_resistance_ohm (0 for none)", d.brake_resistance_ohm, 0.1, 1e5, "ohm");
}

Refusal check_surroundings(const PlantConfig& c) {
  const auto& k = c.comparators;
  if (auto bad = first({
          check_range("heat_sink_k_per_w", c.thermal.heat_sink_k_per_w, 0, 100, "K/W"),
          check_range("heat_sink_time_constant_s", c.thermal.heat_sink_time_constant_s, 1, 1e5, "s"),
          check_range("winding_rise_k_at_rated", c.thermal.winding_rise_k_at_rated, 0, 500, "K"),
          check_range("winding_time_constant_s", c.thermal.winding_time_constant_s, 1, 1e5, "s"),
          check_range("over_current_a_peak (0 for off)", k.over_current_a_peak, 0, 1e6, "A"),
          check_range("over_voltage_v (0 for off)", k.over_voltage_v, 0, 1e5, "V"),
          check_range("under_voltage_v (0 for off)", k.under_voltage_v, 0, 1e5, "V"),
          check_range("under_voltage_clear_v", k.under_voltage_clear_v, 0, 1e5, "V"),
          check_range("nominal_mains_v_rms", c.nominal_mains_v_rms, 10, 15000, "V"),
          check_range("mains voltage_v_rms", c.mains.voltage_v_rms, 0, 2 * c.nominal_mains_v_rms, "V"),
          check_range("mains_frequency_hz", c.mains_frequency_hz, 1, 1000, "Hz"),
          check_range("mains_phase_rad", c.mains_phase_rad, -7, 7, "rad"),
          check_range("ambient_c", c.ambient_c, -60, 120, "degC"),
      })) {
    return bad;
  }
  if (k.under_voltage_v > 0 && k.over_voltage_v > 0 &&
      (k.under_voltage_clear_v >= k.over_voltage_v || k.under_voltage_v >= k.over_voltage_v)) {
    return fmt::format("under_voltage_v {} V and under_voltage_clear_v {} V must be below over_voltage_v {} V",
                       k.under_voltage_v, k.under_voltage_clear_v, k.over_voltage_v);
  }
  return std::nullopt;
}

Refusal check_voltage_table(const std::vector<VoltagePoint>& table) {
  for (std::size_t n = 0; n < table.size(); ++n) {
    const auto& point = table[n];
    const auto name = [n](const char* what) { return fmt::format("voltage table point {}: {}", n + 1, what); };
    if (n == 0 && point.time_s != 0)
      return fmt::format("{} is {} s; the first point must be at 0 s", name("time_s"), point.time_s);
    if (n > 0 && !(point.time_s > table[n - 1].time_s)) {
      return fmt::format("{} is {} s; it must be later than the point before", name("time_s"), point.time_s);
    }
    if (auto bad = first({check_range(name("time_s"), point.time_s, 0, 1e6, "s"),
                          check_range(name("alpha_v"), point.alpha_v, -1e5, 1e5, "V"),
                          check_range(name("beta_v"), point.beta_v, -1e5, 1e5, "V")})) {
      return bad;
    }
  }
  return std::nullopt;
}

}  // namespace

Result<void, std::string> validate(const MachineParameters& machine) {
  if (auto bad = check_machine_ranges(machine)) return outcome(bad);
  return outcome(check_machine_fits(machine));
}

Result<void, std::string> validate(const LoadSettings& load) { return outcome(check_load(load)); }

Result<void, std::string> validate(const std::vector<VoltagePoint>& table) {
  return outcome(check_voltage_table(table));
}

Result<void, std::string> validate(const PlantConfig& config) {
  if (auto machine = validate(config.machine); !machine) return machine;
  for (const auto& refusal : {check_load(config.load), check_losses(config), check_dc_link(config.dc_link),
                              check_surroundings(config), check_voltage_table(config.voltage_table)}) {
    if (refusal) return outcome(refusal);
  }
  return {};
}

}  // namespace vinv::plant
