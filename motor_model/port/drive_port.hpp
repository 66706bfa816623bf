// DrivePort: all that an option board knows of its inverter, the dual-port RAM of the real device.
//
// Reads are immediate: they see what the inverter published at its last control tick. Writes go through one mailbox
// per inverter, as in the real device (OI-FR-E5NCO manual, 8.3.4): a board posts a request, the inverter decides
// at one of its next control ticks, the board collects the outcome. A second write meanwhile is kBusy.
// A refusal is a reason; each board maps it to its protocol's code in one table.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::port {

enum class Refusal : std::uint8_t {
  kNoSuchItem,      // parameter, monitor or sub-index does not exist
  kOutOfRange,      // value outside the allowed range or set
  kReadOnly,        //
  kWriteOnly,       //
  kRunning,         // not writable while the inverter runs
  kWriteDisabled,   // locked by the family's write disable parameter (Pr.77)
  kWrongMode,       // the network does not have the right to command (not in NET mode, command right elsewhere)
  kModeChangeRefused,  // operation mode change while running or with a start signal on, or not allowed by Pr.79
  kBusy,            // another write is in progress
  kNotReady,        // start-up or the dead time after a reset
  kFaulted,         // not possible while an alarm is present
  kNotFaulted,      // reset refused because no alarm is present, where the family says so
};
VINV_ENUM_RANGE(Refusal, kNoSuchItem, kNotFaulted);

enum class OperationMode : std::uint8_t { kExternal, kPu, kNetwork, kCombined1, kCombined2 };
VINV_ENUM_RANGE(OperationMode, kExternal, kCombined2);

// Parameters by the family's own numbering. sub: 0 for a one-word parameter, 1 and 2 for the frequency and analog
// half of a calibration parameter (Pr.902-905).
struct ParameterId {
  std::uint16_t number = 0;
  std::uint8_t sub = 0;
  friend constexpr bool operator==(ParameterId, ParameterId) = default;
  VINV_ARCHIVE(ParameterId, number, sub);
};

// Virtual control terminals that a network master may drive. They stand for terminals, not functions: the function
// of RL, RM, RH and MRS follows the family's terminal assignment (E500: Pr.180-183). kStop is the STOP command.
enum class NetTerminal : std::uint16_t {
  kStop = 1u << 0,
  kStf = 1u << 1,
  kStr = 1u << 2,
  kRh = 1u << 3,
  kRm = 1u << 4,
  kRl = 1u << 5,
  kMrs = 1u << 6,
  kRt = 1u << 7,
  kAu = 1u << 8,
  kJog = 1u << 9,
  kCs = 1u << 10,
  kRes = 1u << 11,
  kOutputStop = 1u << 12,  // output stop whatever the terminal assignment says
};

struct NetTerminals {
  std::uint16_t bits = 0;
  constexpr bool has(NetTerminal t) const { return (bits & static_cast<std::uint16_t>(t)) != 0; }
  constexpr void set(NetTerminal t, bool on) {
    const auto mask = static_cast<std::uint16_t>(t);
    bits = static_cast<std::uint16_t>(on ? bits | mask : bits & ~mask);
  }
  friend constexpr bool operator==(NetTerminals, NetTerminals) = default;
  VINV_ARCHIVE(NetTerminals, bits);
};

struct Status {
  bool running = false;            // RUN: output is on
  bool forward = false;            // running forward (by output direction)
  bool reverse = false;
  bool up_to_frequency = false;    // SU
  bool overload = false;           // OL: stall prevention acts
  bool power_failure = false;      // IPF
  bool frequency_detected = false; // FU
  bool alarm = false;
  bool ready = false;              // RY: could run
  bool stopping = false;           // decelerating to standstill
  bool fault_stop = false;         // ... because the communication was lost
  VINV_ARCHIVE(Status, running, forward, reverse, up_to_frequency, overload, power_failure, frequency_detected, alarm,
               ready, stopping, fault_stop);
};

// Newest first; 0 where fewer alarms are stored. Data codes of the family (E500: 10H E.OC1 ... A3H E.OP3).
using AlarmHistory = std::array<std::uint8_t, 8>;

struct WriteRequest {
  enum class Kind : std::uint8_t {
    kOperationMode,   // value: 1 network, 0 external; A700: 2 panel
    kCommand,         // terminals
    kFrequency,       // value: 0.01 Hz
    kAnalogReference, // value: 0-255, the option's D/A converter
    kParameter,       // parameter, value: raw word (family scale; 65535 stands for 9999 as the family has it)
    kClearAlarmHistory,
    kResetInverter,   // A700, value: 0 at any time, 1 as the reset selection (Pr.75) permits
    kRestoreDefaults, // value: 0 parameter clear, 1 all parameter clear; A700: 2, 3 without communication settings
    kErrorReset,      // A700: only while there is an alarm
    kStoredFrequency, // A700: as kFrequency, kept over power-off too
  };
  friend VINV_ENUM_RANGE(Kind, kOperationMode, kStoredFrequency);
  Kind kind = Kind::kCommand;
  ParameterId parameter{};
  std::uint32_t value = 0;
  NetTerminals terminals{};
  VINV_ARCHIVE(WriteRequest, kind, parameter, value, terminals);
};

using WriteOutcome = Result<void, Refusal>;

class DrivePort {
 public:
  virtual ~DrivePort() = default;

  // False from power-on until the inverter has started up, and during the dead time after a reset.
  virtual bool ready() const = 0;
  virtual OperationMode operation_mode() const = 0;
  virtual Status status() const = 0;
  // Number as the family's option numbers them. E500: 1 output frequency (0.01 Hz), 2 output current (0.01 A),
  // 3 output voltage (0.1 V).
  virtual Result<std::uint16_t, Refusal> read_monitor(unsigned number) const = 0;
  virtual Result<std::uint32_t, Refusal> read_parameter(ParameterId id) const = 0;
  virtual AlarmHistory alarm_history() const = 0;
  // Alarm present now, 0 if none.
  virtual std::uint8_t active_alarm() const = 0;
  // Start signals that are on, of any source (kStf, kStr): what keeps an operation mode from being left.
  virtual NetTerminals start_signals() const { return {}; }
  // Jog operation within external or panel operation.
  virtual bool jog_operation() const { return false; }
  // The set frequency that the network gave last, 0.01 Hz.
  virtual std::uint16_t network_frequency() const { return 0; }
  // How often a value could not be stored since power-on: a write that was accepted acts until power-off only.
  virtual std::uint32_t storage_failures() const { return 0; }

  // Posts a write. kBusy while one is pending, kNotReady in start-up and reset; otherwise accepted for decision.
  virtual WriteOutcome post_write(Instant now, const WriteRequest& request) = 0;
  // True from post_write until take_outcome has returned the decision.
  virtual bool write_pending() const = 0;
  // The decision on the pending write, once; empty while the inverter has not decided.
  virtual std::optional<WriteOutcome> take_outcome() = 0;

  // The board's own health and its master's: both act as the family's parameters say.
  virtual void set_communication_lost(bool lost) = 0;
  virtual void set_option_failed(bool failed) = 0;
};

}  // namespace vinv::port
