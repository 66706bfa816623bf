// The CANopen side of the OI-FR-E5NCO: its objects become accesses to the inverter's dual-port RAM, NMT drives the
// operation mode, alarms become emergency messages. OI-FR-E5NCO manual: 2.4 LED, 4.2 modes, 6 communication profile,
// 7 device profile; objects.csv is its dictionary.
//
// An SDO download is answered when the inverter has decided. PDO writes are never answered: what the inverter refuses
// is an EMCY with the reason, once until the same thing is accepted or refused for another reason.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/oi_fr_e5nco/drive_profile.hpp"
#include "option_boards/boards/oi_fr_e5nco/refusal_codes.hpp"
#include "option_boards/boards/oi_fr_e5nco/write_queue.hpp"
#include "option_boards/boards/option_board.hpp"
#include "option_boards/canopen/slave.hpp"
#include "sim/base/archive.hpp"

namespace vinv::boards::oi_fr_e5nco {

// Items of objects.csv, after canopen::SlaveItem.
enum ObjectItem : std::uint8_t {
  kStatusRegister = canopen::kFirstApplicationItem,
  kRestore,
  kMonitor,
  kClearAlarms,
  kResetInverter,
  kParameter,
  kAlarms,
  kCommand,
  kSpeedHz,
  kSpeedRpm,
  kSpeedAnalog,
  kAbortOption,
  kControlword,
  kStatusword,
  kTargetVelocity,
  kVelocity,
  kFrequencyParameter,
  kDeltaTime,
  kModeOfOperation,
};

// The board's dictionary; one constant table for all boards of the process.
const canopen::ObjectTable& object_table();

class CanopenUnit final : public CanChannel, private canopen::Application {
 public:
  static constexpr Duration kAlarmDelay = std::chrono::milliseconds(40);  // 7.1.1
  static constexpr Duration kLeaveRetryInterval = std::chrono::milliseconds(100);

  // The drive outlives the unit.
  explicit CanopenUnit(port::DrivePort& drive) : drive_(drive), slave_(object_table(), *this) {}

  // With supply from now on. node 0: no valid address, the board stays off the bus.
  void start(Instant now, std::uint8_t node, std::uint32_t bit_rate);
  void stop();
  // After each control tick of the inverter, with or without supply.
  void handle_drive_tick(Instant now);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  // The LED of 2.4: "off", "green", "green flashing", "red", "red flashing".
  std::string_view led() const;

  std::uint32_t bit_rate() const override { return state_.supplied && node() != 0 ? state_.bit_rate : 0; }
  std::uint8_t node() const override { return slave_.node(); }
  void handle_frame(Instant now, const CanFrame& frame) override;
  std::optional<CanFrame> poll_transmit(Instant now) override { return slave_.poll_transmit(now); }
  void set_bus_off(Instant now, bool bus_off) override;
  // Another master asked for the operation mode, and got it: what NMT asked for before does not count any more.
  void on_mode_of_other_master(Instant asked_at);

  friend void archive(Archive& a, CanopenUnit& unit) {
    VINV_MEMBERS(unit, drive, slave, queue, state);
    VINV_FIELDS(a, CanopenUnit, slave, queue, state);
  }

 private:
  struct RefusedTopic {
    CommandError reason{};
    port::ParameterId parameter{};
    friend bool operator==(const RefusedTopic&, const RefusedTopic&) = default;
    VINV_ARCHIVE(RefusedTopic, reason, parameter);
  };
  struct State {
    bool supplied = false;
    bool bus_off = false;
    std::uint32_t bit_rate = 0;
    DriveProfile profile;
    std::int16_t target_velocity = 0;      // rpm
    bool runs_reverse = false;             // direction of the last target that was not 0
    std::int16_t abort_option = 0;         // 6007H
    std::optional<Instant> leaves_since;   // an NMT command took the network mode away; done at standstill
    std::optional<Instant> leave_next_at;  // the last attempt was refused
    bool inverter_ready = false;           // at the last tick
    bool storing_failed = false;           // since the last tick
    bool storing_told = false;             // by an EMCY; until a value has been stored again
    bool guarding_lost = false;
    std::uint8_t short_rpdos = 0;  // bit per RPDO
    std::uint8_t alarm_seen = 0;   // data code of the inverter's alarm now, 0: none
    std::uint8_t alarm_shown = 0;  // as the network knows it
    std::optional<Instant> alarm_shows_at;
    port::AlarmHistory history{};                          // as the network knows it
    std::array<std::optional<RefusedTopic>, 6> refused{};  // by WriteTopic: what the master has been told
    VINV_ARCHIVE(State, supplied, bus_off, bit_rate, profile, target_velocity, runs_reverse, abort_option, leaves_since,
                 leave_next_at, inverter_ready, storing_failed, storing_told, guarding_lost, short_rpdos, alarm_seen,
                 alarm_shown, alarm_shows_at, history, refused);
  };

  // canopen::Application (canopen_objects.cpp)
  bool exists(const canopen::ObjectRow& row, std::uint16_t index) const override;
  Result<std::uint32_t, canopen::AbortCode> read(const canopen::ObjectRow& row, std::uint16_t index,
                                                 std::uint8_t sub) const override;
  std::optional<canopen::WriteResult> write(Instant now, canopen::Origin origin, const canopen::ObjectRow& row,
                                            std::uint16_t index, std::uint8_t sub, std::uint32_t raw) override;
  void abandon_download() override { queue_.abandon_sdo(); }
  std::uint8_t error_register() const override;
  // (canopen_unit.cpp)
  void on_nmt_command(Instant now, canopen::NmtCommand command, canopen::NmtState before) override;
  void on_guarding(Instant now, bool lost) override;
  void on_pdo_fault(Instant now, canopen::PdoFault fault, unsigned pdo) override;

  // canopen_objects.cpp
  std::int16_t velocity_rpm() const;
  Result<std::uint32_t, canopen::AbortCode> read_parameter(port::ParameterId id) const;
  Result<std::uint32_t, canopen::AbortCode> read_delta_time(std::uint16_t number) const;
  std::uint32_t increments_per_second() const;
  std::optional<canopen::WriteResult> write_word(canopen::Origin origin, WriteTopic topic,
                                                 const port::WriteRequest& request);
  std::optional<canopen::WriteResult> write_parameter(canopen::Origin origin, port::ParameterId id,
                                                      std::uint64_t value);
  std::optional<canopen::WriteResult> write_controlword(canopen::Origin origin, std::uint16_t word);
  std::optional<canopen::WriteResult> write_target_velocity(canopen::Origin origin, std::int16_t rpm);
  std::optional<canopen::WriteResult> submit(canopen::Origin origin, WriteJob job);
  std::optional<canopen::WriteResult> refuse(canopen::Origin origin, WriteTopic topic, port::ParameterId parameter,
                                             port::Refusal refusal);

  // canopen_unit.cpp
  void pump(Instant now);
  void on_finished(Instant now, const FinishedWrite& write);
  void follow_alarm(Instant now);
  void report_storing();
  void leave_network(Instant now);
  void react_to_abort();
  WriteJob run_job() const;
  WriteJob action_job(DriveAction action) const;
  void report_refusal(WriteTopic topic, port::ParameterId parameter, port::Refusal refusal, bool always);
  void send_emergency(std::uint16_t error_code, std::uint8_t system_error, std::uint8_t detail);

  port::DrivePort& drive_;
  canopen::Slave slave_;
  WriteQueue queue_;
  State state_;
};

}  // namespace vinv::boards::oi_fr_e5nco
