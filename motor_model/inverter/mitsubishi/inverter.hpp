// What the Mitsubishi families share: operation, parameters, terminals, alarms, panel and option port around control
// core and power plant, one control tick at a time. Where a family differs it overrides a function of the personality
// part.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motor_model/inverter/access_rules.hpp"
#include "motor_model/inverter/alarm_table.hpp"
#include "motor_model/inverter/inverter.hpp"
#include "motor_model/inverter/mitsubishi/mode_request.hpp"
#include "motor_model/inverter/mitsubishi/personality.hpp"
#include "motor_model/inverter/mitsubishi/settings.hpp"
#include "motor_model/inverter/mitsubishi/state.hpp"

namespace vinv::inverter::mitsubishi {

// Both typical for the family.
inline constexpr Duration kStartUpTime = std::chrono::milliseconds(300);  // control supply to ready
inline constexpr Duration kResetTime = std::chrono::seconds(1);           // reset to ready

struct Inputs {
  InputSignals signals;  // of the sources that count in this mode
  drive::RunDirection direction = drive::RunDirection::kStop;
  bool output_stop = false;
  bool external_thermal = false;
};

class MitsubishiInverter : public Inverter, protected port::DrivePort {
 public:
  // The model exists and the config is valid.
  MitsubishiInverter(const Personality& personality, const InverterConfig& config, const ModelRow& model,
                     ParameterStore store);

  void tick(Instant now) override;
  port::DrivePort& port() override { return *this; }
  std::string_view family() const override { return personality_.family; }
  std::string_view model() const override { return model_.model; }

  Outcome press_key(PanelKey key) override;
  Outcome set_panel_frequency(double hz) override;
  Outcome set_terminal(std::string_view terminal, bool on) override;
  Outcome set_analog(std::string_view terminal, double value) override;
  std::vector<std::pair<std::string_view, bool>> terminals() const override;
  std::vector<std::string_view> analog_terminals() const override;
  Outcome set_parameter(std::string_view name, double value) override;
  Result<double, std::string> get_parameter(std::string_view name) const override;
  Outcome preset_parameter(std::string_view name, double value) override;
  std::vector<ParameterInfo> parameters() const override;

  void set_power(bool on) override;
  bool powered() const override;
  void set_mains(const plant::MainsState& mains) override;
  void set_load(const plant::LoadSettings& load) override { plant_.set_load(load); }
  Outcome set_motor_source(plant::MotorSource source) override;
  void set_shaft_locked(bool locked) override { plant_.set_shaft_locked(locked); }
  void set_ambient(double celsius) override { plant_.set_ambient(celsius); }
  const plant::PowerPlant& plant() const override { return plant_; }
  Outcome inject_fault(std::string_view fault, bool on) override;
  std::vector<std::string_view> injectable_faults() const override;

  std::vector<SignalValue> signals() const override;
  std::string alarm_name() const override;
  std::string alarm_cause() const override { return v_.alarm.cause; }

  std::string eeprom_text() const override;
  bool take_eeprom_changed() override;
  Outcome load_eeprom(std::string_view text) override;

  bool on_snapshot_grid() const override { return plant_.starts_anew(); }

 protected:
  // --- what a family differs in ---
  virtual port::OperationMode start_mode() const = 0;  // after power-on and reset
  virtual Result<port::OperationMode, port::Refusal> requested_mode(ModeRequest request) const = 0;
  virtual port::OperationMode mode_by_settings() const = 0;  // without any request
  virtual Inputs read_inputs() = 0;                          // one tick's commands, of the sources that count
  virtual double set_frequency(const Inputs& inputs) = 0;    // Hz, of the source that counts
  virtual SettingsSelection selection(const Inputs& inputs) const = 0;
  virtual drive::DriveSettings make_settings(const SettingsSelection& selection) const = 0;
  virtual void follow_communication() = 0;  // a lost line, a failed option; every tick while ready
  // Signals of the output terminals and meters beyond those of every family.
  virtual void publish_family(OutputSignals& outputs) = 0;
  // May change settings_ for this tick, too.
  virtual void add_command(const Inputs&, drive::DriveCommand&, drive::Sensors&) {}
  // Parameters that are commands: what a write does, what a read shows.
  virtual std::optional<port::Refusal> command_parameter(unsigned number, std::int32_t raw) = 0;
  virtual std::int32_t command_value(unsigned number) const = 0;
  // What auto tuning reads and writes for the motor that runs: its setting, capacity and stator resistance.
  struct TuningNumbers {
    unsigned setting;
    unsigned capacity;
    unsigned r1;
  };
  virtual TuningNumbers tuning_numbers() const;
  // Why a value cannot be: what it selects is not fitted.
  virtual std::optional<std::string> not_fitted(unsigned, std::int32_t) const { return std::nullopt; }
  // Locks beyond those of every family (a password).
  virtual bool locked(Writer, unsigned, bool /*write*/) const { return false; }
  virtual void cleared(ClearKind) {}
  // Parameters that are one value under two numbers.
  virtual void link_parameters(unsigned number, Storage storage) = 0;
  virtual bool in_user_group(unsigned number) const = 0;
  virtual bool network_commands() const { return true; }  // the option may start and set the speed at all
  virtual std::optional<std::string> panel_commands() const { return std::nullopt; }  // why its run keys do nothing
  virtual port::WriteOutcome decide_family(const port::WriteRequest& request);
  virtual port::WriteOutcome decide_reset(const port::WriteRequest& request);
  virtual bool jogging() const { return v_.mode == port::OperationMode::kPu && v_.panel.jog_run; }
  virtual Outcome panel_mode_key();
  virtual bool jog_by_mode_key() const { return true; }
  virtual bool output_on(std::size_t, OutputSignal signal) const { return v_.published.outputs.has(signal); }
  virtual void start_family() {}              // power-on and reset
  virtual void stop_family(EepromRecord&) {}  // the supply goes: what is kept until then
  virtual void archive_family(Archive&) {}
  virtual void count_family(EepromRecord&) const {}  // counters that are not yet in the record

  // --- port::DrivePort (inverter_port.cpp) ---
  bool ready() const override;
  port::OperationMode operation_mode() const override { return v_.mode; }
  port::Status status() const override { return v_.published.status; }
  Result<std::uint32_t, port::Refusal> read_parameter(port::ParameterId id) const override;
  port::AlarmHistory alarm_history() const override { return record_.alarms; }
  std::uint8_t active_alarm() const override;
  port::DriveFacts facts() const override {
    return {.voltage_class_v = static_cast<std::uint16_t>(model_.voltage_class_v)};
  }
  port::NetTerminals start_signals() const override;
  std::uint32_t storage_failures() const override { return v_.storage_failures; }
  port::WriteOutcome post_write(Instant now, const port::WriteRequest& request) override;
  bool write_pending() const override { return v_.mailbox.pending(); }
  std::optional<port::WriteOutcome> take_outcome() override { return v_.mailbox.take(); }
  void set_communication_lost(bool lost) override { v_.network.communication_lost = lost; }
  void set_option_failed(bool failed) override { v_.network.option_failed = failed; }

  // --- for the families ---
  // What the drive takes the plant to be: a sensor may have failed.
  plant::PlantMeasurements measured() const;
  InputSignals assigned(port::NetTerminals closed) const;
  InputSignals wired_signals() const;
  bool has_function(InputSignal signal) const;
  // Signals of the panel's latch, Pr.78 and Pr.250: what a family's sources come to.
  void take_start(Inputs& inputs, const StartSignals& start, bool by_panel);
  double filtered_percent(AnalogFilter& filter, double percent) const;  // Pr.74
  double remote_frequency(const Inputs& inputs, double main_hz);
  double pid_frequency(const Inputs& inputs, drive::PidAction action, double set_point, double measured,
                       double full_scale_hz);
  bool any_start_signal() const { return start_signals().bits != 0; }
  void change_mode(port::OperationMode next);
  void raise(std::size_t row, std::string cause);
  void raise(std::string_view name, std::string cause);
  bool reset_accepted() const;  // Pr.75 and the alarm's own rule
  void begin_reset();
  bool alarm_visible() const;  // not while a retry without alarm output waits
  std::optional<port::Refusal> group_command(std::size_t group, bool add, std::int32_t raw);
  std::optional<port::Refusal> write_parameter(std::size_t row, std::int32_t raw, Storage storage);
  void copy_parameter(port::ParameterId from, port::ParameterId to, Storage storage);
  void clear_parameters(ClearKind kind, bool communication_too = true);
  AccessSituation access(Writer writer) const;
  void eeprom_written();
  bool running() const { return v_.published.status.running; }
  bool panel_sets_speed() const;
  std::string mode_sentence() const;
  SettingsSurroundings surroundings() const;

  const Personality& personality_;
  const FamilyData& data_;
  const ModelRow& model_;
  bool option_fitted_;
  double nominal_mains_v_rms_;
  bool brake_resistor_;
  Duration snapshot_grid_;

  // state
  Instant now_{};
  plant::MainsState mains_;
  bool breaker_ = false;
  bool control_alive_ = false;
  bool eeprom_changed_ = false;
  Wiring wiring_;
  Causes causes_;
  ParameterStore store_;
  EepromRecord record_;
  Volatile v_;
  drive::DriveCore core_;
  plant::PowerPlant plant_;
  plant::PowerPlant::Events events_{};

  // derived from the parameters, made anew when they change
  drive::DriveSettings settings_;
  SettingsSelection settings_selection_;
  std::uint32_t settings_revision_ = 0;
  mutable InputSignals functions_;  // that some input terminal has
  mutable std::uint32_t functions_revision_ = 0;

 private:
  void archive_state(Archive& a) override;  // inverter_snapshot.cpp
  port::WriteOutcome decide(const port::WriteRequest& request);
  port::WriteOutcome decide_mode(ModeRequest request);
  port::WriteOutcome decide_command(port::NetTerminals terminals);

  // --- one tick (inverter_tick.cpp) ---
  void follow_supply();
  void follow_reset_terminal();
  void follow_causes();
  void follow_mode();
  plant::StageInput control();
  void publish();
  const drive::DriveSettings& settings_for(const SettingsSelection& selection);
  plant::StageInput tune(const Inputs& inputs);
  void store_tuned_resistance(double ohm);
  void finish_tuning();

  // --- alarms (inverter_alarms.cpp) ---
  void raise_trip(const drive::Trip& trip);
  void follow_retry();
  std::string trip_cause(const AlarmRow& row, const drive::Trip& trip) const;

  // --- parameters and EEPROM (inverter_parameters.cpp) ---
  Outcome write_from_panel(std::size_t row, double value);
  std::int32_t shown_raw(std::size_t row) const;
  void start_volatile();
};

// What the config asks for, checked; the store has the factory values of this unit.
struct Prepared {
  const ModelRow* model = nullptr;
  ParameterStore store;
};
Result<Prepared, std::string> prepare(const Personality& personality, const InverterConfig& config);

}  // namespace vinv::inverter::mitsubishi
