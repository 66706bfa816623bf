// PowerPlant's inside. Private to motor_model/plant/power_plant*.cpp.
#pragma once

#include "motor_model/plant/plant_model.hpp"
#include "motor_model/plant/switches.hpp"

namespace vinv::plant {

struct PowerPlant::Impl {
  Impl(PlantConfig config_in, SolverSettings solver_settings);

  // Inputs.
  void set_stage(const StageInput& next);
  void take_stage_levels();  // what does not ramp
  void set_mains(const MainsState& next);
  void set_line(double voltage_v_rms);
  void set_motor_source(MotorSource next);
  void set_load(const LoadSettings& next);
  void set_shaft_locked(bool locked);
  void set_ambient(double ambient);
  void set_carrier(double carrier);
  void set_cooling(double factor);
  void take_inverter_loss();  // carrier and cooling into the model

  // One advance().
  Events advance(Duration dt);
  void apply_stage(Duration dt);  // starts the way of frequency and voltage to the new values
  void end_stage_way();
  void rebase();      // solver time 0 is now
  void begin_anew();  // settles switches and shaft, restarts the solver at time_
  void integrate_to(Duration end);
  void on_roots(std::uint32_t roots);
  void settle_link(double v);
  void settle_shaft();
  bool current_too_high() const;
  void shut_for_over_current();
  void refresh_rectifier();
  bool stage_feeds() const { return source == MotorSource::kInverter && switches.gates_on(); }
  bool line_feeds() const;
  void interrupt_stator();
  void refresh_line();
  void enter_voltage_point();
  void refresh_model();  // switch positions and levels into the right-hand side
  void restart_solver(double t);
  void enter_table_segment();
  void report(PlantEventKind kind, double value);
  void measure();
  void take_held_inputs();  // everything derived from them, after a load

  double* y() { return solver->states(); }
  const double* y() const { return solver->states(); }

  // Inputs as held.
  PlantConfig config;  // load, mains and ambient inside follow the inputs
  StageInput stage;
  double carrier_hz = kReferenceCarrier_hz;
  double cooling_factor = 1;
  bool stage_jumps = true;  // frequency or voltage step to the new value instead of ramping
  MotorSource source = MotorSource::kInverter;
  Duration source_since{};
  double line_v_rms = 0;

  PlantModel model;
  SwitchLevels levels;
  Switches switches;
  std::unique_ptr<Solver> solver;
  std::uint64_t constants = 0;  // checksum of what is not state: a snapshot fits only a plant with the same

  // The integer clock is the master; the solver counts seconds since base.
  Duration time{};
  Duration base{};
  double t = 0;
  bool anew = true;                        // an input has jumped since the last advance
  Duration table_end{};                    // next point of the load table
  Duration way_end = Duration::max();      // frequency and voltage have arrived
  Duration voltage_end = Duration::max();  // next point of the voltage table

  Duration advance_start{};
  Events events;
  PlantMeasurements measurements;
  EnergyCounters energy;
  std::uint64_t reinitialisations = 0;
};

}  // namespace vinv::plant
