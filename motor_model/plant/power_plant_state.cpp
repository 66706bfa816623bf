// Snapshots of the plant: states and held inputs; everything else is computed from them as it was at first.
#include <algorithm>
#include <cmath>

#include "motor_model/plant/plant_impl.hpp"

namespace vinv::plant {

namespace {

constexpr Duration kLongestRun = std::chrono::hours(24 * 365 * 100);

bool finite(const std::array<double, state::kStates>& y) {
  return std::all_of(y.begin(), y.end(), [](double x) { return std::isfinite(x); });
}

bool sensible(const LoadSettings& load) {
  double sum = load.inertia_kg_m2 + load.constant_nm + load.linear_nm_s + load.quadratic_nm_s2 + load.hoist_nm;
  for (const LoadPoint& point : load.table) sum += point.time_s + point.torque_nm;
  return std::isfinite(sum) && load.inertia_kg_m2 >= 0;
}

}  // namespace

// Items beyond the count are left over from earlier ticks.
void archive(Archive& a, PowerPlant::Events& events) {
  events.count = a.count(events.count, PowerPlant::kMaxEvents);
  for (std::size_t i = 0; i < events.items.size(); ++i) {
    if (i < events.count) {
      a.io(events.items[i]);
    } else if (a.loads()) {
      events.items[i] = {};
    }
  }
}

void PowerPlant::archive_state(Archive& a) {
  Impl& impl = *impl_;
  // All members are named, so that a new one is thought of here. Not archived: what the constructor makes (constants,
  // solver), what take_held_inputs() derives from the rest, what an advance() sets before it uses it (advance_start,
  // events), the solver's time, which starts at zero, and counts of work.
  VINV_MEMBERS(impl, config, stage, carrier_hz, cooling_factor, stage_jumps, source, source_since, line_v_rms, model,
               levels, switches, solver, constants, time, base, t, anew, table_end, way_end, voltage_end, advance_start,
               events, measurements, energy, reinitialisations);
  VINV_MEMBERS(config, motor, load, losses, dc_link, thermal_settings, comparators, mains, nominal_mains_v_rms,
               mains_frequency_hz, mains_phase_rad, voltage_table, ambient_c);
  VINV_MEMBERS(model, machine, load_model, link, rectifier, thermal, gates_on, on_line, line_peak_v, line_omega,
               chopper_on, omega_k, commanded_peak_v, omega_k_slope, commanded_peak_slope, t_input,
               inverter_loss_fraction, iron_w_per_wb2, over_current_squared, link_above_v, link_below_v);
  VINV_MEMBERS(load_model, inverse_inertia, inertia, viscous_nm_s, coulomb_nm, constant_nm, linear_nm_s,
               quadratic_nm_s2, hoist_nm, table_nm, table_nm_per_s, table_t_ref, shaft_mode, shaft_locked);

  a.must_match("motor", motor.name);
  a.must_match("motor, power circuit or solver", constants);
  std::array<double, state::kStates> y{};
  std::copy_n(impl.y(), y.size(), y.begin());
  VINV_FIELDS(a, PowerPlant, y, time, stage, stage_jumps, omega_k, commanded_peak_v, gates_on, on_line, source,
              source_since, line_v_rms, switches, carrier_hz, cooling_factor, mains, ambient_c, load, shaft_locked,
              shaft_mode, measurements, energy);
  if (!a.loads()) return;
  a.require(finite(y), "a state of the plant is not a number");
  a.require(sensible(load), "the load is not a number");
  a.require(time >= Duration{} && time < kLongestRun, "the time is out of range");
  a.require(source_since >= Duration{} && source_since <= time, "the motor was switched in the future");
  a.require(source != MotorSource::kTable || !voltage_table.empty(), "there is no voltage table");
  a.require(!(gates_on && on_line), "the motor hangs on two things");
  a.require(std::isfinite(carrier_hz + cooling_factor + mains.voltage_v_rms + ambient_c + omega_k + commanded_peak_v +
                          line_v_rms + stage.frequency_hz + stage.voltage_peak_v) &&
                carrier_hz > 0 && cooling_factor >= 1,
            "an input of the plant is out of range");
  if (a.failed()) return;
  std::copy(y.begin(), y.end(), impl.y());
  impl.take_held_inputs();
}

void PowerPlant::Impl::take_held_inputs() {
  base = time;
  t = 0;
  plant::set_load(model.load, config.load, config.losses, config.machine.inertia_kg_m2);
  enter_table_segment();
  model.thermal.ambient_c = config.ambient_c;
  take_inverter_loss();
  take_stage_levels();
  end_stage_way();
  model.t_input = 0;
  refresh_rectifier();
  model.chopper_on = switches.chopper_on;
  anew = true;
}

}  // namespace vinv::plant
