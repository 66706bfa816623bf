// The power side of one drive: mains, rectifier, DC link with pre-charge and brake chopper, averaged inverter stage,
// induction machine (5th order, dq), one-mass load, losses, heat sink and motor winding temperature.
// Equations and symbols: motor_model/README.md. Peak-valued space vectors inside, rms at the measurements.
//
// The owner sets inputs, then advances by one control tick. Comparators (over-current, over-voltage, under-voltage)
// are roots of the integration: they shut the gates at their own instant, like the hardware, and are reported.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::plant {

// Star-equivalent T model, per phase.
struct MachineParameters {
  std::string name;
  double R_s_ohm = 0;
  double R_r_ohm = 0;
  double L_ls_h = 0;
  double L_lr_h = 0;
  double L_m_h = 0;
  int pole_pairs = 2;
  double inertia_kg_m2 = 0;
  double rated_power_w = 0;
  double rated_voltage_v_rms = 0;  // line to line
  double rated_frequency_hz = 50;
  double rated_current_a_rms = 0;
  double rated_speed_rpm = 0;
  VINV_ARCHIVE(MachineParameters, name, R_s_ohm, R_r_ohm, L_ls_h, L_lr_h, L_m_h, pole_pairs, inertia_kg_m2,
               rated_power_w, rated_voltage_v_rms, rated_frequency_hz, rated_current_a_rms, rated_speed_rpm);
};

// Refuses values that no machine has (non-positive, leakage above magnetising inductance, speed above synchronous ...)
// with a sentence that names the value and the allowed range.
Result<void, std::string> validate(const MachineParameters& machine);

// Shipped presets (motor_model/plant/machines.csv). nullptr if there is no such name.
const MachineParameters* find_machine(std::string_view name);
std::vector<std::string_view> machine_names();

struct LossSettings {
  double iron_loss_w_at_rated = 0;      // at rated voltage and frequency; drawn from the DC link while magnetised
  double inverter_loss_fraction = 0;    // of the apparent output power, at the reference carrier
  double inverter_switching_share = 0;  // of that loss; this part grows with the carrier frequency
  double standby_w = 0;                 // control supply from the DC link
  double viscous_nm_s = 0;              // friction torque = viscous * omega_mech
  double coulomb_nm = 0;                // dry friction, opposes rotation
  VINV_ARCHIVE(LossSettings, iron_loss_w_at_rated, inverter_loss_fraction, inverter_switching_share, standby_w,
               viscous_nm_s, coulomb_nm);
};
inline constexpr double kReferenceCarrier_hz = 1000;
// What a real drive of this motor's size has, typical for the family (losses.cpp says which numbers).
LossSettings typical_losses(const MachineParameters& machine);

struct DcLinkSettings {
  double capacitance_f = 235e-6;
  double source_resistance_ohm = 2.0;
  double precharge_resistance_ohm = 50.0;
  double bypass_closes_fraction = 0.80;  // of nominal sqrt(2) * rated mains voltage
  double bypass_opens_fraction = 0.75;
  double brake_resistance_ohm = 0;  // 0: no brake resistor fitted
  VINV_ARCHIVE(DcLinkSettings, capacitance_f, source_resistance_ohm, precharge_resistance_ohm, bypass_closes_fraction,
               bypass_opens_fraction, brake_resistance_ohm);
};

struct ThermalSettings {
  double heat_sink_k_per_w = 0;  // thermal resistance to ambient
  double heat_sink_time_constant_s = 300;
  double winding_rise_k_at_rated = 80;  // at rated current, steady state
  double winding_time_constant_s = 900;
  VINV_ARCHIVE(ThermalSettings, heat_sink_k_per_w, heat_sink_time_constant_s, winding_rise_k_at_rated,
               winding_time_constant_s);
};

struct Comparators {
  double over_current_a_peak = 0;  // on the magnitude of the stator current vector; 0: off
  double over_voltage_v = 0;       // 0: off
  double under_voltage_v = 0;      // 0: off; armed once the link has been above under_voltage_clear_v
  double under_voltage_clear_v = 0;
  VINV_ARCHIVE(Comparators, over_current_a_peak, over_voltage_v, under_voltage_v, under_voltage_clear_v);
};

struct LoadPoint {
  double time_s = 0;
  double torque_nm = 0;
  VINV_ARCHIVE(LoadPoint, time_s, torque_nm);
};

// Torque of the driven machine at the motor shaft. Sum of the terms. Constant and table torque are dry: at standstill
// they hold the shaft up to their value. A negative table value drives the shaft in its direction of rotation.
struct LoadSettings {
  double inertia_kg_m2 = 0;    // in addition to the motor's own
  double constant_nm = 0;      // opposes rotation (reverses sign with it)
  double linear_nm_s = 0;      // * omega_mech
  double quadratic_nm_s2 = 0;  // * omega_mech * |omega_mech|
  double hoist_nm = 0;         // gravity: acts in the reverse direction, whatever the rotation
  std::vector<LoadPoint>
      table;  // additional opposing torque over time since start, linear between points, held at the end
  VINV_ARCHIVE(LoadSettings, inertia_kg_m2, constant_nm, linear_nm_s, quadratic_nm_s2, hoist_nm, table);
};
Result<void, std::string> validate(const LoadSettings& load);

struct MainsState {
  double voltage_v_rms = 400;  // line to line, now
  std::array<bool, 3> phase_present{true, true, true};
  VINV_ARCHIVE(MainsState, voltage_v_rms, phase_present);
};

// What the stator hangs on. Contactors break before they make: a change interrupts the stator current first.
enum class MotorSource : std::uint8_t {
  kInverter,
  kMains,  // directly: the three-phase mains of set_line()
  kOpen,
  kTable,  // a voltage of its own, PlantConfig::voltage_table
};
VINV_ENUM_RANGE(MotorSource, kInverter, kTable);

// Stator voltage vector in the stator's own frame (alpha in phase U), phase peak, held until the next point.
struct VoltagePoint {
  double time_s = 0;
  double alpha_v = 0;
  double beta_v = 0;
  VINV_ARCHIVE(VoltagePoint, time_s, alpha_v, beta_v);
};

// In the order of time from 0 s on; empty: none.
Result<void, std::string> validate(const std::vector<VoltagePoint>& table);

struct PlantConfig {
  MachineParameters machine;
  LoadSettings load;
  LossSettings losses;
  DcLinkSettings dc_link;
  ThermalSettings thermal;
  Comparators comparators;
  MainsState mains;
  double nominal_mains_v_rms = 400;
  double mains_frequency_hz = 50;
  double mains_phase_rad = 0;  // of phase U at time zero: 0 at its positive peak
  std::vector<VoltagePoint>
      voltage_table;  // from the instant of MotorSource::kTable on; first point at 0 s; may be empty
  double ambient_c = 25;
};
// Everything above, each refusal a sentence that names the value and the allowed range.
Result<void, std::string> validate(const PlantConfig& config);

// What the inverter's control puts on the stage for the coming tick.
struct StageInput {
  bool gates_on = false;
  double frequency_hz = 0;    // electrical frequency of the voltage vector, signed
  double voltage_peak_v = 0;  // commanded phase peak; limited to Vdc / sqrt(3)
  bool chopper_enabled = false;
  double chopper_on_v = 0;
  double chopper_off_v = 0;
  friend bool operator==(const StageInput&, const StageInput&) = default;
  VINV_ARCHIVE(StageInput, gates_on, frequency_hz, voltage_peak_v, chopper_enabled, chopper_on_v, chopper_off_v);
};

enum class PlantEventKind : std::uint8_t { kOverCurrent, kOverVoltage, kUnderVoltage };
VINV_ENUM_RANGE(PlantEventKind, kOverCurrent, kUnderVoltage);

struct PlantEvent {
  PlantEventKind kind{};
  Duration after{};  // since the start of this advance()
  double value = 0;  // A peak or V at the instant
  VINV_ARCHIVE(PlantEvent, kind, after, value);
};

struct PlantMeasurements {
  // What is called output is the inverter's: no current while the motor hangs elsewhere.
  double output_current_a_rms = 0;
  double current_peak_a = 0;        // magnitude of the current vector
  double active_current_a_rms = 0;  // in phase with the voltage, signed: negative while regenerating
  double output_voltage_v_rms = 0;  // line to line, after the DC-link limit
  double dc_link_v = 0;
  double speed_rpm = 0;  // mechanical
  double torque_nm = 0;  // air gap
  double load_torque_nm = 0;
  double shaft_power_w = 0;
  double input_power_w = 0;   // from the mains, by rectifier and by a motor that hangs there directly
  double output_power_w = 0;  // from the inverter to the motor terminals
  double brake_power_w = 0;
  double heat_sink_c = 0;
  double winding_c = 0;
  bool gates_on = false;  // after comparators
  bool chopper_on = false;
  bool precharge_bypassed = false;
  double dc_link_ripple_v = 0;     // peak to peak, estimate from the link current; the simulated link is averaged
  double motor_current_a_rms = 0;  // of the stator, wherever it hangs
  double motor_voltage_v_rms = 0;  // line to line; of an open stator what the rotor flux induces
  VINV_ARCHIVE(PlantMeasurements, output_current_a_rms, current_peak_a, active_current_a_rms, output_voltage_v_rms,
               dc_link_v, speed_rpm, torque_nm, load_torque_nm, shaft_power_w, input_power_w, output_power_w,
               brake_power_w, heat_sink_c, winding_c, gates_on, chopper_on, precharge_bypassed, dc_link_ripple_v,
               motor_current_a_rms, motor_voltage_v_rms);
};

// Energy counters since construction, for power balances: joules.
struct EnergyCounters {
  double from_mains_j = 0;
  double stator_copper_j = 0;
  double rotor_copper_j = 0;
  double iron_j = 0;
  double inverter_j = 0;
  double standby_j = 0;
  double source_resistance_j = 0;
  double brake_j = 0;
  double friction_j = 0;
  double load_j = 0;  // to the driven machine, without inertia
  VINV_ARCHIVE(EnergyCounters, from_mains_j, stator_copper_j, rotor_copper_j, iron_j, inverter_j, standby_j,
               source_resistance_j, brake_j, friction_j, load_j);
};

enum class SolverChoice : std::uint8_t {
  kErk,       // ARKODE ERKStep Bogacki-Shampine 3(2), the default (docs/decisions)
  kCvodeBdf,  // for a stiff rectifier: source resistance * capacitance below about 0.15 ms
  kRk4,       // fixed step; baseline and independent check, for benchmarks and tests
};
VINV_ENUM_RANGE(SolverChoice, kErk, kRk4);

struct SolverSettings {
  SolverChoice choice = SolverChoice::kErk;
  double relative_tolerance = 1e-5;
  double fixed_step_s = 250e-6;  // kRk4 only
  VINV_ARCHIVE(SolverSettings, choice, relative_tolerance, fixed_step_s);
};

// The integrator gave up twice at the same place: numerics, never a drive trip. The scenario fails.
struct SolverFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class PowerPlant {
 public:
  // The config must be valid (validate()). The link starts empty, the shaft stands, everything is at ambient.
  explicit PowerPlant(PlantConfig config, SolverSettings solver = {});
  ~PowerPlant();
  PowerPlant(PowerPlant&&) noexcept;
  PowerPlant& operator=(PowerPlant&&) noexcept;

  // Inputs; each takes effect at the start of the next advance(). An input that really jumps re-initialises the solver.
  // Frequency and voltage that change by less than 1 % of rated are stairs of a ramp: they arrive along a line at the
  // end of the next advance() (after 1 ms if that is longer). A larger change is a jump and acts at once.
  void set_stage(const StageInput& stage);
  void set_mains(const MainsState& mains);
  // Mains at the motor's own contactor, line to line; 0: dead or a phase missing, which opens the contactor (a motor
  // feeder has a phase failure relay). The voltage of the config's mains until set. Its vector turns on from time zero
  // whatever happens, so that the instant of closing says the phase.
  void set_line(double voltage_v_rms);
  // kTable only with a table in the config; it begins with the next advance().
  void set_motor_source(MotorSource source);
  void set_load(const LoadSettings& load);
  void set_shaft_locked(bool locked);
  void set_ambient(double ambient_c);
  // Carrier of the pulse-width modulation; kReferenceCarrier_hz until set. Above 0.
  void set_carrier(double carrier_hz);
  // Thermal resistance of the heat sink as a multiple of the configured one: 1 with the fan running. Its heat capacity
  // stays, so it also cools down slower. At least 1. Does not disturb the solver.
  void set_cooling(double resistance_factor);

  // Integrates dt further with the inputs held; any dt. Returns the comparator events in time order, at most
  // kMaxEvents; after an event the gates stay shut until the owner has set gates_on = false once. Gates that come on
  // while the link is still above 97 % of the over-voltage level it has crossed are shut again at once, with an event.
  // While the stator is open i_s = 0 and the rotor flux decays in its own frame; the stage resumes with the angle
  // between voltage and rotor flux that it had when they were shut. Throws SolverFailure.
  static constexpr std::size_t kMaxEvents = 4;
  struct Events {
    std::array<PlantEvent, kMaxEvents> items{};
    std::size_t count = 0;
    friend void archive(Archive& a, Events& events);
  };
  Events advance(Duration dt);

  const PlantMeasurements& measurements() const;
  const EnergyCounters& energy() const;
  const PlantConfig& config() const;
  const MainsState& mains() const;
  MotorSource motor_source() const;
  const LoadSettings& load() const;
  bool shaft_locked() const;
  Duration time() const;           // integrated so far
  double stored_energy_j() const;  // in the fields, the moving mass and the link capacitor

  // Saves or loads everything that the future depends on, and the last measurements. A plant of another config or
  // solver refuses. Solvers save no history: after a load the solver starts anew at the next advance(), so a run is
  // reproduced exactly only if the saved plant does that there, too, which starts_anew() tells. What counts work
  // (rhs_calls, reinitialisations) goes on.
  friend void archive(Archive& a, PowerPlant& plant) { plant.archive_state(a); }
  bool starts_anew() const;
  // Starts the solver anew at the next advance(): for a grid on which snapshots may be taken.
  void restart_solver();

  // Right-hand-side evaluations and solver re-initialisations since construction, for benchmarks.
  std::uint64_t rhs_calls() const;
  std::uint64_t reinitialisations() const;

 private:
  void archive_state(Archive& a);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vinv::plant
