// One virtual inverter: personality (operation modes, parameters, terminals, alarms), control core and power plant.
// Everything that a person does at the real device is a call here; the option board uses port().
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motor_model/plant/power_plant.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::inverter {

enum class PanelKey : std::uint8_t { kFwd, kRev, kStopReset, kPuExt, kUp, kDown, kMode, kSet };

// A refused operation: a sentence for a person, naming the allowed values.
using Outcome = Result<void, std::string>;

struct InverterConfig {
  std::string model;  // "FR-E540-1.5K"
  plant::MachineParameters motor;
  plant::LoadSettings load;
  std::optional<plant::LossSettings> losses;  // default: typical for the motor
  std::optional<plant::MainsState> mains;     // default: nominal for the model
  double mains_frequency_hz = 50;
  double mains_phase_rad = 0;
  std::vector<plant::VoltagePoint> voltage_table;  // for MotorSource::kTable
  double ambient_c = 25;
  double brake_resistance_ohm = 0;  // external brake resistor; 0: none
  std::optional<double> source_resistance_ohm;
  bool option_fitted = true;
  int option_connector = 3;  // A700: 3 is the network option's; in 1 and 2 it is an option fault
  plant::SolverSettings solver;
  // Factory values of this unit in place of the family's ("Pr.345", 5), physical: what it starts with, and has again
  // after all clear or with a damaged EEPROM.
  std::vector<std::pair<std::string, double>> factory_values;
  // Snapshots are taken after ticks at multiples of this time: there the plant's solver starts anew, with or without a
  // snapshot, so that both runs are the same. A multiple of the control period; zero: nowhere.
  Duration snapshot_grid = std::chrono::milliseconds(100);
};

struct ParameterInfo {
  port::ParameterId id;
  std::string_view name;
  std::string_view unit;
  double minimum = 0, maximum = 0, increment = 1;
  std::string_view special;  // "8888|9999" or empty
  std::string_view allowed;  // allowed set where the range has holes, or empty
  double factory_default = 0;
  std::string_view source;
  std::string_view confidence;
  std::string_view effect;  // what it does here, or why it does nothing in a simulation
  bool acts = true;
};

// Named live values for `ctl status`, recordings and reports: name, value, unit. Order is fixed.
struct SignalValue {
  std::string_view name;
  double value = 0;
  std::string_view unit;
};

class Inverter {
 public:
  static constexpr Duration kControlPeriod = std::chrono::milliseconds(1);
  virtual ~Inverter() = default;

  // One control tick: takes commands, runs the control, integrates the plant to now + kControlPeriod, publishes.
  virtual void tick(Instant now) = 0;
  virtual port::DrivePort& port() = 0;
  virtual std::string_view family() const = 0;
  virtual std::string_view model() const = 0;

  // Operation panel / parameter unit.
  virtual Outcome press_key(PanelKey key) = 0;
  virtual Outcome set_panel_frequency(double hz) = 0;
  // Sets the speed the way that the operation mode listens to: at the panel, or at the analog input that counts now,
  // turned until it says this frequency. Refused in network operation.
  virtual Outcome set_reference(double hz) { return set_panel_frequency(hz); }
  virtual std::string display() const = 0;  // what the panel's digits show: "50.00", "E.OV3", ...
  // Control terminals by their printed name (STF, STR, RH, RM, RL, MRS, RES, ...); analog in V or mA ("2", "4").
  virtual Outcome set_terminal(std::string_view terminal, bool on) = 0;
  virtual Outcome set_analog(std::string_view terminal, double value) = 0;
  virtual std::vector<std::pair<std::string_view, bool>> terminals() const = 0;  // inputs, then outputs
  virtual std::vector<std::string_view> analog_terminals() const = 0;
  // As from the panel: physical value ("5.0" for Pr.7 = 5 s), with the panel's own rules (mode, Pr.77).
  // "Pr.7" or "Pr.902.1"; "Pr.CL", "ALLC" and "Er.CL" with value 1 clear parameters, all of them, the alarm history.
  // A read is refused for a parameter that does not exist or that the panel hides (Pr.160).
  virtual Outcome set_parameter(std::string_view name, double value) = 0;
  virtual Result<double, std::string> get_parameter(std::string_view name) const = 0;
  // First-start values of the plant file: written before the first power-on, outside the panel's rules.
  virtual Outcome preset_parameter(std::string_view name, double value) = 0;
  virtual std::vector<ParameterInfo> parameters() const = 0;

  // Surroundings.
  virtual void set_power(bool on) = 0;  // the drive's own breaker
  // True while the control supply is alive: from the breaker's closing (with enough mains) until the DC link has
  // fallen.
  virtual bool powered() const = 0;
  virtual void set_mains(const plant::MainsState& mains) = 0;
  virtual void set_load(const plant::LoadSettings& load) = 0;
  // Contactors outside of the inverter: what the motor hangs on. The mains are those of set_mains(), before the
  // breaker. Refused: a table that the config does not have.
  virtual Outcome set_motor_source(plant::MotorSource source) = 0;
  virtual void set_shaft_locked(bool locked) = 0;
  virtual void set_ambient(double celsius) = 0;
  virtual const plant::PowerPlant& plant() const = 0;
  // Faults by name: an alarm of the family ("E.PE"), which is an event and stays until reset, or a cause
  // ("earth_fault", "output_phase_open", "brake_transistor", "eeprom_write", "option", "current_sensor" ...). on = false
  // removes a cause.
  virtual Outcome inject_fault(std::string_view fault, bool on) = 0;
  virtual std::vector<std::string_view> injectable_faults() const = 0;

  virtual std::vector<SignalValue> signals() const = 0;
  // Alarm present now ("E.OV3") with its cause chain in one sentence; empty if none.
  virtual std::string alarm_name() const = 0;
  virtual std::string alarm_cause() const = 0;

  // EEPROM: the text of the file, versioned. The owner stores it when changed() says so, and hands it back at start.
  virtual std::string eeprom_text() const = 0;
  virtual bool take_eeprom_changed() = 0;  // true once after each change
  // Refuses a damaged text with line and reason; the inverter then has its storage alarm (E.PE) and factory values.
  virtual Outcome load_eeprom(std::string_view text) = 0;

  // --- snapshots (docs/decisions/0005-snapshots.md) ---
  // Everything that the future depends on, EEPROM included; option board and wires have theirs. An inverter made with
  // the same config takes it and goes on byte for byte as the saved one. Refused off the grid.
  Outcome save(Bytes& out);
  // Refuses damaged bytes and those of another build, model, motor or circuit, and is then what it was before.
  Outcome load(ByteView snapshot);
  // True before the first tick, after each tick on the grid of InverterConfig, and where the solver starts anew anyway.
  virtual bool on_snapshot_grid() const = 0;
  // As a part of a larger snapshot; the owner asks on_snapshot_grid().
  friend void archive(Archive& a, Inverter& inverter) { inverter.archive_state(a); }

 protected:
  virtual void archive_state(Archive& a) = 0;
};

// family: "fr-e500". Refuses an unknown family, model or bad motor with a sentence that names what is allowed.
Result<std::unique_ptr<Inverter>, std::string> make_inverter(std::string_view family, const InverterConfig& config);
std::vector<std::string_view> families();
std::vector<std::string_view> models(std::string_view family);

}  // namespace vinv::inverter
