// The FR-E500: personality, control core and power plant glued together, one control tick at a time.
// OI-FR-E5NCO manual (mode, commands, monitors, parameters of the option); the rest typical for the family.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motor_model/inverter/access_rules.hpp"
#include "motor_model/inverter/alarm_table.hpp"
#include "motor_model/inverter/e500/operation_mode.hpp"
#include "motor_model/inverter/e500/settings.hpp"
#include "motor_model/inverter/e500/state.hpp"
#include "motor_model/inverter/family_data.hpp"
#include "motor_model/inverter/inverter.hpp"

namespace vinv::inverter::e500 {

inline constexpr std::string_view kFamily = "fr-e500";

// Both typical for the family.
inline constexpr Duration kStartUpTime = std::chrono::milliseconds(300);  // control supply to ready
inline constexpr Duration kResetTime = std::chrono::seconds(1);           // reset to ready

const FamilyData& family_data();

class E500Inverter final : public Inverter, private port::DrivePort {
 public:
  // The model exists and the config is valid.
  E500Inverter(const InverterConfig& config, const ModelRow& model, ParameterStore store);

  void tick(Instant now) override;
  port::DrivePort& port() override { return *this; }
  std::string_view family() const override { return kFamily; }
  std::string_view model() const override { return model_.model; }

  Outcome press_key(PanelKey key) override;
  Outcome set_panel_frequency(double hz) override;
  Outcome set_reference(double hz) override;
  std::string display() const override;
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

 private:
  void archive_state(Archive& a) override;  // inverter_snapshot.cpp

  // --- port::DrivePort (inverter_port.cpp) ---
  bool ready() const override;
  port::OperationMode operation_mode() const override { return v_.mode; }
  port::Status status() const override { return v_.published.status; }
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned number) const override;
  Result<std::uint32_t, port::Refusal> read_parameter(port::ParameterId id) const override;
  port::AlarmHistory alarm_history() const override { return record_.alarms; }
  std::uint8_t active_alarm() const override;
  port::NetTerminals start_signals() const override;
  std::uint32_t storage_failures() const override { return v_.storage_failures; }
  port::WriteOutcome post_write(Instant now, const port::WriteRequest& request) override;
  bool write_pending() const override { return v_.mailbox.pending(); }
  std::optional<port::WriteOutcome> take_outcome() override { return v_.mailbox.take(); }
  void set_communication_lost(bool lost) override { v_.network.communication_lost = lost; }
  void set_option_failed(bool failed) override { v_.network.option_failed = failed; }
  port::WriteOutcome decide(const port::WriteRequest& request);
  port::WriteOutcome decide_mode(bool network);
  port::WriteOutcome decide_command(port::NetTerminals terminals);

  // --- one tick (inverter_tick.cpp) ---
  void follow_supply();
  void follow_reset_terminal();
  void follow_causes();
  void follow_mode();
  plant::StageInput control();
  void publish();
  void change_mode(port::OperationMode next);
  InputSignals assigned(bool rl, bool rm, bool rh, bool mrs) const;
  InputSignals wired_signals() const;
  bool has_function(InputSignal signal) const;
  struct Inputs {
    InputSignals signals;  // of the sources that count in this mode
    drive::RunDirection direction = drive::RunDirection::kStop;
    bool output_stop = false;
    bool external_thermal = false;
  };
  Inputs read_inputs();
  double set_frequency(const Inputs& inputs);
  double terminal_2_percent();
  double terminal_4_percent();
  double remote_frequency(const Inputs& inputs, double main_hz);
  const drive::DriveSettings& settings_for(const SettingsSelection& selection);
  plant::StageInput tune(const Inputs& inputs);
  void store_tuned_resistance(double ohm);
  void finish_tuning();

  // --- alarms (inverter_alarms.cpp) ---
  void raise_trip(const drive::Trip& trip);
  void raise(std::size_t row, std::string cause);
  void raise(std::string_view name, std::string cause);
  void follow_retry();
  std::string trip_cause(const AlarmRow& row, const drive::Trip& trip) const;
  bool reset_accepted() const;  // Pr.75 and the alarm's own rule
  void begin_reset();
  bool alarm_visible() const;  // not while a retry without alarm output waits

  // --- parameters and EEPROM (inverter_parameters.cpp) ---
  Outcome write_from_panel(std::size_t row, double value);
  std::optional<port::Refusal> write_parameter(std::size_t row, std::int32_t raw, Storage storage);
  std::optional<port::Refusal> command_parameter(unsigned number, std::int32_t raw);
  void link_calibration(unsigned number, Storage storage);
  void clear_parameters(ClearKind kind);
  std::int32_t shown_raw(std::size_t row) const;
  AccessSituation access(Writer writer) const;
  bool in_user_group(unsigned number) const;
  void eeprom_written();
  void start_volatile();

  bool running() const { return v_.published.status.running; }
  ModeSituation mode_situation() const;
  std::string mode_sentence() const;

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
};

// Refuses with a sentence.
Result<std::unique_ptr<Inverter>, std::string> make_e500(const InverterConfig& config);

}  // namespace vinv::inverter::e500
