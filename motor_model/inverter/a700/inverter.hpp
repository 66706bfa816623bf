// The FR-A700: what it differs in from the other Mitsubishi families. FR-A7NE manual 4 (modes, command sources,
// communication errors, resets) and 7.2.1 (monitors); the rest typical for the family.
#pragma once

#include <memory>
#include <optional>

#include "motor_model/drive/brake_sequence.hpp"
#include "motor_model/drive/traverse.hpp"
#include "motor_model/inverter/a700/communication_error.hpp"
#include "motor_model/inverter/a700/du07.hpp"
#include "motor_model/inverter/a700/motor_settings.hpp"
#include "motor_model/inverter/a700/operation_mode.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"
#include "motor_model/inverter/a700/supply.hpp"
#include "motor_model/inverter/a700/tables.hpp"
#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/port/speed_conversion.hpp"

namespace vinv::inverter::a700 {

inline constexpr std::string_view kFamily = "fr-a700";

const mitsubishi::Personality& personality(bool large = false);

// SettingsSelection::variant: bits.
enum Variant : std::uint32_t {
  kRestartOff = 1,          // CS is assigned and off
  kBoostForward = 2,        // X17 with Pr.14 = 4 and 5
  kHeldByX13 = 4,           // Pr.11 = 8888 and X13 on
  kSecondSPattern = 8,      // X20
  kSecondMotor = 16,        // RT with Pr.450
  kTorqueByMc = 32,         // MC with Pr.800 or 451 = 12
  kAboveSwitch = 64,        // above Pr.147
  kAboveSecondStall = 128,  // above Pr.49
  kAboveThirdStall = 256,   // above Pr.115
  kFailureStop = 512,       // deceleration at a power failure ...
  kFailureSlow = 1024,      // ... below Pr.266
  kContact = 2048,          // stop-on-contact ...
  kContactSlow = 4096,      // ... at low output frequency
};

// Positions in EepromRecord::counters.
enum Counter : std::size_t {
  kEnergizedSeconds,
  kEnergyJoule,
  kLineErrors,
  kMaintenanceSeconds,
  kNetworkFrequency,
  kInrushOperations,
  kCapacitorAgeing,  // seconds at 40 degC
  kMainCapacitorPercent,
  kMainCapacitorMeasuring,
  kPasswordSet,
  kPasswordErrors,
  kSavedJoule,
  kSavingSeconds,
  kEnergyLimit,  // last write of Pr.170 that was no clear: 10, or 0 for 9999
  kSavingMode,   // of Pr.898: 1, 10, or 0 for 9999
  kCounters,
};

// With Pr.875 = 1 the motor decelerates before these.
enum class LateAlarm : std::uint8_t { kNone, kMotorThermal, kThermalRelay, kThermistor };
VINV_ENUM_RANGE(LateAlarm, kNone, kThermistor);

// Lost with the control supply, beyond what every family has.
struct State {
  bool alive = false;  // since power-on
  int raw_pr340 = 0;   // as it was at power-on or reset
  CommunicationError communication;
  bool external_jog = false;
  bool reversed = false;  // the analog frequency is negative: the other direction
  AnalogFilter input_1;
  double percent_1 = 0;  // terminals 1 and 4, filtered
  double percent_4 = 0;
  bool second_motor = false;
  double backward_limit_hz = -1;  // torque control: DriveCommand's
  AnalogFilter am;
  double capacitor_aged_s = 0;  // not yet in the record
  bool thermal_relay_open = false;
  LateAlarm late_alarm = LateAlarm::kNone;
  drive::OnDelay phase_lost;
  drive::OnDelay thermistor_hot;
  drive::OnDelay sleep_due;
  bool asleep = false;
  bool pid_started = false;  // Pr.127 has been reached since the start
  double pid_set_point = 0;  // percent
  double pid_measured = 0;
  double current_peak_a = 0;  // since the start
  double dc_link_peak_v = 0;
  bool was_running = false;
  drive::OnDelay overloaded;  // Pr.157
  drive::BrakeSequence brake;
  bool brake_open = false;  // BRI
  double last_direction = 1;
  drive::Traverse traverse;
  bool traversing = false;  // the set frequency has been reached once
  double energized_s = 0;   // not yet in the record
  double energy_j = 0;
  std::int64_t line_errors = 0;  // not all in the record
  Supply supply;
  VINV_ARCHIVE(State, alive, raw_pr340, communication, external_jog, reversed, input_1, percent_1, percent_4,
               second_motor, backward_limit_hz, am, capacitor_aged_s, thermal_relay_open, late_alarm, phase_lost,
               thermistor_hot, sleep_due, asleep, pid_started, pid_set_point, pid_measured, current_peak_a,
               dc_link_peak_v, was_running, overloaded, brake, brake_open, last_direction, traverse, traversing,
               energized_s, energy_j, line_errors, supply);
};

// What a short power failure leaves with Pr.340 = 2 or 12.
struct Remembered {
  bool valid = false;
  port::NetTerminals command{};
  double frequency_hz = 0;
  VINV_ARCHIVE(Remembered, valid, command, frequency_hz);
};

class A700Inverter final : public mitsubishi::MitsubishiInverter {
 public:
  A700Inverter(const mitsubishi::Personality& personality, const InverterConfig& config, const ModelRow& model,
               ParameterStore store)
      : MitsubishiInverter(personality, config, model, std::move(store)), connector_(config.option_connector) {}

  Outcome press_key(PanelKey key) override;
  Outcome set_reference(double hz) override;
  std::string display() const override { return du07().digits; }
  Du07 du07() const;

 private:
  // --- what the base asks for ---
  port::OperationMode start_mode() const override { return a700::start_mode(mode_situation()); }
  Result<port::OperationMode, port::Refusal> requested_mode(ModeRequest request) const override {
    return request_mode(v_.mode, request, mode_situation());
  }
  port::OperationMode mode_by_settings() const override { return follow_settings(v_.mode, mode_situation()); }
  mitsubishi::Inputs read_inputs() override;
  double set_frequency(const mitsubishi::Inputs& inputs) override;
  mitsubishi::SettingsSelection selection(const mitsubishi::Inputs& inputs) const override;
  drive::DriveSettings make_settings(const mitsubishi::SettingsSelection& selection) const override;
  void follow_communication() override;
  void publish_family(OutputSignals& outputs) override;
  void add_command(const mitsubishi::Inputs& inputs, drive::DriveCommand& command, drive::Sensors& sensors) override;
  std::optional<port::Refusal> command_parameter(unsigned number, std::int32_t raw) override;
  std::int32_t command_value(unsigned number) const override;
  std::optional<std::string> not_fitted(unsigned number, std::int32_t raw) const override;
  TuningNumbers tuning_numbers() const override;
  void link_parameters(unsigned number, Storage storage) override;
  bool in_user_group(unsigned number) const override;
  bool network_commands() const override { return option_works() && store_.value(pr::kNetworkOwner) != 1; }
  std::optional<std::string> panel_commands() const override;
  port::WriteOutcome decide_family(const port::WriteRequest& request) override;
  port::WriteOutcome decide_reset(const port::WriteRequest& request) override;
  bool jogging() const override { return s_.external_jog || MitsubishiInverter::jogging(); }
  Outcome panel_mode_key() override;
  bool jog_by_mode_key() const override { return false; }
  bool output_on(std::size_t terminal, OutputSignal signal) const override;
  void start_family() override;
  void stop_family(EepromRecord& record) override;
  void count_family(EepromRecord& record) const override;
  void archive_family(Archive& a) override;

  // --- port::DrivePort ---
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned number) const override;
  port::AlarmHistory alarm_history() const override;
  bool jog_operation() const override { return jogging(); }
  std::uint16_t network_frequency() const override;
  port::DriveFacts facts() const override { return {MitsubishiInverter::facts().voltage_class_v, large()}; }

  bool large() const { return model_.motor_kw >= kLarge_kw; }
  bool option_works() const { return option_fitted_ && connector_ == 3; }
  ModeSituation mode_situation() const;
  struct Rights {
    int operation = 0;  // Pr.338
    int speed = 0;      // Pr.339
  };
  Rights network_rights() const;
  double source_frequency(const mitsubishi::Inputs& inputs);
  double analog_percent_2();
  double analog_percent_4();
  double compensation_hz(double percent_1) const;
  double pid_or_main(const mitsubishi::Inputs& inputs, double main_hz, double percent_1, double percent_2,
                     double percent_4);
  double traverse(const mitsubishi::Inputs& inputs, double set_hz);
  void follow_brake(drive::DriveCommand& command, const drive::Sensors& sensors);
  void follow_sleep(const mitsubishi::Inputs& inputs);
  void follow_causes_of_its_own();
  void count(double dt_s);
  void keep_whole_seconds(EepromRecord& record);
  bool vector_control() const;
  // --- supply, power and what follows the load (supply.cpp) ---
  void follow_contactors(drive::DriveCommand& command);
  void open_contactors();
  void follow_power_failure(drive::DriveCommand& command, const drive::Sensors& sensors);
  void follow_regeneration(drive::DriveCommand& command, const drive::Sensors& sensors);
  void follow_saving(drive::DriveCommand& command);
  bool supply_good() const;
  bool on_contact(InputSignals signals) const;
  std::optional<double> load_speed_frequency(const mitsubishi::Inputs& inputs);
  bool drives_contactors() const;
  bool has_output(OutputSignal signal) const;
  double saving_value() const;  // monitor 50
  double saved_value() const;   // monitor 51
  int monitor_decimals(const MonitorRow& row) const;
  void follow_late_alarm();
  // --- life of parts (part_life.cpp) ---
  int part_percent(unsigned number) const;
  int life_alarms() const;
  void measure_main_capacitor(EepromRecord& record) const;
  // --- password (password.cpp) ---
  bool locked(Writer writer, unsigned number, bool write) const override;
  std::optional<port::Refusal> enter_password(std::int32_t raw);
  std::int32_t shown_password() const;
  bool password_shuts_option_out() const;
  void cleared(ClearKind kind) override;
  // --- vector control (inverter_torque.cpp) ---
  void follow_motor(const mitsubishi::Inputs& inputs);
  MotorSelection motor_selection(const mitsubishi::SettingsSelection& selection) const;
  bool terminal_4_sets_frequency() const;
  double torque_command_percent() const;
  double speed_limit(double set_hz, bool reverse);
  void follow_torque(drive::DriveCommand& command, const mitsubishi::Inputs& inputs);
  double monitor_value(unsigned code) const;  // physical; 0 for what is not fitted
  double meter_share(unsigned code) const;    // of full scale
  port::SpeedConversion speed_conversion() const;
  std::uint16_t terminal_bits() const;

  int connector_;
  State s_;
  Remembered remembered_;
};

// Refuses with a sentence.
Result<std::unique_ptr<Inverter>, std::string> make_a700(const InverterConfig& config);

}  // namespace vinv::inverter::a700
