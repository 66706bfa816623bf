// How inputs enter the plant: which of them jump and restart the solver, and which merely change.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/plant/losses.hpp"
#include "motor_model/plant/machine_steady.hpp"
#include "motor_model/plant/plant_impl.hpp"

namespace vinv::plant {

namespace {

// A change of an input by more than this part of its rated value is a jump, which restarts the solver.
constexpr double kJumpOfRated = 0.01;
// Smaller changes of frequency and voltage are stairs of a ramp: they are joined by a line over one control tick, so
// that the solver sees a continuous input, and a ramp arrives at each tick's value at the end of that tick.
constexpr Duration kWay = std::chrono::milliseconds(1);

bool jumps(double from, double to, double rated) { return std::abs(to - from) > kJumpOfRated * rated; }

double load_torque(const LoadSettings& l, double omega) {
  const double sign = omega > 0 ? 1 : omega < 0 ? -1 : 0;
  return (l.linear_nm_s + l.quadratic_nm_s2 * std::abs(omega)) * omega + l.hoist_nm + sign * l.constant_nm;
}

bool same_table(const LoadSettings& a, const LoadSettings& b) {
  if (a.table.size() != b.table.size()) return false;
  for (std::size_t i = 0; i < a.table.size(); ++i) {
    if (a.table[i].time_s != b.table[i].time_s || a.table[i].torque_nm != b.table[i].torque_nm) return false;
  }
  return true;
}

}  // namespace

void PowerPlant::Impl::set_stage(const StageInput& next) {
  if (next == stage) return;
  if (!next.gates_on) switches.gates_latched = false;
  switches.gates_commanded = next.gates_on;
  const bool switched = stage_feeds() != model.gates_on;
  const bool chopper = next.chopper_enabled != stage.chopper_enabled || next.chopper_on_v != stage.chopper_on_v ||
                       next.chopper_off_v != stage.chopper_off_v;
  stage = next;
  take_stage_levels();
  stage_jumps = stage_jumps || switched;
  anew = anew || switched || chopper;
}

void PowerPlant::Impl::take_stage_levels() {
  // A table has no frequency: with it there is no iron loss.
  const double frequency_hz = source == MotorSource::kInverter ? stage.frequency_hz
                              : source == MotorSource::kMains  ? config.mains_frequency_hz
                                                               : 0;
  model.iron_w_per_wb2 = iron_loss_coefficient(config.machine, config.losses, frequency_hz);
  levels = switch_levels(config, stage);
}

void PowerPlant::Impl::apply_stage(Duration dt) {
  const double omega = 2 * std::numbers::pi * stage.frequency_hz;
  const double voltage = stage.voltage_peak_v > 0 ? stage.voltage_peak_v : 0;
  const auto& m = config.machine;
  const bool jump = stage_jumps || !model.gates_on ||
                    jumps(model.omega_k, omega, 2 * std::numbers::pi * m.rated_frequency_hz) ||
                    jumps(model.commanded_peak_v, voltage, phase_peak(m.rated_voltage_v_rms));
  stage_jumps = false;
  if (omega == model.omega_k && voltage == model.commanded_peak_v) return;
  if (jump) {
    if (model.gates_on) anew = true;
  } else {
    const Duration way = std::min(dt, kWay);
    way_end = time + way;
    model.omega_k_slope = (omega - model.omega_k) / to_seconds(way);
    model.commanded_peak_slope = (voltage - model.commanded_peak_v) / to_seconds(way);
    model.t_input = to_seconds(way_end - base);
  }
  model.omega_k = omega;
  model.commanded_peak_v = voltage;
}

void PowerPlant::Impl::end_stage_way() {
  model.omega_k_slope = model.commanded_peak_slope = 0;
  way_end = Duration::max();
}

void PowerPlant::Impl::set_mains(const MainsState& next) {
  const bool moved = jumps(config.mains.voltage_v_rms, next.voltage_v_rms, config.nominal_mains_v_rms) ||
                     config.mains.phase_present != next.phase_present;
  config.mains = next;
  anew = anew || moved;
  refresh_rectifier();
}

void PowerPlant::Impl::set_load(const LoadSettings& next) {
  if (same_load(next, config.load)) return;
  const double omega = y()[state::kOmegaMech];
  const auto& m = config.machine;
  const double rated_torque = m.rated_power_w / (m.rated_speed_rpm * std::numbers::pi / 30);
  const ShaftMode mode = mode_for(next, config.losses, omega);
  const bool moved = jumps(load_torque(config.load, omega), load_torque(next, omega), rated_torque) ||
                     next.inertia_kg_m2 != config.load.inertia_kg_m2 || !same_table(next, config.load) ||
                     mode != model.load.mode || mode == ShaftMode::kHeld;  // a held shaft may be let go
  config.load = next;
  plant::set_load(model.load, config.load, config.losses, m.inertia_kg_m2);
  model.load.mode = mode;
  enter_table_segment();
  anew = anew || moved;
}

void PowerPlant::Impl::set_shaft_locked(bool locked) {
  if (locked == model.load.locked) return;
  model.load.locked = locked;
  if (locked) {
    // Whatever blocks the shaft takes the energy of the moving mass.
    const double omega = y()[state::kOmegaMech];
    y()[state::kLoad] += 0.5 * model.load.inertia * omega * omega;
    y()[state::kOmegaMech] = 0;
  }
  model.load.mode = mode_for(config.load, config.losses, 0);
  anew = true;
}

void PowerPlant::Impl::set_ambient(double ambient) {
  config.ambient_c = ambient;
  model.thermal.ambient_c = ambient;  // against time constants of minutes: no jump
}

void PowerPlant::Impl::set_carrier(double carrier) {
  if (carrier == carrier_hz) return;
  carrier_hz = carrier;
  take_inverter_loss();
  anew = true;
}

void PowerPlant::Impl::set_cooling(double factor) {
  if (factor == cooling_factor) return;
  cooling_factor = factor;  // against a time constant of minutes: no jump
  take_inverter_loss();
}

void PowerPlant::Impl::take_inverter_loss() {
  model.inverter_loss_fraction = inverter_loss_fraction(config.losses, carrier_hz);
  model.thermal.set_cooling(config.thermal, cooling_factor);
}

// Called at a point of the table, or when the table is new: the torque line from time on.
void PowerPlant::Impl::enter_table_segment() {
  constexpr double kFarS = 1e9;
  const TableSegment segment = table_segment(config.load, to_seconds(time));
  model.load.table_nm = segment.torque_nm;
  model.load.table_nm_per_s = segment.slope_nm_per_s;
  model.load.table_t_ref = to_seconds(time - base);
  table_end = segment.end_s < kFarS ? seconds_to_duration(segment.end_s) : Duration::max();
  // A point that rounds to the present nanosecond is passed: no segment is empty.
  if (table_end <= time && table_end != Duration::max()) table_end = time + Duration{1};
}

}  // namespace vinv::plant
