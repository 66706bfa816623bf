// Everything that the control of one inverter remembers in every family, in plain copyable structs. What survives a
// power cycle is in EepromRecord and the parameter store; the rest is made anew when the control supply comes back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "motor_model/drive/pid.hpp"
#include "motor_model/drive/remote_setting.hpp"
#include "motor_model/inverter/analog_channel.hpp"
#include "motor_model/inverter/eeprom_text.hpp"
#include "motor_model/inverter/mailbox.hpp"
#include "motor_model/inverter/mitsubishi/auto_tuning.hpp"
#include "motor_model/inverter/mitsubishi/retry.hpp"
#include "motor_model/inverter/mitsubishi/run_command.hpp"
#include "motor_model/inverter/signal_map.hpp"
#include "motor_model/port/drive_port.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::inverter::mitsubishi {

enum class AnalogInput : std::uint8_t { k2, k4, k1 };
inline constexpr std::size_t kAnalogInputs = 3;

// As the wiring stands, whether the drive is powered or not.
struct Wiring {
  port::NetTerminals closed{};
  std::array<double, kAnalogInputs> analog{};  // V or mA
  double at(AnalogInput input) const { return analog[static_cast<std::size_t>(input)]; }
  VINV_ARCHIVE(Wiring, closed, analog);
};

// Causes that stay until they are taken away.
struct Causes {
  bool earth_fault = false;
  bool output_phase_open = false;
  bool brake_transistor = false;
  bool eeprom_write = false;      // writes to the EEPROM fail
  bool option = false;            // the option board dropped out of its connector
  bool external_thermal = false;  // the thermal relay has opened
  bool pu_disconnected = false;
  bool thermistor = false;      // the motor's thermistor is hot
  bool fan = false;             // the fan does not turn
  bool inrush_circuit = false;  // worn parts, where the family tells their life
  bool control_capacitor = false;
  bool main_capacitor = false;
  bool current_sensor = false;    // reads nothing
  bool dc_link_sensor = false;    // reads nothing
  bool heat_sink_sensor = false;  // an open thermistor: as hot as it can read
  bool eeprom_damaged = false;    // contents refused at the start; until the next power cycle
  VINV_ARCHIVE(Causes, earth_fault, output_phase_open, brake_transistor, eeprom_write, option, external_thermal,
               pu_disconnected, thermistor, fan, inrush_circuit, control_capacitor, main_capacitor, current_sensor,
               dc_link_sensor, heat_sink_sensor, eeprom_damaged);
};

enum class Screen : std::uint8_t { kMonitor, kFrequency, kJog };
VINV_ENUM_RANGE(Screen, kMonitor, kJog);

struct Panel {
  drive::RunDirection run = drive::RunDirection::kStop;  // FWD and REV keys
  bool jog_run = false;                                  // ... pressed on the jog screen
  bool stopped_by_panel = false;                         // PS: STOP outside PU operation
  Screen screen = Screen::kMonitor;
  int monitor = 0;       // 0 first display (Pr.52), 1 current, 2 voltage
  double edited_hz = 0;  // on the frequency screen, before SET
  VINV_ARCHIVE(Panel, run, jog_run, stopped_by_panel, screen, monitor, edited_hz);
};

struct Network {
  port::NetTerminals command{};
  double frequency_hz = 0;
  std::optional<std::uint8_t> converter;  // D/A value, once written
  bool communication_lost = false;
  bool option_failed = false;
  VINV_ARCHIVE(Network, command, frequency_hz, converter, communication_lost, option_failed);
};

struct ActiveAlarm {
  std::optional<std::size_t> row;  // in the alarm table
  std::string cause;
  VINV_ARCHIVE(ActiveAlarm, row, cause);
};

// What the option board and the panel read between two ticks.
struct Published {
  port::Status status{};
  std::uint16_t output_frequency = 0;  // 0.01 Hz
  std::uint16_t output_current = 0;    // 0.01 A
  std::uint16_t output_voltage = 0;    // 0.1 V
  OutputSignals outputs{};
  double set_frequency_hz = 0;
  double am_v = 0;
  bool fan = false;
  VINV_ARCHIVE(Published, status, output_frequency, output_current, output_voltage, outputs, set_frequency_hz, am_v,
               fan);
};

// Lost with the control supply.
struct Volatile {
  port::OperationMode mode = port::OperationMode::kExternal;
  Instant ready_at{};
  bool in_reset = false;  // RES held
  bool mrs_inverted = false;
  Panel panel;
  Network network;
  StartLatch start_latch;
  AnalogFilter input_2;
  AnalogFilter input_4;
  AnalogFilter current_monitor;
  drive::Pid pid;
  bool pid_active = false;  // it controls in this tick
  drive::RemoteSetting remote;
  double panel_frequency_hz = 0;                               // set at the panel; the record keeps what SET stored
  drive::RunDirection direction = drive::RunDirection::kStop;  // commanded in this tick
  bool tuned_until_stop = false;
  AutoTuning tuning;
  TuningStatus tuning_status = TuningStatus::kOff;  // beyond what its parameter stores
  std::uint32_t tuned_setting = 0;                  // that parameter: Pr.96, of a second motor another
  Retry retry;
  ActiveAlarm alarm;
  Mailbox mailbox;
  bool any_start_signal = false;  // of this tick's sources
  std::uint32_t storage_failures = 0;
  double operating_s = 0;  // not yet in the hour meter
  Published published;
  VINV_ARCHIVE(Volatile, mode, ready_at, in_reset, mrs_inverted, panel, network, start_latch, input_2, input_4,
               current_monitor, pid, pid_active, remote, panel_frequency_hz, direction, tuned_until_stop, tuning,
               tuning_status, tuned_setting, retry, alarm, mailbox, any_start_signal, storage_failures, operating_s,
               published);
};

}  // namespace vinv::inverter::mitsubishi
