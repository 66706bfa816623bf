#include "motor_model/plant/power_plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/plant/losses.hpp"
#include "motor_model/plant/plant_impl.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

constexpr double kRpmPerRadS = 30 / std::numbers::pi;
constexpr double kLineRmsOfPeak = std::numbers::sqrt3 / std::numbers::sqrt2;
constexpr double kTableStepNm = 1e-6;  // below it a point of the load table is a kink, not a step

// Peak to peak: the capacitor alone carries the current between two pulses, but never below what the bridge delivers.
double ripple_estimate(const Rectifier& r, const DcLink& link, double mains_frequency_hz, double link_current_a) {
  if (!r.live || link_current_a <= 0) return 0;
  const double pulses_per_s = (r.single_phase ? 2 : 6) * mains_frequency_hz;
  const double bound = r.single_phase ? r.v_peak : r.v_peak * (1 - std::numbers::sqrt3 / 2);
  return std::min(bound, link_current_a * link.inverse_capacitance / pulses_per_s);
}

// Peak of what the decaying, turning rotor flux induces in an open stator.
double residual_voltage(const PlantModel& m, const double* y) {
  const double flux = std::hypot(y[state::kPsiSd], y[state::kPsiSq]);
  return flux * std::hypot(m.machine.R_r / m.machine.L_r, m.machine.pole_pairs * y[state::kOmegaMech]);
}

Rectifier make_rectifier(const MainsState& mains, double resistance_ohm) {
  const auto phases = std::count(mains.phase_present.begin(), mains.phase_present.end(), true);
  Rectifier r;
  r.v_peak = std::numbers::sqrt2 * mains.voltage_v_rms;
  r.conductance_s = 1 / resistance_ohm;
  r.single_phase = phases == 2;
  r.live = phases >= 2 && mains.voltage_v_rms > 0;
  return r;
}

std::uint64_t constants_of(const PlantConfig& config, SolverSettings solver) {
  PlantConfig c = config;
  Bytes bytes;
  Archive a = Archive::saving(bytes);
  VINV_FIELDS(a, Constants, c.machine, c.losses, c.dc_link, c.thermal, c.comparators, c.nominal_mains_v_rms,
              c.mains_frequency_hz, c.mains_phase_rad, c.voltage_table, solver);
  return snapshot_checksum(bytes);
}

}  // namespace

PowerPlant::Impl::Impl(PlantConfig config_in, SolverSettings solver_settings)
    : config(std::move(config_in)), constants(constants_of(config, solver_settings)) {
  VINV_CHECK(validate(config).has_value());
  const double nominal = std::numbers::sqrt2 * config.nominal_mains_v_rms;
  model.machine = MachineModel(config.machine);
  plant::set_load(model.load, config.load, config.losses, config.machine.inertia_kg_m2);
  model.load.mode = mode_for(config.load, config.losses, 0);
  model.link = DcLink(config.dc_link, config.losses.standby_w, nominal);
  model.thermal = Thermal(config.thermal, config.machine, config.ambient_c);
  take_inverter_loss();
  take_stage_levels();
  line_v_rms = config.mains.voltage_v_rms;
  solver = make_solver(ode_system(model), solver_settings);
  std::fill_n(y(), state::kStates, 0.0);
  y()[state::kHeatSink] = y()[state::kWinding] = config.ambient_c;
  enter_table_segment();
  refresh_model();
  measure();
}

void PowerPlant::Impl::refresh_rectifier() {
  const double pre_charge = switches.bypassed ? 0 : config.dc_link.precharge_resistance_ohm;
  model.rectifier = make_rectifier(config.mains, config.dc_link.source_resistance_ohm + pre_charge);
}

void PowerPlant::Impl::refresh_model() {
  refresh_rectifier();
  model.chopper_on = switches.chopper_on;
  if (model.fed() && !stage_feeds() && !line_feeds()) interrupt_stator();
  model.gates_on = stage_feeds();
  refresh_line();
  const double limit = config.comparators.over_current_a_peak;
  model.over_current_squared = limit * limit;
  const QuietBand band = quiet_band(switches, levels);
  model.link_above_v = band.above_v;
  model.link_below_v = band.below_v;
}

void PowerPlant::Impl::report(PlantEventKind kind, double value) {
  if (events.count == kMaxEvents) return;
  const Duration after = base + seconds_to_duration(t) - advance_start;
  events.items[events.count++] = {kind, std::max(after, Duration{}), value};
}

void PowerPlant::Impl::settle_link(double v) {
  const SwitchActions actions = settle(switches, levels, v);
  if (actions.over_voltage) report(PlantEventKind::kOverVoltage, v);
  if (actions.under_voltage) report(PlantEventKind::kUnderVoltage, v);
}

// A shaft without rotation stands if dry torque holds it, else breaks away in the direction of the net torque.
void PowerPlant::Impl::settle_shaft() {
  if (model.load.mode != ShaftMode::kHeld || model.load.locked) return;
  const double net = net_torque_at_rest(model, y());
  if (std::abs(net) > holding_torque(model.load, t)) {
    model.load.mode = net > 0 ? ShaftMode::kForward : ShaftMode::kReverse;
  }
}

void PowerPlant::Impl::rebase() {
  // Without a way to go the number says nothing; zero is what it is after a load.
  model.t_input = way_end == Duration::max() ? 0 : model.t_input - to_seconds(time - base);
  base = time;
  t = 0;
  enter_table_segment();  // computed anew rather than shifted: the same numbers as after a restore
}

void PowerPlant::Impl::begin_anew() {
  if (base != time) rebase();
  settle_link(y()[state::kDcLink]);
  refresh_model();
  if (current_too_high()) shut_for_over_current();
  settle_shaft();
  restart_solver(0);
  anew = false;
}

bool PowerPlant::Impl::current_too_high() const {
  if (!model.gates_on || model.over_current_squared <= 0) return false;
  const CurrentPair i = currents(model.machine, flux_of(y()));
  return i.i_sd * i.i_sd + i.i_sq * i.i_sq >= model.over_current_squared;
}

void PowerPlant::Impl::shut_for_over_current() {
  const CurrentPair i = currents(model.machine, flux_of(y()));
  report(PlantEventKind::kOverCurrent, std::hypot(i.i_sd, i.i_sq));
  switches.gates_latched = true;
  refresh_model();
}

void PowerPlant::Impl::restart_solver(double at) {
  solver->restart(at);
  ++reinitialisations;
}

void PowerPlant::Impl::on_roots(std::uint32_t roots) {
  const auto acts = [roots](std::size_t i) { return (roots >> i & 1u) != 0; };
  if (acts(root::kOverCurrent)) shut_for_over_current();
  // The root lies within rounding of the level, on either side: the comparator saw it reached.
  double v = y()[state::kDcLink];
  if (acts(root::kLinkAbove)) v = std::max(v, model.link_above_v);
  if (acts(root::kLinkBelow)) v = std::min(v, model.link_below_v);
  settle_link(v);
  refresh_model();
  if (acts(root::kShaft)) {
    if (model.load.mode == ShaftMode::kHeld) {
      const double net = net_torque_at_rest(model, y());
      model.load.mode = net > 0 ? ShaftMode::kForward : ShaftMode::kReverse;
    } else {
      y()[state::kOmegaMech] = 0;
      model.load.mode = ShaftMode::kHeld;
    }
  }
  settle_shaft();
  restart_solver(t);
}

void PowerPlant::Impl::integrate_to(Duration end) {
  const double t_end = to_seconds(end - base);
  bool retried = false;
  while (t_end - t > kShortestAdvance) {
    const SolverStop stop = solver->advance(t_end);
    t = stop.t;
    if (stop.failed) {
      if (retried) throw SolverFailure("plant at " + std::to_string(to_seconds(base) + t) + " s: " + solver->error());
      retried = true;
      restart_solver(t);
      continue;
    }
    retried = false;
    if (stop.roots != 0) on_roots(stop.roots);
  }
  time = end;
}

PowerPlant::Events PowerPlant::Impl::advance(Duration dt) {
  events.count = 0;
  advance_start = time;
  if (dt <= Duration::zero()) return events;
  if (anew) rebase();
  apply_stage(dt);  // may find a jump
  if (anew) begin_anew();
  const Duration end = time + dt;
  while (time < end) {
    integrate_to(std::min({end, table_end, way_end, voltage_end}));
    if (time == way_end) end_stage_way();
    if (time == voltage_end) begin_anew();
    if (time == table_end) {
      const double before = dry_load(model.load, to_seconds(time - base));
      enter_table_segment();
      const double after = dry_load(model.load, to_seconds(time - base));
      if (std::abs(after - before) > kTableStepNm) begin_anew();
    }
  }
  measure();
  return events;
}

void PowerPlant::Impl::measure() {
  const double* s = y();
  const Flows f = flows(model, t, s);
  const double omega = s[state::kOmegaMech];
  auto& out = measurements;
  const double motor_current_peak_a = std::sqrt(f.current_squared);
  const bool by_inverter = model.gates_on;
  out.current_peak_a = by_inverter ? motor_current_peak_a : 0;
  out.output_current_a_rms = out.current_peak_a / std::numbers::sqrt2;
  out.active_current_a_rms = by_inverter ? f.i.i_sd / std::numbers::sqrt2 : 0;
  out.motor_current_a_rms = motor_current_peak_a / std::numbers::sqrt2;
  const double stage_peak_v = by_inverter ? f.stator_peak_v
                              : switches.gates_on()
                                  ? modulation(model.commanded_peak_v, s[state::kDcLink]) * s[state::kDcLink]
                                  : 0;
  const double motor_peak_v = model.fed() ? f.stator_peak_v : residual_voltage(model, s);
  out.output_voltage_v_rms = stage_peak_v * kLineRmsOfPeak;
  out.motor_voltage_v_rms = motor_peak_v * kLineRmsOfPeak;
  out.dc_link_v = std::max(0.0, s[state::kDcLink]);  // an empty capacitor is zero within tolerance
  out.speed_rpm = omega * kRpmPerRadS;
  out.torque_nm = f.torque_nm;
  out.load_torque_nm = f.shaft.load_nm;
  if (!model.load.locked && model.load.mode == ShaftMode::kHeld) {
    // The part of the reaction that the driven machine takes.
    const double of_load = std::max(0.0, dry_load(model.load, t));
    const double share = of_load > 0 ? of_load / (of_load + model.load.coulomb_nm) : 0;
    out.load_torque_nm = model.load.hoist_nm + share * (f.torque_nm - model.load.hoist_nm);
  }
  out.shaft_power_w = (f.torque_nm - f.shaft.friction_nm) * omega;
  out.input_power_w = f.rectifier.mains_w + f.line_w;
  out.output_power_w = by_inverter ? f.output_w : 0;
  out.brake_power_w = f.brake_w;
  out.heat_sink_c = s[state::kHeatSink];
  out.winding_c = s[state::kWinding];
  out.gates_on = switches.gates_on();
  out.chopper_on = model.chopper_on;
  out.precharge_bypassed = switches.bypassed;
  out.dc_link_ripple_v = ripple_estimate(model.rectifier, model.link, config.mains_frequency_hz, f.link_current_a);

  energy.from_mains_j = s[state::kFromMains];
  energy.stator_copper_j = s[state::kStatorCopper];
  energy.rotor_copper_j = s[state::kRotorCopper];
  energy.iron_j = s[state::kIron];
  energy.inverter_j = s[state::kInverter];
  energy.standby_j = s[state::kStandby];
  energy.source_resistance_j = s[state::kSource];
  energy.brake_j = s[state::kBrake];
  energy.friction_j = s[state::kFriction];
  energy.load_j = s[state::kLoad];
}

PowerPlant::PowerPlant(PlantConfig config, SolverSettings solver)
    : impl_(std::make_unique<Impl>(std::move(config), solver)) {}
PowerPlant::~PowerPlant() = default;
PowerPlant::PowerPlant(PowerPlant&&) noexcept = default;
PowerPlant& PowerPlant::operator=(PowerPlant&&) noexcept = default;

void PowerPlant::set_stage(const StageInput& stage) { impl_->set_stage(stage); }
void PowerPlant::set_mains(const MainsState& mains) { impl_->set_mains(mains); }
void PowerPlant::set_line(double voltage_v_rms) { impl_->set_line(voltage_v_rms); }
void PowerPlant::set_motor_source(MotorSource source) { impl_->set_motor_source(source); }
void PowerPlant::set_load(const LoadSettings& load) { impl_->set_load(load); }
void PowerPlant::set_shaft_locked(bool locked) { impl_->set_shaft_locked(locked); }
void PowerPlant::set_ambient(double ambient_c) { impl_->set_ambient(ambient_c); }
void PowerPlant::set_carrier(double carrier_hz) { impl_->set_carrier(carrier_hz); }
void PowerPlant::set_cooling(double resistance_factor) { impl_->set_cooling(resistance_factor); }
PowerPlant::Events PowerPlant::advance(Duration dt) { return impl_->advance(dt); }
const PlantMeasurements& PowerPlant::measurements() const { return impl_->measurements; }
const EnergyCounters& PowerPlant::energy() const { return impl_->energy; }
const PlantConfig& PowerPlant::config() const { return impl_->config; }
const MainsState& PowerPlant::mains() const { return impl_->config.mains; }
MotorSource PowerPlant::motor_source() const { return impl_->source; }
const LoadSettings& PowerPlant::load() const { return impl_->config.load; }
bool PowerPlant::shaft_locked() const { return impl_->model.load.locked; }
Duration PowerPlant::time() const { return impl_->time; }
double PowerPlant::stored_energy_j() const { return stored_energy(impl_->model, impl_->y()); }
void PowerPlant::restart_solver() { impl_->anew = true; }
bool PowerPlant::starts_anew() const { return impl_->anew; }
std::uint64_t PowerPlant::rhs_calls() const { return impl_->solver->rhs_calls(); }
std::uint64_t PowerPlant::reinitialisations() const { return impl_->reinitialisations; }

}  // namespace vinv::plant
